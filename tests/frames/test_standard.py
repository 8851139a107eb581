"""The table of standard bases."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.frames.standard import standard_ring


@pytest.mark.parametrize(("letter", "atoms"), [("A", 9), ("G", 9), ("C", 6), ("T", 6), ("U", 6)])
def test_ring_atoms(letter: str, atoms: int) -> None:
    ring = standard_ring(letter)
    assert len(ring) == atoms
    places = np.array(list(ring.values()))
    # Olson et al. (2001): planar bases; only G N3 is listed out of plane, by 0.001 Å.
    assert np.abs(places[:, 2]).max() == (0.001 if letter == "G" else 0.0)


@pytest.mark.parametrize("letter", "ACGTU")
def test_rings_are_closed_with_aromatic_bonds(letter: str) -> None:
    ring = standard_ring(letter)
    six = np.array([ring[name] for name in ("N1", "C2", "N3", "C4", "C5", "C6")])
    bonds = np.linalg.norm(six - np.roll(six, 1, axis=0), axis=1)
    # Bonds of nucleobase rings: 1.31 to 1.45 Å (Clowney et al. 1996).
    assert ((bonds > 1.30) & (bonds < 1.46)).all()
