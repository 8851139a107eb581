"""A duplex as an MDAnalysis universe, made in memory."""

from __future__ import annotations

from collections.abc import Callable

import MDAnalysis
import numpy as np
import pytest

from dnawaves.duplex.fibre import fibre_duplex


def fibre_universe(sequence: str) -> MDAnalysis.Universe:
    """Return the fibre model's heavy atoms, segments A and B, one frame."""
    duplex = fibre_duplex(sequence)
    labels = [*zip(duplex.chain_ids, duplex.residue_ids, duplex.residue_names, strict=True)]
    residues = list(dict.fromkeys(labels))
    universe = MDAnalysis.Universe.empty(
        len(labels),
        n_residues=len(residues),
        n_segments=2,
        atom_resindex=[residues.index(label) for label in labels],
        residue_segindex=[int(chain == "B") for chain, _, _ in residues],
        trajectory=True,
    )
    universe.add_TopologyAttr("names", duplex.atom_names)
    universe.add_TopologyAttr("resids", [resid for _, resid, _ in residues])
    universe.add_TopologyAttr("resnames", [name for _, _, name in residues])
    universe.add_TopologyAttr("segids", ["A", "B"])
    universe.atoms.positions = np.asarray(10 * duplex.positions_nm, dtype=np.float32)
    return universe


@pytest.fixture(scope="session")
def make_universe() -> Callable[[str], MDAnalysis.Universe]:
    return fibre_universe
