"""An end held by springs gives way as its stiffness says."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.system.effects.ends import restraint
from dnawaves.system.effects.loads import force_load
from dnawaves.units import PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]
STIFFNESS_pN_per_nm = 5000.0


@pytest.fixture(scope="module")
def duplex(bare: Callable[[str], Any]) -> Any:
    return bare("CGAT")


def springs(duplex: Any, *, periodic: bool = False) -> openmm.CustomExternalForce:
    return restraint(
        duplex.positions_nm,
        duplex.masses_Da,
        duplex.pairs,
        [0],
        STIFFNESS_pN_per_nm,
        periodic=periodic,
    )


def test_force_is_minus_the_gradient(duplex: Any, only: Any, slope_and_force: Any) -> None:
    evaluate = only(duplex.masses_Da, springs(duplex))
    shaken = duplex.positions_nm + np.random.default_rng(1).normal(0, 0.01, (len(duplex.pairs), 3))
    for slope, along in slope_and_force(evaluate, shaken):
        # A quadratic form: central differences are exact but for round-off.
        assert slope == pytest.approx(along, rel=1e-8)


def test_a_rigid_shift_and_turn_meet_the_stated_stiffness(duplex: Any, only: Any) -> None:
    evaluate = only(duplex.masses_Da, springs(duplex))
    held = duplex.pairs == 0
    mass, place = duplex.masses_Da[held], duplex.positions_nm[held]
    centre = mass @ place / mass.sum()
    shift = np.array([0.02, -0.03, 0.05])
    force = evaluate(duplex.positions_nm + shift)[1]
    # Hooke's law; all atoms take part, those of other base pairs do not.
    np.testing.assert_allclose(
        force.sum(axis=0) * PN_PER_KJ_PER_MOL_NM, -STIFFNESS_pN_per_nm * shift, rtol=1e-12
    )
    assert not force[~held].any()
    angle, axis = 1e-4, duplex.frame.axis
    moved = duplex.positions_nm.copy()
    moved[held] = centre + Rotation.from_rotvec(angle * axis).apply(place - centre)
    torque = np.cross(moved[held] - centre, evaluate(moved)[1][held]).sum(axis=0) @ axis
    arms = place - centre - np.outer((place - centre) @ axis, axis)
    gyration = np.sum(mass[:, None] * arms**2) / mass.sum()
    # The sine of the angle in place of the angle: 1e-8 of it.
    assert torque * PN_PER_KJ_PER_MOL_NM == pytest.approx(
        -STIFFNESS_pN_per_nm * gyration * angle, rel=1e-7
    )


def test_a_wrapped_atom_feels_the_same_spring(duplex: Any, evaluator: Any, bodies: Any) -> None:
    system = bodies(duplex.masses_Da, springs(duplex, periodic=True))
    box = 6.0
    system.setDefaultPeriodicBoxVectors(*(box * np.eye(3)))
    # A force that is periodic makes the Context so.
    nonbonded = openmm.NonbondedForce()
    nonbonded.setNonbondedMethod(openmm.NonbondedForce.CutoffPeriodic)
    for _ in duplex.masses_Da:
        nonbonded.addParticle(0, 1, 0)
    system.addForce(nonbonded)
    evaluate = evaluator(system)
    moved = duplex.positions_nm + 0.02
    energy, forces = evaluate(moved)
    wrapped, elsewhere = evaluate(moved + box * np.array([1, -1, 2]))
    # Round-off of coordinates 10 nm large: 1e-15 against displacements of 0.02.
    assert wrapped == pytest.approx(energy, rel=1e-10)
    np.testing.assert_allclose(elsewhere, forces, atol=1e-9)


def relaxed(system: openmm.System, positions_nm: Array) -> Array:
    context = openmm.Context(
        system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference")
    )
    context.setPositions(positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 0.01, 5000)
    return np.array(context.getState(getPositions=True).getPositions(asNumpy=True)._value)


def test_a_loaded_duplex_pulls_its_restrained_end_out_as_the_stiffness_says(duplex: Any) -> None:
    pull = 40.0 * duplex.frame.axis
    load = force_load(
        duplex.positions_nm, duplex.masses_Da, np.flatnonzero(duplex.pairs == 3), pull
    )
    system = duplex.system()
    for index in reversed(range(system.getNumForces())):
        # What keeps the molecule together is enough, and it keeps the strands apart: no charges.
        if isinstance(system.getForce(index), openmm.NonbondedForce):
            nonbonded = system.getForce(index)
            for atom in range(nonbonded.getNumParticles()):
                _, sigma, epsilon = nonbonded.getParticleParameters(atom)
                nonbonded.setParticleParameters(atom, 0, sigma, epsilon)
            for exception in range(nonbonded.getNumExceptions()):
                i, j, _, sigma, epsilon = nonbonded.getExceptionParameters(exception)
                nonbonded.setExceptionParameters(exception, i, j, 0, sigma, epsilon)
    system.addForce(springs(duplex))
    system.addForce(load)
    place = relaxed(system, duplex.positions_nm)
    held = duplex.pairs == 0
    moved = (
        duplex.masses_Da[held] @ (place - duplex.positions_nm)[held] / duplex.masses_Da[held].sum()
    )
    # All forces of the molecule on itself add up to nothing: whatever lies between, the springs
    # bear the whole load. Residual forces of 0.01 kJ/mol/nm (0.017 pN) on 250 atoms, at random.
    np.testing.assert_allclose(STIFFNESS_pN_per_nm * moved, pull, atol=1.0)
