"""The steps that build and relax a system, from files to files."""

from __future__ import annotations

import sys
from pathlib import Path

import scipy.sparse

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.files import whole_file, write_netcdf
from dnawaves.scene.load import read_system
from dnawaves.system.duplex import read_built
from dnawaves.system.forces import load_force_field
from dnawaves.system.relax import relax


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
