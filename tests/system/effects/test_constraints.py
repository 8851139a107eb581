"""Constraints keep bond lengths, heavier hydrogens keep each residue's mass."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest

from dnawaves.errors import InputError
from dnawaves.system.effects.constraints import hydrogen_options, refuse_constraints_on_frozen


@pytest.fixture(scope="module")
def duplex(bare: Callable[[str], Any]) -> Any:
    return bare("CGAT")


def masses_Da(system: openmm.System) -> np.ndarray:
    return np.array([system.getParticleMass(i)._value for i in range(system.getNumParticles())])


def freeze(system: openmm.System, atoms: np.ndarray) -> openmm.System:
    for atom in atoms:
        system.setParticleMass(int(atom), 0.0)
    return system


def test_repartitioning_keeps_each_residues_mass(duplex: Any) -> None:
    plain = masses_Da(duplex.system(**hydrogen_options("none", None)))
    moved = masses_Da(duplex.system(**hydrogen_options("none", 3.0)))
    totals: dict[int, list[float]] = defaultdict(lambda: [0.0, 0.0])
    for atom in duplex.topology.atoms():
        totals[atom.residue.index][0] += plain[atom.index]
        totals[atom.residue.index][1] += moved[atom.index]
        if atom.element.symbol == "H":
            assert moved[atom.index] == 3.0
        else:
            assert moved[atom.index] > 3.0
    for before, after in totals.values():
        # Round-off of a sum of 33 masses.
        assert after == pytest.approx(before, rel=1e-12)


def test_every_hydrogen_is_constrained_and_its_bond_keeps_its_length(duplex: Any) -> None:
    system = duplex.system(**hydrogen_options("hbonds", 3.0))
    hydrogens = sum(atom.element.symbol == "H" for atom in duplex.topology.atoms())
    assert system.getNumConstraints() == hydrogens
    assert duplex.system(**hydrogen_options("none", None)).getNumConstraints() == 0
    integrator = openmm.LangevinMiddleIntegrator(300, 1, 0.001)
    integrator.setConstraintTolerance(1e-8)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(duplex.positions_nm)
    context.applyConstraints(1e-8)
    openmm.LocalEnergyMinimizer.minimize(context, 100.0, 20)
    integrator.step(20)
    place = context.getState(getPositions=True).getPositions(asNumpy=True)._value
    for index in range(hydrogens):
        i, j, length = system.getConstraintParameters(index)
        # The tolerance set above.
        assert np.linalg.norm(place[i] - place[j]) == pytest.approx(length._value, rel=2e-8)


def test_constraints_on_frozen_atoms_are_refused_by_name(duplex: Any) -> None:
    frozen = np.flatnonzero(duplex.pairs == 0)
    system = freeze(duplex.system(**hydrogen_options("hbonds", None)), frozen)
    hydrogens = sum(atom.element.symbol == "H" for atom in duplex.topology.atoms())
    with pytest.raises(
        InputError, match=r"found \d+ .* first that of A:1:\S+ and A:1:\S+; allowed"
    ):
        refuse_constraints_on_frozen(system, duplex.topology)
    assert 0 < sum(duplex.pairs == 0) < hydrogens + len(frozen)
    refuse_constraints_on_frozen(
        freeze(duplex.system(**hydrogen_options("none", None)), frozen), duplex.topology
    )
    refuse_constraints_on_frozen(duplex.system(**hydrogen_options("hbonds", None)), duplex.topology)


def test_openmm_refuses_one_between_a_frozen_and_a_free_atom(duplex: Any) -> None:
    system = duplex.system(**hydrogen_options("hbonds", None))
    one, _, _ = system.getConstraintParameters(0)
    freeze(system, np.array([one]))
    with pytest.raises(openmm.OpenMMException, match="massless"):
        openmm.Context(
            system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference")
        )
    with pytest.raises(InputError, match=r"found [123] that touch"):
        refuse_constraints_on_frozen(system, duplex.topology)
