"""The command line's application, and the arguments that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

app = typer.Typer(
    help="Mechanical waves along DNA: all-atom simulation held against elastic-rod theory.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def file(text: str) -> Any:
    """Return an argument that is a file which is there."""
    return typer.Argument(help=text, exists=True, dir_okay=False)


def file_option(text: str) -> Any:
    """Return an option that is a file which is there."""
    return typer.Option(help=text, exists=True, dir_okay=False)


def output_option(text: str) -> Any:
    """Return the option for the file that a command writes."""
    return typer.Option("--output", help=text, dir_okay=False)


Config = Annotated[Path, typer.Argument(help="configuration file")]
SystemJson = Annotated[Path, file("system, as `dnawaves freeze --system` wrote it")]
SceneJson = Annotated[Path, file("scene, as `dnawaves freeze --scene` wrote it")]
Built = Annotated[Path, file("duplex, as `dnawaves build` wrote it")]
Relaxed = Annotated[Path, file("minimum, as `dnawaves relax` wrote it")]
Start = Annotated[Path, file("minimum or snapshots, as `relax` or `equilibrate` wrote them")]
Results = Annotated[Path, typer.Option(help="folder of the workflow's results")]
Threads = Annotated[int, typer.Option(min=1, help="number of threads or worker processes")]
