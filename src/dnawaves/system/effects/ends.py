"""Ends that are held by springs instead of frozen."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import openmm
from numpy.typing import NDArray

from dnawaves.units import PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]


def restraint(
    positions_nm: Array,
    masses_Da: Array,
    pairs: NDArray[np.intp],
    held: Iterable[int],
    stiffness_pN_per_nm: float,
    *,
    periodic: bool = False,
) -> openmm.CustomExternalForce:
    """Return springs that hold base pairs where they are, in position and in orientation.

    Every atom of a held pair is tied to its place by its share, by mass, of the pair's
    stiffness K. So the pair's centre of mass feels K in each direction, its orientation K I/M with
    I its moment of inertia and M its mass, and in both it vibrates with sqrt(K/M).

    Parameters
    ----------
    positions_nm : (atoms, 3) where the springs are at rest
    masses_Da : (atoms,) true masses
    pairs : (atoms,) index of each atom's base pair
    held : indices of the base pairs to hold
    stiffness_pN_per_nm : K, of each base pair
    periodic : whether atoms may be moved by whole box lengths
    """
    squared = "periodicdistance(x, y, z, x0, y0, z0)^2"
    if not periodic:
        squared = "(x - x0)^2 + (y - y0)^2 + (z - z0)^2"
    force = openmm.CustomExternalForce(f"0.5*k*({squared})")
    for name in ("k", "x0", "y0", "z0"):
        force.addPerParticleParameter(name)
    # pN/nm to kJ/mol/nm^2 is the same factor as pN to kJ/mol/nm.
    stiffness = stiffness_pN_per_nm / PN_PER_KJ_PER_MOL_NM
    for pair in held:
        atoms = np.flatnonzero(pairs == pair)
        shares = stiffness * masses_Da[atoms] / masses_Da[atoms].sum()
        for atom, share in zip(atoms, shares, strict=True):
            force.addParticle(int(atom), [share, *positions_nm[atom]])
    return force
