"""The commands of a study of accuracy, which the workflow's target `accuracy` runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dnawaves.cli.arguments import Threads, file, file_option, output_option

app = typer.Typer(
    help="What accuracy costs in time: the steps of `snakemake accuracy`.", no_args_is_help=True
)

StudyFile = Annotated[Path, file("study file")]
SystemName = Annotated[str, typer.Option(help="name of a system of the study")]
Minimum = Annotated[Path, file_option("what `dnawaves accuracy relax` wrote")]
Output = Annotated[Path, output_option("file to write")]


@app.command("list")
def list_settings(study: StudyFile) -> None:
    """Check a study file and list its settings."""
    from dnawaves.accuracy.settings import load_study

    for name, setting in load_study(study).settings.items():
        typer.echo(f"{name:36s} {setting.title}: {setting.label}")


@app.command()
def relax(
    study: StudyFile,
    system: SystemName,
    output: Output,
    threads: Threads = 1,
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
    usual: Annotated[Path, file_option("minimum of the case whose time is the measure")],
    known: Annotated[Path, file_option("what `dnawaves accuracy truth` wrote")],
    output: Output,
) -> None:
    """Measure the error and the time of one setting."""
    from dnawaves.accuracy.steps import setting_step

    setting_step(study, name, minimum, usual, known, output)


@app.command()
def costs(
    study: StudyFile,
    system: SystemName,
    minimum: Minimum,
    output: Output,
) -> None:
    """Measure what each effect of a system costs per step."""
    from dnawaves.accuracy.steps import costs_step

    costs_step(study, system, minimum, output)


@app.command()
def tables(
    rows: Annotated[list[Path], file("rows")],
    settings: Annotated[Path, typer.Option(help="CSV file of settings of one model")],
    models: Annotated[Path, typer.Option(help="CSV file of other models")],
) -> None:
    """Gather the rows of a study into its two tables."""
    from dnawaves.accuracy.steps import tables_step

    tables_step(rows, settings, models)


@app.command()
def page(
    settings: Annotated[Path, file("table of settings")],
    models: Annotated[Path, file("table of models")],
    config: Annotated[Path, file_option("scenes whose settings are marked")],
    output: Output,
    costs: Annotated[
        list[Path] | None, file_option("what `accuracy costs` wrote; repeatable")
    ] = None,
) -> None:
    """Write the study as one page that opens offline."""
    from dnawaves.report.accuracy_page import accuracy_page_step

    accuracy_page_step(settings, models, costs or [], config, output)
