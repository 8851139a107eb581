"""Added mass makes a base pair heavier and slower to turn, and changes nothing else."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest

from dnawaves.errors import InputError
from dnawaves.system.effects.masses import add_mass
from dnawaves.system.rigid_body import RigidBodies

ADDED_Da = 5000.0


@pytest.fixture(scope="module")
def duplex(bare: Callable[[str], Any]) -> Any:
    return bare("CGAT")


def bodies_of(duplex: Any, system: openmm.System) -> RigidBodies:
    masses = [system.getParticleMass(i)._value for i in range(system.getNumParticles())]
    return RigidBodies(duplex.positions_nm, np.array(masses), duplex.pairs)


def test_mass_and_inertia_grow_by_one_factor(duplex: Any) -> None:
    system = duplex.system()
    before = bodies_of(duplex, system)
    add_mass(system, np.flatnonzero(duplex.pairs == 2), ADDED_Da)
    after = bodies_of(duplex, system)
    factor = 1 + ADDED_Da / before.masses_Da[2]
    # Round-off of sums over 64 atoms.
    expected = before.masses_Da + ADDED_Da * (np.arange(4) == 2)
    np.testing.assert_allclose(after.masses_Da, expected, rtol=1e-12)
    np.testing.assert_allclose(after.centres_nm, before.centres_nm, atol=1e-12)
    np.testing.assert_allclose(
        after.inertia_Da_nm2[2], factor * before.inertia_Da_nm2[2], rtol=1e-10, atol=1e-9
    )
    np.testing.assert_array_equal(after.inertia_Da_nm2[:2], before.inertia_Da_nm2[:2])


def test_frozen_atoms_take_no_mass(duplex: Any) -> None:
    system = duplex.system()
    atoms = np.flatnonzero(duplex.pairs == 0)
    system.setParticleMass(int(atoms[3]), 0.0)
    with pytest.raises(InputError, match="frozen"):
        add_mass(system, atoms, ADDED_Da)
