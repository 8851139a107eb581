"""From a system to the structures that scenes start from, and to its constants."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dnawaves.cli.arguments import (
    Built,
    Relaxed,
    Start,
    SystemJson,
    Threads,
    app,
    file,
    file_option,
    output_option,
)


@app.command()
def build(system: SystemJson, output: Annotated[Path, output_option("PDB file")]) -> None:
    """Build the duplex of a system, from its sequence or a file, with its water if any."""
    from dnawaves.system.steps import build_step

    build_step(system, output)


@app.command()
def relax(
    system: SystemJson,
    built: Built,
    output: Annotated[Path, output_option("NetCDF file of the minimum")],
    hessian: Annotated[Path, typer.Option(help="NPZ file of the sparse Hessian at the minimum")],
    threads: Threads = 1,
) -> None:
    """Relax a duplex to a minimum of its environment."""
    from dnawaves.system.steps import relax_step

    relax_step(system, built, output, hessian, threads)


@app.command()
def equilibrate(
    system: SystemJson,
    built: Built,
    output: Annotated[Path, output_option("NetCDF file of the snapshots")],
    threads: Threads = 1,
) -> None:
    """Equilibrate a system at its temperature; write snapshots that scenes start from."""
    from dnawaves.system.steps import equilibrate_step

    equilibrate_step(system, built, output, threads)


@app.command()
def modes(
    system: SystemJson,
    built: Built,
    relaxed: Relaxed,
    hessian: Annotated[Path, file("Hessian at the minimum, as `dnawaves relax` wrote it")],
    output: Annotated[Path, output_option("NetCDF file of the normal modes")],
    first: Annotated[int, typer.Option(min=0, help="base pairs held at the first end")] = 0,
    last: Annotated[int, typer.Option(min=0, help="base pairs held at the last end")] = 0,
) -> None:
    """Find the normal modes of a relaxed duplex, and what they are to its base pairs."""
    from dnawaves.system.steps import modes_step

    modes_step(system, built, relaxed, hessian, (first, last), output)


@app.command()
def segments(
    modes: Annotated[Path, file("normal modes of the free duplex, as `dnawaves modes` wrote them")],
    output: Annotated[Path, output_option("CSV file of stiffness and speeds by length")],
) -> None:
    """Find the rod's constants in a duplex: how stiff its segments are, by their length."""
    from dnawaves.waves.constants.segments import segments_step

    segments_step(modes, output)


@app.command()
def constants(
    system: SystemJson,
    built: Built,
    start: Start,
    output: Annotated[Path, output_option("CSV file of the rod's constants by every route")],
    modes: Annotated[Path | None, file_option("normal modes of the free duplex, at 0 K")] = None,
    speeds: Annotated[
        list[Path] | None, file_option("fitted speeds of a static scene; repeatable")
    ] = None,
    motion: Annotated[
        list[Path] | None,
        file_option("motion of an equilibrium scene above 0 K with free ends; repeatable"),
    ] = None,
    helical: Annotated[
        list[Path] | None,
        file_option("helical parameters, with frames, of such a scene; repeatable"),
    ] = None,
) -> None:
    """Gather the rod's constants of a system by every route, with intervals."""
    from dnawaves.waves.constants.gather import constants_step

    constants_step(system, built, start, output, modes, speeds or [], motion or [], helical or [])


@app.command()
def inspect(
    system: SystemJson,
    built: Built,
    start: Start,
    output: Annotated[Path, output_option("NetCDF file of helical parameters and B-form checks")],
    base_atoms: Annotated[Path, typer.Option(help="PDB file of the atoms in trajectories")],
    structure: Annotated[Path, typer.Option(help="PDB file of the minimum or mean structure")],
) -> None:
    """Check that a relaxed or equilibrated duplex is B-DNA, and write it for other programs."""
    from dnawaves.motion.structure import inspect_step

    inspect_step(system, built, start, output, base_atoms, structure)


@app.command()
def costs(
    system: SystemJson,
    built: Built,
    start: Start,
    output: Annotated[Path, output_option("CSV file")],
) -> None:
    """Measure what each effect of a system costs per step, by leaving it out."""
    from dnawaves.trajectory.costs import costs_step

    costs_step(system, built, start, output)
