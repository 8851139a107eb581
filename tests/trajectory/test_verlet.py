"""The integrators on oscillators whose motion is known in closed form."""

from __future__ import annotations

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray

from dnawaves.rod.modal import sine_drive_response
from dnawaves.trajectory.verlet import (
    driven_velocity_verlet,
    gaussian_course,
    sine_course,
    velocity_verlet,
)

Array = NDArray[np.float64]
MASS_DA, FREQUENCY_PER_PS = 12.0, 3.0
STIFFNESS = MASS_DA * FREQUENCY_PER_PS**2
START_NM = 0.1


class Oscillator:
    """A particle on a spring along x, and one without mass on another spring."""

    def __init__(self, integrator: openmm.CustomIntegrator, stiffness: float = STIFFNESS) -> None:
        system = openmm.System()
        system.addParticle(MASS_DA)
        system.addParticle(0.0)
        spring = openmm.CustomExternalForce("0.5*k*(x*x + y*y + z*z)")
        spring.addGlobalParameter("k", stiffness)
        for particle in range(2):
            spring.addParticle(particle, [])
        system.addForce(spring)
        self.integrator = integrator
        self.context = openmm.Context(
            system, integrator, openmm.Platform.getPlatformByName("Reference")
        )
        self.start(0.0)

    def start(self, x_nm: float, v: float = 0.0) -> None:
        self.context.setPositions([[x_nm, 0, 0], [0.2, 0.3, 0.4]])
        self.context.setVelocities([[v, 0, 0], [0, 0, 0]])

    def state(self) -> tuple[float, float]:
        """Return x in nm and its velocity in nm/ps."""
        state = self.context.getState(getPositions=True, getVelocities=True)
        return (
            state.getPositions(asNumpy=True)._value[0, 0],
            state.getVelocities(asNumpy=True)._value[0, 0],
        )

    def held_nm(self) -> Array:
        """Return where the particle without mass is."""
        return np.array(self.context.getState(getPositions=True).getPositions()[1]._value)


def error_after_one_ps(steps: int) -> Array:
    """Return the errors of position and velocity at a time when neither is extreme."""
    oscillator = Oscillator(velocity_verlet(1 / steps))
    oscillator.start(START_NM)
    oscillator.integrator.step(steps)
    phase = FREQUENCY_PER_PS * 1.0
    exact = (
        START_NM * np.cos(phase),
        -START_NM * FREQUENCY_PER_PS * np.sin(phase),
    )
    return np.abs(np.subtract(oscillator.state(), exact))


def test_position_and_velocity_are_of_second_order() -> None:
    coarse, fine = error_after_one_ps(100), error_after_one_ps(200)
    # A leapfrog's velocities, half a step late, would have order 1. The next term is smaller by
    # (omega dt)² = 1e-3, but the leading one of x is small at this phase: 0.05.
    np.testing.assert_allclose(np.log2(coarse / fine), 2.0, atol=0.05)


def test_trajectory_is_that_of_velocity_verlet_to_the_last_digit() -> None:
    steps, timestep_ps = 57, 0.1
    oscillator = Oscillator(velocity_verlet(timestep_ps))
    oscillator.start(START_NM)
    oscillator.integrator.step(steps)
    # Closed form: x = A cos(n theta), v = -A sin(n theta) sin(theta)/dt, both at the same time,
    # with sin(theta/2) = omega dt/2.
    theta = 2 * np.arcsin(FREQUENCY_PER_PS * timestep_ps / 2)
    x_nm, v = oscillator.state()
    # Round-off of 57 steps.
    assert x_nm == pytest.approx(START_NM * np.cos(steps * theta), abs=1e-14)
    assert v == pytest.approx(
        -START_NM * np.sin(steps * theta) * np.sin(theta) / timestep_ps, abs=1e-13
    )


def test_motion_runs_back_to_its_start() -> None:
    oscillator = Oscillator(velocity_verlet(0.02))
    oscillator.start(START_NM, 0.3)
    oscillator.integrator.step(500)
    x_nm, v = oscillator.state()
    assert abs(x_nm - START_NM) > 1e-3
    oscillator.start(x_nm, -v)
    oscillator.integrator.step(500)
    # Round-off of 1000 steps.
    np.testing.assert_allclose(oscillator.state(), (START_NM, -0.3), atol=1e-12)


