"""The commands of the stability suite, which the workflow's target `stability` runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dnawaves.cli.arguments import file, output_option

app = typer.Typer(
    help="Hard cases and what is expected of them: the steps of `snakemake stability`.",
    no_args_is_help=True,
)


@app.command("list")
def list_cases() -> None:
    """List all cases with what is expected of them."""
    from dnawaves.stability.case import cases

    for name, one in cases().items():
        typer.echo(f"{name:34s} {one.expected:9s} {one.does}")


@app.command()
def case(
    name: Annotated[str, typer.Argument(help="name of a case, as `stability list` shows it")],
    output: Annotated[Path, output_option("JSON file of its row")],
) -> None:
    """Run one case and write its row, whether it passes or fails."""
    from dnawaves.stability.steps import stability_step

    stability_step(name, output)


@app.command()
def table(
    rows: Annotated[list[Path], file("rows")],
    output: Annotated[Path, output_option("CSV file of all rows")],
    page: Annotated[Path, typer.Option(help="HTML page of the table", dir_okay=False)],
) -> None:
    """Gather the rows into a table and a page that opens offline."""
    from dnawaves.report.stability_page import stability_page_step
    from dnawaves.stability.steps import table_step

    table_step(rows, output)
    stability_page_step(output, page)
