"""The commands of a study of accuracy, which the workflow's target `accuracy` runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    help="What accuracy costs in time: the steps of `snakemake accuracy`.", no_args_is_help=True
)

StudyFile = Annotated[Path, typer.Argument(help="study file", exists=True, dir_okay=False)]
Minimum = Annotated[
    Path,
    typer.Option(help="what `dnawaves accuracy relax` wrote", exists=True, dir_okay=False),
]
Output = Annotated[Path, typer.Option("--output", help="file to write", dir_okay=False)]


@app.command("list")
def list_settings(study: StudyFile) -> None:
    """Check a study file and list its settings."""
    from dnawaves.accuracy.settings import load_study

    for name, setting in load_study(study).settings.items():
        typer.echo(f"{name:36s} {setting.title}: {setting.label}")


@app.command()
def relax(
    study: StudyFile,
    system: Annotated[str, typer.Option(help="name of a system of the study")],
    output: Output,
    threads: Annotated[int, typer.Option(min=1)] = 1,
) -> None:
    """Relax one system of a study to the minimum that its settings start from."""
    from dnawaves.accuracy.steps import relax_system_step

    relax_system_step(study, system, output, threads)


@app.command()
def truth(
    study: StudyFile,
    case: Annotated[str, typer.Option(help="name of a case of the study")],
    minimum: Minimum,
    output: Output,
) -> None:
    """Find the answers that one case is judged by."""
    from dnawaves.accuracy.steps import truth_step

    truth_step(study, case, minimum, output)


@app.command()
def setting(
    study: StudyFile,
    name: Annotated[str, typer.Option(help="name of a setting, as `accuracy list` shows it")],
    minimum: Minimum,
    usual: Annotated[
        Path,
        typer.Option(
            help="minimum of the case whose time is the measure", exists=True, dir_okay=False
        ),
    ],
    known: Annotated[
        Path,
        typer.Option(help="what `dnawaves accuracy truth` wrote", exists=True, dir_okay=False),
    ],
    output: Output,
) -> None:
    """Measure the error and the time of one setting."""
    from dnawaves.accuracy.steps import setting_step

    setting_step(study, name, minimum, usual, known, output)


@app.command()
def costs(
    study: StudyFile,
    system: Annotated[str, typer.Option(help="name of a system of the study")],
    minimum: Minimum,
    output: Output,
) -> None:
    """Measure what each effect of a system costs per step."""
    from dnawaves.accuracy.steps import costs_step

    costs_step(study, system, minimum, output)


@app.command()
def tables(
    rows: Annotated[list[Path], typer.Argument(help="rows", exists=True, dir_okay=False)],
    settings: Annotated[Path, typer.Option(help="CSV file of settings of one model")],
    models: Annotated[Path, typer.Option(help="CSV file of other models")],
) -> None:
    """Gather the rows of a study into its two tables."""
    from dnawaves.accuracy.steps import tables_step

    tables_step(rows, settings, models)


@app.command()
def page(
    settings: Annotated[Path, typer.Argument(help="table of settings", exists=True)],
    models: Annotated[Path, typer.Argument(help="table of models", exists=True)],
    config: Annotated[Path, typer.Option(help="scenes whose settings are marked", exists=True)],
    output: Output,
    costs: Annotated[
        list[Path] | None,
        typer.Option(help="what `accuracy costs` wrote; repeatable", exists=True, dir_okay=False),
    ] = None,
) -> None:
    """Write the study as one page that opens offline."""
    from dnawaves.report.accuracy_page import accuracy_page_step

    accuracy_page_step(settings, models, costs or [], config, output)