@pytest.mark.parametrize("drive_per_ps", [0.9, 3.0, 7.0])
def test_driven_oscillator_follows_its_closed_form(drive_per_ps: float) -> None:
    force, duration_ps, steps = 5.0, 6.0, 3000
    frequency_GHz = 1e3 * drive_per_ps / (2 * np.pi)
    integrator = driven_velocity_verlet(duration_ps / steps, sine_course(frequency_GHz))
    oscillator = Oscillator(integrator)
    integrator.setPerDofVariableByName("drive", [[force, 0, 0], [0, 0, 0]])
    times_ps, found, work, energy = [0.0], [(0.0, 0.0)], [0.0], [0.0]
    for frame in range(1, 101):
        integrator.step(steps // 100)
        x_nm, v = oscillator.state()
        times_ps.append(frame * duration_ps / 100)
        found.append((x_nm, v))
        work.append(integrator.getGlobalVariableByName("work"))
        energy.append(MASS_DA / 2 * v**2 + STIFFNESS / 2 * x_nm**2)
    exact = np.stack(sine_drive_response(times_ps, FREQUENCY_PER_PS, 0.0, drive_per_ps), axis=1)[
        ..., 0
    ] * (force / MASS_DA)
    error = np.abs(np.array(found) - exact).max(axis=0) / np.abs(exact).max(axis=0)
    # (omega dt)²/24 per radian, over 18 to 42 rad: 6e-5 at omega dt = 6e-3 and 1.4e-2.
    assert error.max() < 3e-4
    # The spring's energy includes all that the drive put in. Error of the same order.
    np.testing.assert_allclose(work, energy, atol=1e-3 * max(energy))


def test_pulse_delivers_its_impulse() -> None:
    width_ps, force, timestep_ps = 0.08, 3.0, 0.004
    integrator = driven_velocity_verlet(timestep_ps, gaussian_course(5 * width_ps, width_ps))
    oscillator = Oscillator(integrator, stiffness=0.0)
    integrator.setPerDofVariableByName("drive", [[force, 0, 0], [0, 0, 0]])
    integrator.step(round(5 * width_ps / timestep_ps))
    impulse = force * width_ps * np.sqrt(2 * np.pi)
    # Symmetric about its height at five widths; the lost tail holds 3e-7.
    assert MASS_DA * oscillator.state()[1] == pytest.approx(impulse / 2, rel=1e-6)
    integrator.step(round(5 * width_ps / timestep_ps))
    v = oscillator.state()[1]
    assert MASS_DA * v == pytest.approx(impulse, rel=1e-6)
    # A free particle's energy is the work, p²/2m; at five widths the pulse has 4e-6 of its height.
    work = integrator.getGlobalVariableByName("work")
    assert work == pytest.approx(impulse**2 / (2 * MASS_DA), rel=1e-5)


@pytest.mark.parametrize("driven", [False, True])
def test_what_has_no_mass_never_moves(driven: bool) -> None:
    if driven:
        integrator = driven_velocity_verlet(0.01, sine_course(500.0))
        oscillator = Oscillator(integrator)
        integrator.setPerDofVariableByName("drive", [[1, 1, 1], [1, 1, 1]])
    else:
        oscillator = Oscillator(velocity_verlet(0.01))
        oscillator.start(START_NM)
    oscillator.integrator.step(100)
    np.testing.assert_array_equal(oscillator.held_nm(), [0.2, 0.3, 0.4])
    assert oscillator.state()[1] != 0.0
    if driven:
        # Nor is work done on it: all there is moves with the other particle.
        state = oscillator.context.getState(getPositions=True, getVelocities=True)
        x, v = (
            quantity(asNumpy=True)._value[0]
            for quantity in (state.getPositions, state.getVelocities)
        )
        energy = MASS_DA / 2 * v @ v + STIFFNESS / 2 * x @ x
        work = oscillator.integrator.getGlobalVariableByName("work")
        assert work == pytest.approx(energy, rel=1e-3)  # (omega dt)²
