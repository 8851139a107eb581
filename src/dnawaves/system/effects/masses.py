"""Base pairs that carry a load of mass, such as a bound protein."""

from __future__ import annotations

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import unit

from dnawaves.errors import InputError


def add_mass(system: openmm.System, atoms: NDArray[np.intp], added_Da: float) -> None:
    """Make the atoms heavier by `added_Da` altogether, each in proportion to its own mass.

    A base pair so keeps its centre of mass and its radius of gyration: its moments of inertia grow
    by the same factor as its mass. A protein that reaches farther out than the pair has more.
    Raises `InputError` where an atom is frozen (mass zero).
    """
    old = [system.getParticleMass(int(atom)).value_in_unit(unit.dalton) for atom in atoms]
    if not all(mass > 0 for mass in old):
        raise InputError("added mass: found frozen atoms; allowed: atoms that move")
    factor = 1 + added_Da / sum(old)
    for atom, mass in zip(atoms, old, strict=True):
        system.setParticleMass(int(atom), mass * factor)
