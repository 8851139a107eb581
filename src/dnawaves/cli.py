"""The command line: each command parses its arguments and calls one function of the library.

Imports of the library stand inside the commands: `dnawaves --help` and the small steps must not
pay for OpenMM.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from dnawaves.errors import InputError, SimulationError

app = typer.Typer(
    help="Mechanical waves along DNA: all-atom simulation held against elastic-rod theory.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _file(text: str) -> Any:
    return typer.Argument(help=text, exists=True, dir_okay=False)


def _output(text: str) -> Any:
    return typer.Option("--output", help=text, dir_okay=False)


EndName = Literal["free", "held", "pinned"]
Config = Annotated[Path, typer.Argument(help="configuration file")]
SystemJson = Annotated[Path, _file("system, as `dnawaves freeze --system` wrote it")]
SceneJson = Annotated[Path, _file("scene, as `dnawaves freeze --scene` wrote it")]
Built = Annotated[Path, _file("duplex, as `dnawaves build` wrote it")]
Relaxed = Annotated[Path, _file("minimum, as `dnawaves relax` wrote it")]
Threads = Annotated[int, typer.Option(min=1, help="number of threads or worker processes")]


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
    results: Annotated[Path, typer.Option(help="folder of the workflow's results")] = Path(
        "results"
    ),
) -> None:
    """Say what a scene runs: forces, size, expected time from a short probe, disk space."""
    from dnawaves.trajectory.explain import explain as explained

    typer.echo(explained(config, scene, results))


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
def schema(output: Annotated[Path, _output("JSON Schema")]) -> None:
    """Write the JSON Schema of configuration files."""
    from dnawaves.scene.schema import write_schema

    write_schema(output)


@app.command()
def freeze(
    config: Config,
    output: Annotated[Path, _output("JSON file")],
    scene: Annotated[str | None, typer.Option(help="name of the scene to write")] = None,
    system: Annotated[
        str | None, typer.Option(help="name of the system to write: <duplex>-<environment>")
    ] = None,
) -> None:
    """Write one scene or one system with everything that its names stand for."""
    from dnawaves.scene.freeze import freeze

    freeze(config, scene, system, output)


@app.command()
def build(system: SystemJson, output: Annotated[Path, _output("PDB file")]) -> None:
    """Build the duplex of a system from its sequence."""
    from dnawaves.system.steps import build_step

    build_step(system, output)


@app.command()
def relax(
    system: SystemJson,
    built: Built,
    output: Annotated[Path, _output("NetCDF file of the minimum")],
    hessian: Annotated[Path, typer.Option(help="NPZ file of the sparse Hessian at the minimum")],
    threads: Threads = 1,
) -> None:
    """Relax a duplex to a minimum of its environment."""
    from dnawaves.system.steps import relax_step

    relax_step(system, built, output, hessian, threads)


@app.command()
def modes(
    system: SystemJson,
    built: Built,
    relaxed: Relaxed,
    hessian: Annotated[Path, _file("Hessian at the minimum, as `dnawaves relax` wrote it")],
    output: Annotated[Path, _output("NetCDF file of the normal modes")],
    first: Annotated[int, typer.Option(min=0, help="base pairs held at the first end")] = 0,
    last: Annotated[int, typer.Option(min=0, help="base pairs held at the last end")] = 0,
) -> None:
    """Find the normal modes of a relaxed duplex, and what they are to its base pairs."""
    from dnawaves.system.steps import modes_step

    modes_step(system, built, relaxed, hessian, (first, last), output)


@app.command()
def segments(
    modes: Annotated[
        Path, _file("normal modes of the free duplex, as `dnawaves modes` wrote them")
    ],
    output: Annotated[Path, _output("CSV file of stiffness and speeds by length")],
) -> None:
    """Find the rod's constants in a duplex: how stiff its segments are, by their length."""
    from dnawaves.waves.segments import segments_step

    segments_step(modes, output)


@app.command()
def inspect(
    system: SystemJson,
    built: Built,
    relaxed: Relaxed,
    output: Annotated[Path, _output("NetCDF file of helical parameters and B-form checks")],
    base_atoms: Annotated[Path, typer.Option(help="PDB file of the atoms in trajectories")],
    structure: Annotated[Path, typer.Option(help="PDB file of the whole relaxed duplex")],
) -> None:
    """Check that a relaxed duplex is B-DNA, and write it for other programs."""
    from dnawaves.motion.structure import inspect_step

    inspect_step(system, built, relaxed, output, base_atoms, structure)


