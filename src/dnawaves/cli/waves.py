"""From a scene to its motion, its speeds, the comparison and the report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dnawaves.cli.arguments import Built, SceneJson, Threads, app, file, file_option, output_option


@app.command()
def simulate(
    scene: SceneJson,
    built: Built,
    start: Annotated[
        Path, file("minimum of `dnawaves relax`, above 0 K snapshots of `dnawaves equilibrate`")
    ],
    member: Annotated[str, typer.Option(help="which of the scene's runs, as `check` lists them")],
    output: Annotated[Path, output_option("NetCDF file of the motion of every base pair")],
    trajectory: Annotated[
        Path | None, typer.Option(help="folder for the base atoms' trajectories", file_okay=False)
    ] = None,
    fitted: Annotated[
        list[Path] | None, file_option("speeds of a scene that a sweep names; once for each")
    ] = None,
    hessian: Annotated[
        Path | None, file_option("Hessian at the minimum, for a static load")
    ] = None,
    modes: Annotated[
        Path | None, file_option("normal modes with the scene's ends, for a harmonic scene")
    ] = None,
    threads: Threads = 1,
    platform: Annotated[str, typer.Option(help="OpenMM's platform")] = "CPU",
) -> None:
    """Simulate one run of a scene, or answer it from the normal modes."""
    from dnawaves.trajectory.steps import simulate_step

    simulate_step(
        scene,
        built,
        start,
        member,
        output,
        trajectory,
        fitted or [],
        threads,
        hessian,
        modes,
        platform,
    )


@app.command()
def helical(
    topology: Annotated[Path, file("any topology or structure that MDAnalysis reads")],
    output: Annotated[Path, output_option("NetCDF file, or CSV file with a pair table beside it")],
    trajectory: Annotated[
        list[Path] | None, file("any trajectories that MDAnalysis reads, one after the other")
    ] = None,
    pairs: Annotated[
        Path | None, file_option("CSV file of base pairs: chain1,resid1,chain2,resid2")
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
    motions: Annotated[list[Path], file("motion of each of the scene's runs")],
    output: Annotated[Path, output_option("CSV file of fitted speeds")],
    waves: Annotated[Path, typer.Option(help="NetCDF file of fields, spectra and fits")],
) -> None:
    """Fit the speeds of a scene."""
    from dnawaves.waves.steps import analyse_step

    analyse_step(scene, motions, output, waves)


@app.command()
def joint(
    motions: Annotated[list[Path], file("motion of any scenes of one system")],
    output: Annotated[Path, output_option("CSV file of the rod's constants")],
) -> None:
    """Fit one rod to all waves of a system: the constants that the waves themselves imply."""
    from dnawaves.waves.joint import joint_step

    joint_step(motions, output)


@app.command()
def compare(
    speeds: Annotated[list[Path], file("fitted speeds of each scene")],
    output: Annotated[Path, output_option("CSV file")],
    scene: Annotated[list[Path], file_option("what `dnawaves freeze` wrote; repeatable")],
    structure: Annotated[
        list[Path] | None, file_option("what `dnawaves inspect` wrote; repeatable")
    ] = None,
    constants: Annotated[
        list[Path] | None,
        file_option("constants of a system's rod, in the system's folder; repeatable"),
    ] = None,
) -> None:
    """Hold fitted speeds against the paper's rod and the molecule's own, with verdicts."""
    from dnawaves.comparison.steps import compare_step

    compare_step(speeds, scene, structure or [], constants or [], output)


@app.command()
def report(
    config: Annotated[Path, typer.Option(help="configuration file")],
    output: Annotated[Path, output_option("HTML page")],
    results: Annotated[
        Path, typer.Option(help="folder of the workflow's results", exists=True, file_okay=False)
    ] = Path("results"),
) -> None:
    """Write the report: one page that opens offline."""
    from dnawaves.report.steps import report_step

    report_step(config, results, output)
