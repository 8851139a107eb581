"""Thermostats give the kinetic temperature, friction the damped oscillator."""

from __future__ import annotations

from typing import Any

import numpy as np
import openmm
import pytest

from dnawaves.system.effects.thermostat import langevin_middle, velocity_verlet_with_friction
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

PARTICLES = 400
TEMPERATURE_K = 310.0
OMEGA_per_ps = 10.0


def oscillators(bodies: Any, masses_Da: np.ndarray, *, frozen: int = 0) -> openmm.System:
    force = openmm.CustomExternalForce("0.5*k*(x^2 + y^2 + z^2)")
    force.addPerParticleParameter("k")
    for index, mass in enumerate(masses_Da):
        force.addParticle(index, [mass * OMEGA_per_ps**2])
    held = np.where(np.arange(len(masses_Da)) < frozen, 0.0, masses_Da)
    return bodies(held, force)


def on_reference(system: openmm.System, integrator: openmm.Integrator) -> openmm.Context:
    return openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))


@pytest.mark.parametrize("scheme", ["LFMiddle", "OBABO"])
def test_harmonic_particles_have_the_thermostats_temperature(bodies: Any, scheme: str) -> None:
    friction, timestep = 5.0, 0.002
    make = langevin_middle if scheme == "LFMiddle" else None
    integrator = (
        make(TEMPERATURE_K, friction, timestep, 3)
        if make
        else velocity_verlet_with_friction(timestep, friction, TEMPERATURE_K, 3)
    )
    masses = np.linspace(1.0, 30.0, PARTICLES)
    context = on_reference(oscillators(bodies, masses), integrator)
    context.setPositions(np.zeros((PARTICLES, 3)))
    integrator.step(1000)
    kinetic, potential = [], []
    for _ in range(200):
        integrator.step(50)
        state = context.getState(getEnergy=True)
        kinetic.append(state.getKineticEnergy()._value)
        potential.append(state.getPotentialEnergy()._value)
    half_kT = 1.5 * PARTICLES * BOLTZMANN_KJ_PER_MOL_K * TEMPERATURE_K
    # 1200 degrees of freedom, 200 samples 0.1 ps apart of which one in two is independent at this
    # friction: sqrt(2/1200/100) = 0.4 %; the timestep's own error is (omega dt)²/4 = 1e-4.
    assert np.mean(kinetic) / half_kT == pytest.approx(1, abs=0.015)
    assert np.mean(potential) / half_kT == pytest.approx(1, abs=0.015)


def test_friction_damps_an_oscillator_in_closed_form(bodies: Any) -> None:
    friction, timestep, start = 0.4, 0.001, 0.05
    integrator = velocity_verlet_with_friction(timestep, friction)
    context = on_reference(oscillators(bodies, np.array([12.0])), integrator)
    context.setPositions(np.array([[start, 0, 0]]))
    times, found = [], []
    for _ in range(60):
        integrator.step(50)
        state = context.getState(getPositions=True)
        times.append(state.getTime()._value)
        found.append(state.getPositions(asNumpy=True)._value[0, 0])
    t = np.array(times)
    omega = np.sqrt(OMEGA_per_ps**2 - friction**2 / 4)
    exact = np.exp(-friction * t / 2) * (
        np.cos(omega * t) + friction / 2 / omega * np.sin(omega * t)
    )
    # Velocity Verlet's frequency is (omega dt)²/24 = 4e-6 too high: 1.3e-4 rad after 3 ps.
    np.testing.assert_allclose(found, start * exact, atol=2e-4 * start)


def test_without_friction_it_is_velocity_verlet(bodies: Any) -> None:
    integrator = velocity_verlet_with_friction(0.01, 0.0)
    context = on_reference(oscillators(bodies, np.array([12.0])), integrator)
    context.setPositions(np.array([[0.05, 0.02, 0]]))
    x, v, dt = np.array([0.05, 0.02, 0]), np.zeros(3), 0.01
    for _ in range(100):
        v = v - dt / 2 * OMEGA_per_ps**2 * x
        x = x + dt * v
        v = v - dt / 2 * OMEGA_per_ps**2 * x
    integrator.step(100)
    state = context.getState(getPositions=True, getVelocities=True)
    # Round-off of 100 steps; the velocity holds (x1 - x)/dt with x1 = x too.
    np.testing.assert_allclose(state.getPositions(asNumpy=True)._value[0], x, atol=1e-13)
    np.testing.assert_allclose(state.getVelocities(asNumpy=True)._value[0], v, atol=1e-12)


def test_a_rigid_rotor_keeps_its_bond_and_its_energy(bodies: Any) -> None:
    system = bodies(np.array([10.0, 2.0]))
    system.addConstraint(0, 1, 0.1)
    integrator = velocity_verlet_with_friction(0.002, 0.0)
    integrator.setConstraintTolerance(1e-10)
    context = on_reference(system, integrator)
    context.setPositions(np.array([[0, 0, 0], [0.1, 0, 0]]))
    # About the centre of mass: momenta of opposite sign, angular velocity 12 rad/ps.
    context.setVelocities(np.array([[0, -0.2, 0], [0, 1.0, 0]]))
    integrator.step(500)
    state = context.getState(getPositions=True, getVelocities=True)
    place = state.getPositions(asNumpy=True)._value
    velocity = state.getVelocities(asNumpy=True)._value
    assert np.linalg.norm(place[0] - place[1]) == pytest.approx(0.1, rel=1e-9)
    # RATTLE conserves a free rotor's energy to the constraints' tolerance.
    energy = 0.5 * np.sum(np.array([10.0, 2.0])[:, None] * velocity**2)
    assert energy == pytest.approx(0.5 * (10 * 0.04 + 2), rel=1e-7)
    # The mapped rotor turns by 2 asin(omega dt/2)... per step: (omega dt)²/24 = 2.4e-5 of 12 rad.
    angle = np.arctan2(*(place[1] - place[0])[1::-1])
    assert angle == pytest.approx((12.0 + np.pi) % (2 * np.pi) - np.pi, abs=2e-3)


@pytest.mark.parametrize("temperature_K", [0.0, TEMPERATURE_K])
def test_frozen_particles_stay(bodies: Any, temperature_K: float) -> None:
    integrator = velocity_verlet_with_friction(0.002, 1.0, temperature_K)
    context = on_reference(oscillators(bodies, np.full(4, 12.0), frozen=2), integrator)
    start = np.full((4, 3), 0.05)
    context.setPositions(start)
    integrator.step(20)
    place = context.getState(getPositions=True).getPositions(asNumpy=True)._value
    np.testing.assert_array_equal(place[:2], start[:2])
    assert (place[2:] != start[2:]).all()


@pytest.mark.parametrize("scheme", ["LFMiddle", "OBABO"])
@pytest.mark.parametrize("first", [0, 1])
def test_the_seed_decides_the_noise(bodies: Any, scheme: str, first: int) -> None:
    places = []
    for seed in (first, first, 2):
        integrator = (
            langevin_middle(TEMPERATURE_K, 1.0, 0.002, seed)
            if scheme == "LFMiddle"
            else velocity_verlet_with_friction(0.002, 1.0, TEMPERATURE_K, seed)
        )
        context = on_reference(oscillators(bodies, np.full(2, 12.0)), integrator)
        context.setPositions(np.zeros((2, 3)))
        integrator.step(10)
        places.append(context.getState(getPositions=True).getPositions(asNumpy=True)._value)
    np.testing.assert_array_equal(places[0], places[1])
    assert np.abs(places[0] - places[2]).min() > 0