@app.command()
def simulate(
    scene: SceneJson,
    built: Built,
    relaxed: Relaxed,
    hessian: Annotated[Path, _file("Hessian at the minimum, as `dnawaves relax` wrote it")],
    member: Annotated[str, typer.Option(help="which of the scene's runs, as `check` lists them")],
    output: Annotated[Path, _output("NetCDF file of the motion of every base pair")],
    trajectory: Annotated[
        Path | None, typer.Option(help="folder for the base atoms' trajectories", file_okay=False)
    ] = None,
    fitted: Annotated[
        list[Path] | None,
        typer.Option(
            help="speeds of a scene that a sweep names; once for each", exists=True, dir_okay=False
        ),
    ] = None,
    modes: Annotated[
        Path | None,
        typer.Option(
            help="normal modes with the scene's ends, for a harmonic scene",
            exists=True,
            dir_okay=False,
        ),
    ] = None,
    threads: Threads = 1,
) -> None:
    """Simulate one run of a scene, or answer it from the normal modes."""
    from dnawaves.trajectory.steps import simulate_step

    simulate_step(
        scene, built, relaxed, hessian, member, output, trajectory, fitted or [], threads, modes
    )


@app.command()
def helical(
    topology: Annotated[Path, _file("any topology or structure that MDAnalysis reads")],
    output: Annotated[Path, _output("NetCDF file, or CSV file with a pair table beside it")],
    trajectory: Annotated[
        list[Path] | None, _file("any trajectories that MDAnalysis reads, one after the other")
    ] = None,
    pairs: Annotated[
        Path | None,
        typer.Option(
            help="CSV file of base pairs: chain1,resid1,chain2,resid2", exists=True, dir_okay=False
        ),
    ] = None,
    start: Annotated[int | None, typer.Option(help="first frame, from 0")] = None,
    stop: Annotated[int | None, typer.Option(help="frame to end before")] = None,
    step: Annotated[int | None, typer.Option(help="take every n-th frame")] = None,
    workers: Annotated[int, typer.Option(min=1, help="number of worker processes")] = 1,
    frames: Annotated[
        bool, typer.Option(help="also write the origins and axes of bases, pairs and steps (.nc)")
    ] = True,
) -> None:
    """Derive the helical parameters of every duplex, for a structure or each trajectory frame."""
    from dnawaves.helical.steps import helical_step

    keep = frames and output.suffix == ".nc"
    helical_step(topology, trajectory or [], output, pairs, start, stop, step, workers, keep)


@app.command()
def analyse(
    scene: SceneJson,
    motions: Annotated[list[Path], _file("motion of each of the scene's runs")],
    output: Annotated[Path, _output("CSV file of fitted speeds")],
    waves: Annotated[Path, typer.Option(help="NetCDF file of fields, spectra and fits")],
) -> None:
    """Fit the speeds of a scene."""
    from dnawaves.waves.steps import analyse_step

    analyse_step(scene, motions, output, waves)


@app.command()
def compare(
    speeds: Annotated[list[Path], _file("fitted speeds of each scene")],
    output: Annotated[Path, _output("CSV file")],
    structure: Annotated[
        list[Path] | None,
        typer.Option(help="what `dnawaves inspect` wrote; repeatable", exists=True, dir_okay=False),
    ] = None,
) -> None:
    """Hold fitted speeds against the theory, one row per scene, wave and estimator."""
    from dnawaves.comparison.steps import compare_step

    compare_step(speeds, structure or [], output)


@app.command()
def report(
    config: Annotated[Path, typer.Option(help="configuration file")],
    output: Annotated[Path, _output("HTML page")],
    results: Annotated[
        Path, typer.Option(help="folder of the workflow's results", exists=True, file_okay=False)
    ] = Path("results"),
) -> None:
    """Write the report: one page that opens offline."""
    from dnawaves.report.steps import report_step

    report_step(config, results, output)


def main() -> None:
    """Run the command line; what a user can act on is one message, not a traceback."""
    try:
        app()
    except InputError as error:
        _fail(error, 2)
    except SimulationError as error:
        _fail(error, 1)


def _fail(error: Exception, code: int) -> None:
    print(f"dnawaves: {error}", file=sys.stderr)
    sys.exit(code)
