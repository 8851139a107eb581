"""Static loads: total force and torque, virtual work, what they conserve."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.system.effects.loads import LOAD, force_load, rigid_body_forces, torque_load
from dnawaves.units import PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]
LOADED = 2
FORCE_pN = np.array([30.0, -20.0, 60.0])
TORQUE_pN_nm = np.array([10.0, 40.0, -25.0])


@pytest.fixture(scope="module")
def duplex(bare: Callable[[str], Any]) -> Any:
    return bare("CGAT")


def atoms(duplex: Any) -> NDArray[np.intp]:
    return np.flatnonzero(duplex.pairs == LOADED)


def centre(duplex: Any, positions_nm: Array) -> Array:
    mass = duplex.masses_Da[atoms(duplex)]
    return mass @ positions_nm[atoms(duplex)] / mass.sum()


def forced(duplex: Any, **point: Any) -> openmm.Force:
    return force_load(duplex.positions_nm, duplex.masses_Da, atoms(duplex), FORCE_pN, **point)


def twisted(duplex: Any) -> openmm.Force:
    return torque_load(duplex.positions_nm, duplex.masses_Da, atoms(duplex), TORQUE_pN_nm)


def total_and_torque(duplex: Any, positions_nm: Array, forces: Array) -> tuple[Array, Array]:
    """In pN and pN nm."""
    arms = positions_nm - centre(duplex, positions_nm)
    return (
        forces.sum(axis=0) * PN_PER_KJ_PER_MOL_NM,
        np.cross(arms, forces).sum(axis=0) * PN_PER_KJ_PER_MOL_NM,
    )


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_any_body_is_accelerated_rigidly(seed: int) -> None:
    generator = np.random.default_rng(seed)
    positions, masses = generator.normal(size=(20, 3)), generator.uniform(1, 30, 20)
    force, torque = generator.normal(size=(2, 3))
    forces = rigid_body_forces(positions, masses, force, torque)
    arms = positions - masses @ positions / masses.sum()
    # Round-off of a 3 x 3 solve.
    np.testing.assert_allclose(forces.sum(axis=0), force, atol=1e-10)
    np.testing.assert_allclose(np.cross(arms, forces).sum(axis=0), torque, atol=1e-10)
    # Rigid: no two atoms' accelerations have a part along the line between them that differs.
    accelerations = forces / masses[:, None]
    lines = positions[:, None] - positions
    stretching = np.sum((accelerations[:, None] - accelerations) * lines, axis=-1)
    np.testing.assert_allclose(stretching, 0, atol=1e-10)


def test_force_load_is_the_declared_force(duplex: Any, only: Any) -> None:
    place = duplex.positions_nm
    energy, forces = only(duplex.masses_Da, forced(duplex))(place)
    total, torque = total_and_torque(duplex, place, forces)
    np.testing.assert_allclose(total, FORCE_pN, rtol=1e-12)
    np.testing.assert_allclose(torque, 0, atol=1e-10)
    assert energy == 0
    assert not forces[duplex.pairs != LOADED].any()


def test_a_force_at_a_point_has_that_points_moment(duplex: Any, only: Any) -> None:
    place = duplex.positions_nm
    point = centre(duplex, place) + np.array([0.2, 0.1, 0.0])
    forces = only(duplex.masses_Da, forced(duplex, point_nm=point))(place)[1]
    total, torque = total_and_torque(duplex, place, forces)
    np.testing.assert_allclose(total, FORCE_pN, rtol=1e-10)
    np.testing.assert_allclose(torque, np.cross([0.2, 0.1, 0.0], FORCE_pN), atol=1e-9)


def test_torque_load_is_a_couple_of_the_declared_torque(duplex: Any, only: Any) -> None:
    place = duplex.positions_nm
    energy, forces = only(duplex.masses_Da, twisted(duplex))(place)
    total, torque = total_and_torque(duplex, place, forces)
    np.testing.assert_allclose(total, 0, atol=1e-10)
    np.testing.assert_allclose(torque, TORQUE_pN_nm, rtol=1e-10)
    assert energy == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("angle_rad", [-2.0, -0.3, 0.5, 3.0])
def test_the_torque_follows_the_body_and_its_work_is_torque_times_angle(
    duplex: Any, only: Any, angle_rad: float
) -> None:
    chosen, place = atoms(duplex), duplex.positions_nm
    middle = centre(duplex, place)
    mass, arms = duplex.masses_Da[chosen], place[chosen] - middle
    second = arms.T @ (mass[:, None] * arms)
    axis = np.linalg.solve(np.trace(second) * np.eye(3) - second, TORQUE_pN_nm)
    axis /= np.linalg.norm(axis)
    moved = place.copy()
    moved[chosen] = middle + Rotation.from_rotvec(angle_rad * axis).apply(arms) + [0.1, 0.2, -0.3]
    energy, forces = only(duplex.masses_Da, twisted(duplex))(moved)
    total, torque = total_and_torque(duplex, moved, forces)
    np.testing.assert_allclose(total, 0, atol=1e-10)
    assert torque @ axis == pytest.approx(TORQUE_pN_nm @ axis, rel=1e-10)
    # Virtual work: a shift does none, a turn does torque times angle.
    work = -energy * PN_PER_KJ_PER_MOL_NM
    assert work == pytest.approx(TORQUE_pN_nm @ axis * angle_rad, rel=1e-10)


def test_virtual_work_of_a_force(duplex: Any, only: Any) -> None:
    shift = np.array([0.3, -0.2, 0.1])
    energy = only(duplex.masses_Da, forced(duplex))(duplex.positions_nm + shift)[0]
    assert -energy * PN_PER_KJ_PER_MOL_NM == pytest.approx(FORCE_pN @ shift, rel=1e-12)


@pytest.mark.parametrize("load", [forced, twisted])
def test_force_is_minus_the_gradient(
    duplex: Any, only: Any, slope_and_force: Any, load: Callable[[Any], openmm.Force]
) -> None:
    shaken = duplex.positions_nm + np.random.default_rng(1).normal(0, 0.02, (len(duplex.pairs), 3))
    for slope, along in slope_and_force(only(duplex.masses_Da, load(duplex)), shaken):
        # Round-off of energies of some kJ/mol over a step of 1e-5 nm, and its square.
        assert slope == pytest.approx(along, abs=1e-8)
        assert abs(along) > 1e-2


@pytest.mark.parametrize("load", [forced, twisted])
def test_the_load_can_be_ramped(
    duplex: Any, bodies: Any, load: Callable[[Any], openmm.Force]
) -> None:
    context = openmm.Context(
        bodies(duplex.masses_Da, load(duplex)),
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("Reference"),
    )
    context.setPositions(duplex.positions_nm)

    def forces(fraction: float) -> Array:
        context.setParameter(LOAD, fraction)
        return np.array(context.getState(getForces=True).getForces(asNumpy=True)._value)

    full = forces(1.0)
    np.testing.assert_allclose(forces(0.25), 0.25 * full, atol=1e-12)
    assert not forces(0.0).any()
    assert np.abs(full).max() > 0.1


def test_a_loaded_duplex_gains_momentum_or_spin_and_no_energy(duplex: Any) -> None:
    masses, steps, dt = duplex.masses_Da, 100, 0.0005
    for load in (forced, twisted):
        system = duplex.system()
        system.addForce(load(duplex))
        integrator = openmm.CustomIntegrator(dt)
        for name, change in (("v", "v+0.5*dt*f/m"), ("x", "x+dt*v"), ("v", "v+0.5*dt*f/m")):
            integrator.addComputePerDof(name, change)
        context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
        context.setPositions(duplex.positions_nm)
        openmm.LocalEnergyMinimizer.minimize(context, 10.0, 50)
        context.setVelocities(np.zeros_like(duplex.positions_nm))
        before = context.getState(getEnergy=True)
        integrator.step(steps)
        after = context.getState(getEnergy=True, getVelocities=True)
        actual = np.array([system.getParticleMass(i)._value for i in range(len(masses))])
        momentum = actual @ after.getVelocities(asNumpy=True)._value
        impulse = FORCE_pN / PN_PER_KJ_PER_MOL_NM * steps * dt if load is forced else np.zeros(3)
        # The molecule's own forces cancel to round-off, 1e-12 of 1e5 kJ/mol/nm over 0.05 ps.
        np.testing.assert_allclose(momentum, impulse, atol=1e-7)
        gained = after.getKineticEnergy()._value
        drift = after.getPotentialEnergy() + after.getKineticEnergy() - before.getPotentialEnergy()
        assert gained > 0.01
        # Velocity Verlet at 0.5 fs with bonds of 0.6 rad/fs... shadow energy, (omega dt)²/8 = 1 %.
        assert abs(drift._value) < 0.02 * gained
