"""The two atoms of a structure that are nearest to each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from openmm import app
from scipy.spatial import cKDTree


def nearest_atoms(topology: app.Topology, positions_nm: NDArray[np.float64]) -> str:
    """Return in words which two atoms are nearest to each other, and how near.

    A bond is 0.1 nm long, so atoms nearer than that clash.
    """
    distances, others = cKDTree(positions_nm).query(positions_nm, k=2)
    one = int(np.argmin(distances[:, 1]))
    # Of two atoms in one place either may come first among the neighbours of each.
    other = int(next(index for index in others[one] if index != one))
    atoms = list(topology.atoms())
    names = [
        f"{atoms[i].residue.chain.id}:{atoms[i].residue.id} {atoms[i].name}" for i in (one, other)
    ]
    return f"{names[0]} and {names[1]}, {distances[one, 1]:.4f} nm apart"
