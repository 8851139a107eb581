"""An OpenMM topology and positions, hydrogens included, for any DNA sequence."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import app, unit

from dnawaves.duplex.fibre import FibreDuplex, fibre_duplex
from dnawaves.errors import InputError

# Saenger, Principles of Nucleic Acid Structure (1984): the atoms of strand I's base first.
_HYDROGEN_BONDS = {
    "DA": (("N6", "O4"), ("N1", "N3")),
    "DT": (("O4", "N6"), ("N3", "N1")),
    "DG": (("O6", "N4"), ("N1", "N3"), ("N2", "O2")),
    "DC": (("N4", "O6"), ("N3", "N1"), ("O2", "N2")),
}
_HYDROGEN_SEED = 1


def build_duplex(
    sequence: str, force_field: app.ForceField
) -> tuple[app.Topology, NDArray[np.float64]]:
    """Return topology and positions (atoms, 3) in nm of the duplex in its fibre B-form.

    Chain A is strand I, chain B strand II, residues counted from 1, 5' to 3'. The heavy atoms
    stand as in `fibre_duplex`; the hydrogens relax around them. The same call gives the same
    numbers. Raises `InputError` for a sequence that `check_sequence` refuses.
    """
    return with_hydrogens(fibre_duplex(sequence), force_field)


def with_hydrogens(
    duplex: FibreDuplex, force_field: app.ForceField
) -> tuple[app.Topology, NDArray[np.float64]]:
    """Return topology and positions (atoms, 3) in nm, hydrogens added as in `build_duplex`."""
    modeller = app.Modeller(heavy_topology(duplex), duplex.positions_nm * unit.nanometer)
    with seeded_random(_HYDROGEN_SEED):
        modeller.addHydrogens(force_field, platform=openmm.Platform.getPlatformByName("Reference"))
    positions = np.array(modeller.positions.value_in_unit(unit.nanometer), dtype=np.float64)
    return modeller.topology, positions


def heavy_topology(duplex: FibreDuplex) -> app.Topology:
    """Return the topology of the fibre model's atoms with their standard bonds."""
    topology = app.Topology()
    chain, residue = None, None
    for name, residue_name, residue_id, chain_id in zip(
        duplex.atom_names, duplex.residue_names, duplex.residue_ids, duplex.chain_ids, strict=True
    ):
        if chain is None or chain.id != chain_id:
            chain, residue = topology.addChain(str(chain_id)), None
        if residue is None or residue.id != str(residue_id):
            residue = topology.addResidue(str(residue_name), chain, str(residue_id))
        topology.addAtom(str(name), app.Element.getBySymbol(str(name)[0]), residue)
    topology.createStandardBonds()
    return topology


def write_pdb(
    topology: app.Topology, positions_nm: NDArray[np.float64], path_or_file: str | Path | TextIO
) -> None:
    """Write one structure, positions (atoms, 3) in nm, as PDB with the topology's own numbers."""
    if isinstance(path_or_file, (str, Path)):
        with open(path_or_file, "w", encoding="utf-8") as file:
            write_pdb(topology, positions_nm, file)
        return
    app.PDBFile.writeFile(topology, positions_nm * unit.nanometer, path_or_file, keepIds=True)


def watson_crick_bonds(topology: app.Topology) -> list[list[tuple[int, int]]]:
    """Return, for each base pair, its hydrogen bonds as heavy atoms (strand I, strand II).

    Two bonds for A-T, three for G-C. Raises `InputError` if the topology's first two chains
    are not complementary strands of DA, DC, DG, DT.
    """
    chains = list(topology.chains())
    if len(chains) < 2:
        raise InputError(f"a duplex has two chains; this topology has {len(chains)}")
    strand_I, strand_II = (_nucleotides(chain) for chain in chains[:2])
    if len(strand_I) != len(strand_II):
        raise InputError(
            f"the strands have {len(strand_I)} and {len(strand_II)} nucleotides; not a duplex"
        )
    return [
        _pair_bonds(first, second)
        for first, second in zip(strand_I, reversed(strand_II), strict=True)
    ]


@contextmanager
def seeded_random(seed: int) -> Iterator[None]:
    """Fix Python's random numbers, from which Modeller starts hydrogens, and restore them."""
    state = random.getstate()
    random.seed(seed)
    try:
        yield
    finally:
        random.setstate(state)


def _nucleotides(chain: app.topology.Chain) -> list[app.topology.Residue]:
    residues = list(chain.residues())
    for residue in residues:
        if residue.name not in _HYDROGEN_BONDS:
            raise InputError(
                f"residue {residue.name} {chain.id}:{residue.id} is none of DA, DC, DG, DT"
            )
    return residues


def _pair_bonds(first: app.topology.Residue, second: app.topology.Residue) -> list[tuple[int, int]]:
    indices = [{atom.name: atom.index for atom in residue.atoms()} for residue in (first, second)]
    partner = {"DA": "DT", "DT": "DA", "DG": "DC", "DC": "DG"}
    if partner[first.name] != second.name:
        raise InputError(
            f"{first.name} {first.chain.id}:{first.id} and {second.name}"
            f" {second.chain.id}:{second.id} do not pair"
        )
    return [(indices[0][a], indices[1][b]) for a, b in _HYDROGEN_BONDS[first.name]]
