"""What a configuration declares, what it will run, and what the theory says."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from dnawaves.cli.arguments import Config, Results, app, output_option

EndName = Literal["free", "held", "pinned"]


@app.command()
def check(config: Config) -> None:
    """Check a configuration file and list its scenes."""
    from dnawaves.scene.load import load_scenes
    from dnawaves.scene.table import scene_table

    typer.echo(scene_table(load_scenes(config)))


@app.command()
def explain(
    config: Config,
    scene: Annotated[str, typer.Argument(help="name of a scene")],
    results: Results = Path("results"),
) -> None:
    """Say what a scene runs: forces, size, expected time from a short probe, disk space."""
    from dnawaves.trajectory.explain import explain as explained

    typer.echo(explained(config, scene, results))


@app.command()
def advise(
    config: Config,
    scene: Annotated[str, typer.Argument(help="name of a scene")],
    error: Annotated[
        str | None, typer.Option(help="largest error to allow, such as 2%; or give --time")
    ] = None,
    time: Annotated[
        str | None, typer.Option(help="longest time to take, such as 10min; or give --error")
    ] = None,
    of: Annotated[
        Literal["waveform", "speed", "helical"], typer.Option(help="what may err")
    ] = "waveform",
    study: Annotated[
        Path, typer.Option(help="settings, as `snakemake accuracy` wrote them")
    ] = Path("results/accuracy/settings.csv"),
    results: Results = Path("results"),
) -> None:
    """Name the cheapest setting for a scene that errs no more, or the best that takes no longer."""
    from dnawaves.accuracy.advise import Wanted, parse_error, parse_minutes
    from dnawaves.accuracy.advise import advise as advised

    wanted = Wanted(
        of,
        None if error is None else parse_error(error),
        None if time is None else parse_minutes(time),
    )
    typer.echo(advised(config, scene, results, study, wanted))


@app.command()
def theory(
    rod: Annotated[
        Path | None,
        typer.Argument(help="YAML file of the rod's constants; left out: the paper's rod"),
    ] = None,
    pairs: Annotated[
        int,
        typer.Option(
            min=2, max=1000, help="base pairs of the duplex; 300 take seconds, 1000 a minute"
        ),
    ] = 24,
    first: Annotated[EndName, typer.Option(help="how the first end is held")] = "held",
    last: Annotated[EndName, typer.Option(help="how the last end is held")] = "held",
    modes: Annotated[int, typer.Option(min=1, help="number of modes to list")] = 8,
    continuous: Annotated[
        bool, typer.Option(help="dispersion of the continuous rod, not of the lattice")
    ] = False,
    dispersion: Annotated[
        Path | None, typer.Option(help="CSV or NetCDF file of the dispersion relation")
    ] = None,
    modes_output: Annotated[Path | None, typer.Option(help="CSV file of the modes")] = None,
    tables: Annotated[
        Path | None, typer.Option(help="folder for every printed table as CSV", file_okay=False)
    ] = None,
    errata: Annotated[
        bool, typer.Option(help="print the points of the paper to read with care, and no more")
    ] = False,
) -> None:
    """Print and write what the rod theory says: speeds, dispersion, modes, travel times."""
    if errata:
        from dnawaves.rod.errata import errata_markdown

        typer.echo(errata_markdown(), nl=False)
        return
    from dnawaves.rod.steps import theory_step
    from dnawaves.rod.summary import Duplex

    duplex = Duplex(pairs, (first, last))
    typer.echo(theory_step(rod, duplex, modes, continuous, dispersion, modes_output, tables))


@app.command()
def schema(output: Annotated[Path, output_option("JSON Schema")]) -> None:
    """Write the JSON Schema of configuration files."""
    from dnawaves.scene.schema import write_schema

    write_schema(output)


@app.command()
def freeze(
    config: Config,
    output: Annotated[Path, output_option("JSON file")],
    scene: Annotated[str | None, typer.Option(help="name of the scene to write")] = None,
    system: Annotated[
        str | None, typer.Option(help="name of the system to write: <duplex>-<environment>")
    ] = None,
) -> None:
    """Write one scene or one system with everything that its names stand for."""
    from dnawaves.scene.freeze import freeze

    freeze(config, scene, system, output)
