"""The steps that build and relax a system, from files to files."""

from __future__ import annotations

import sys
from pathlib import Path

import scipy.sparse

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.errors import InputError
from dnawaves.files import whole_file, write_netcdf
from dnawaves.scene.load import read_system
from dnawaves.system.duplex import read_built
from dnawaves.system.forces import load_force_field
from dnawaves.system.modes import normal_modes
from dnawaves.system.modes_file import modes_dataset
from dnawaves.system.relax import read_relaxed, relax


def build_step(system_json: Path, output: Path) -> None:
    """Build the duplex of a system and write it as PDB."""
    spec = read_system(system_json)
    topology, positions = build_duplex(spec.duplex.sequence, load_force_field(spec.environment))
    with whole_file(output) as temporary:
        write_pdb(topology, positions, temporary)


def relax_step(
    system_json: Path, built: Path, output: Path, hessian_output: Path, threads: int
) -> None:
    """Relax a built duplex to its minimum; write the positions, what was reached, the Hessian."""
    duplex = read_built(read_system(system_json), built)

    def report(line: str) -> None:
        print(f"{duplex.spec.name}: {line}", file=sys.stderr, flush=True)

    dataset, hessian = relax(duplex, threads, report)
    with whole_file(hessian_output) as temporary, temporary.open("wb") as file:
        scipy.sparse.save_npz(file, hessian)
    write_netcdf(output, dataset)


def modes_step(
    system_json: Path,
    built: Path,
    relaxed: Path,
    hessian: Path,
    held: tuple[int, int],
    output: Path,
) -> None:
    """Write the normal modes of a relaxed duplex with base pairs held at its two ends."""
    duplex = read_relaxed(read_system(system_json), built, relaxed)
    last = duplex.pair_count - held[1]
    if held[0] >= last:
        raise InputError(
            f"held base pairs: found {held[0]} and {held[1]}; "
            f"allowed: fewer than {duplex.pair_count} together"
        )
    free = (duplex.pairs >= held[0]) & (duplex.pairs < last)
    modes = normal_modes(scipy.sparse.load_npz(hessian), duplex.masses_Da, duplex.bodies, free)
    write_netcdf(output, modes_dataset(modes, duplex, held))
