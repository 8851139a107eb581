"""The steps that build a system and relax or equilibrate it, from files to files."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from openmm import app

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.duplex.from_file import read_duplex
from dnawaves.errors import InputError
from dnawaves.files import whole_file, write_netcdf
from dnawaves.scene.load import read_system
from dnawaves.scene.models import SystemSpec
from dnawaves.scene.structure_file import digest_of_file
from dnawaves.system.duplex import read_built
from dnawaves.system.effects.water import solvate
from dnawaves.system.equilibrate import equilibrate
from dnawaves.system.forces import load_force_field
from dnawaves.system.geometry import helix_frame, sugar_anchors
from dnawaves.system.modes import normal_modes
from dnawaves.system.modes_file import modes_dataset
from dnawaves.system.relax import read_relaxed, relax


def build_step(system_json: Path, output: Path) -> None:
    """Build the duplex of a system, or take it from the user's file; write it as PDB.

    In explicit solvent the water and the ions of its box follow. Raises `InputError` where the
    user's file is not what the system was declared with.
    """
    spec = read_system(system_json)
    topology, positions = built_structure(spec)
    with whole_file(output) as temporary:
        write_pdb(topology, positions, temporary)


def built_structure(spec: SystemSpec) -> tuple[app.Topology, NDArray[np.float64]]:
    """Return topology and positions (atoms, 3) in nm of a system as it is built."""
    environment, duplex = spec.environment, spec.duplex
    force_field = load_force_field(environment)
    if duplex.file is None:
        topology, positions = build_duplex(duplex.sequence, force_field)
    else:
        file = Path(duplex.file)
        if digest_of_file(file) != duplex.digest:
            raise InputError(
                f"{file}: found another content than when '{spec.name}' was declared; "
                "allowed: the same; freeze the system anew"
            )
        topology, positions = read_duplex(file, force_field)
    if environment.water is None:
        return topology, positions
    solvated = solvate(
        topology,
        positions,
        helix_frame(positions[sugar_anchors(topology)]),
        force_field,
        "OPC" if environment.solvent == "OPC" else "TIP3P",
        padding_nm=environment.water.padding_nm,
        salt_M=environment.salt_M,
        cation=environment.water.cation,
        seed=environment.water.seed,
    )
    _check_box(spec, solvated.box_nm)
    return solvated.topology, solvated.positions_nm


def _check_box(spec: SystemSpec, box_nm: NDArray[np.float64]) -> None:
    cutoff_nm, half_nm = spec.environment.cutoff_nm, float(box_nm.min()) / 2
    if cutoff_nm is not None and cutoff_nm >= half_nm:
        raise InputError(
            f"{spec.name}: cutoff_nm: found {cutoff_nm:g}; allowed: below {half_nm:.2f}, half the "
            "shortest side of the box; or a larger water.padding_nm"
        )


def relax_step(
    system_json: Path, built: Path, output: Path, hessian_output: Path, threads: int
) -> None:
    """Relax a built duplex to its minimum; write the positions, what was reached, the Hessian."""
    duplex = read_built(read_system(system_json), built)
    dataset, hessian = relax(duplex, threads, _reporter(duplex.spec.name))
    with whole_file(hessian_output) as temporary, temporary.open("wb") as file:
        scipy.sparse.save_npz(file, hessian)
    write_netcdf(output, dataset)


def equilibrate_step(system_json: Path, built: Path, output: Path, threads: int) -> None:
    """Equilibrate a built system; write its snapshots and what the run says about itself.

    A run that was killed goes on from the checkpoint beside the output.
    """
    duplex = read_built(read_system(system_json), built)
    report = _reporter(duplex.spec.name)
    checkpoint = output.with_name(f".{output.stem}.checkpoint.npz")
    dataset = equilibrate(duplex, threads, report, checkpoint)
    write_netcdf(output, dataset)
    # Last: until then a killed run goes on from there.
    checkpoint.unlink(missing_ok=True)
    if dataset.attrs["warning"]:
        report(f"WARNING: {dataset.attrs['warning']}")


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


def _reporter(name: str) -> Callable[[str], None]:
    return lambda line: print(f"{name}: {line}", file=sys.stderr, flush=True)
