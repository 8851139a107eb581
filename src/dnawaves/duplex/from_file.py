"""A duplex from a user's own PDB or mmCIF file, in the project's order of strands and atoms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from openmm import app

from dnawaves.duplex.build import heavy_topology, with_hydrogens
from dnawaves.duplex.fibre import FibreDuplex
from dnawaves.errors import InputError
from dnawaves.scene.structure_file import read_strands


def read_duplex(
    path: Path, force_field: app.ForceField
) -> tuple[app.Topology, NDArray[np.float64]]:
    """Return topology and positions (atoms, 3) in nm of the duplex in a PDB or mmCIF file.

    Chains, residues and numbers are those of `build_duplex`: the file's first chain is strand I.
    Where every hydrogen is there, all atoms stay where they are; where one is missing, all
    hydrogens relax about the heavy atoms. Raises `InputError` as `read_strands` does, and where
    the force field knows no such residue.
    """
    duplex = _in_order(path)
    topology = heavy_topology(duplex)
    if not force_field.getUnmatchedResidues(topology):
        return topology, duplex.positions_nm
    try:
        return with_hydrogens(duplex, force_field)
    except ValueError as error:
        raise InputError(f"{path}: hydrogens: {error}") from None


def _in_order(path: Path) -> FibreDuplex:
    atoms: list[tuple[str, str, int, str]] = []
    places_A: list[tuple[float, float, float]] = []
    for chain, strand in zip("AB", read_strands(path), strict=True):
        for number, nucleotide in enumerate(strand, start=1):
            for name, place_A in nucleotide.places_A.items():
                atoms.append((name, f"D{nucleotide.letter}", number, chain))
                places_A.append(place_A)
    return FibreDuplex.of(atoms, places_A)
