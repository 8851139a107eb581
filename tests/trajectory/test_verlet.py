"""The integrators on oscillators whose motion is known in closed form."""

from __future__ import annotations

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray

from dnawaves.rod.oscillator import gaussian_pulse_response, sine_drive_response
from dnawaves.system.effects.thermostat import langevin_middle
from dnawaves.trajectory.dynamics import Dynamics, Saved
from dnawaves.trajectory.verlet import (
    driven_leapfrog,
    gaussian_course,
    leapfrog,
    sine_course,
    steps_per_sum,
)
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

Array = NDArray[np.float64]
MASS_DA, FREQUENCY_PER_PS = 12.0, 3.0
STIFFNESS = MASS_DA * FREQUENCY_PER_PS**2
START_NM = 0.1
HELD_NM = [0.2, 0.3, 0.4]


class Oscillator:
    """A particle on a spring along x, and one without mass on another spring."""

    def __init__(
        self,
        integrator: openmm.Integrator,
        stiffness: float = STIFFNESS,
        drive: float | None = None,
    ) -> None:
        system = openmm.System()
        system.addParticle(MASS_DA)
        system.addParticle(0.0)
        spring = openmm.CustomExternalForce("0.5*k*(x*x + y*y + z*z)")
        spring.addGlobalParameter("k", stiffness)
        for particle in range(2):
            spring.addParticle(particle, [])
        system.addForce(spring)
        # The particle that is held is pushed too.
        forces = None if drive is None else np.array([[drive, 0, 0], [drive, drive, drive]])
        self.dynamics = Dynamics(system, integrator, forces, platform="Reference")
        self.start(0.0)

    def start(self, x_nm: float, v: float = 0.0) -> None:
        self.dynamics.start(np.array([[x_nm, 0, 0], HELD_NM]), np.array([[v, 0, 0], [0, 0, 0]]))

    def state(self) -> tuple[float, float]:
        """Return x in nm and its velocity in nm/ps."""
        frame = self.dynamics.frame()
        return float(frame.positions_nm[0, 0]), float(frame.velocities_nm_per_ps[0, 0])

    def energy(self) -> float:
        """Return the energy of the particle that moves in kJ/mol."""
        x_nm, v = self.state()
        return MASS_DA / 2 * v**2 + STIFFNESS / 2 * x_nm**2


def error_after_one_ps(steps: int) -> Array:
    """Return the errors of position and velocity at a time when neither is extreme."""
    oscillator = Oscillator(leapfrog(1 / steps))
    oscillator.start(START_NM)
    oscillator.dynamics.step(steps)
    phase = FREQUENCY_PER_PS * 1.0
    exact = (
        START_NM * np.cos(phase),
        -START_NM * FREQUENCY_PER_PS * np.sin(phase),
    )
    return np.abs(np.subtract(oscillator.state(), exact))


def test_position_and_velocity_are_of_second_order() -> None:
    coarse, fine = error_after_one_ps(100), error_after_one_ps(200)
    # A leapfrog's own velocities, half a step late, would have order 1. The next term is smaller
    # by (omega dt)² = 1e-3, but the leading one of x is small at this phase: 0.05.
    np.testing.assert_allclose(np.log2(coarse / fine), 2.0, atol=0.05)


def test_trajectory_is_that_of_velocity_verlet_to_the_last_digit() -> None:
    steps, timestep_ps = 57, 0.1
    oscillator = Oscillator(leapfrog(timestep_ps))
    oscillator.start(START_NM)
    oscillator.dynamics.step(steps)
    # Closed form: x = A cos(n theta), v = -A sin(n theta) sin(theta)/dt, both at the same time,
    # with sin(theta/2) = omega dt/2.
    theta = 2 * np.arcsin(FREQUENCY_PER_PS * timestep_ps / 2)
    x_nm, v = oscillator.state()
    # Round-off of 57 steps.
    assert x_nm == pytest.approx(START_NM * np.cos(steps * theta), abs=1e-14)
    assert v == pytest.approx(
        -START_NM * np.sin(steps * theta) * np.sin(theta) / timestep_ps, abs=1e-13
    )


def test_driven_leapfrog_without_a_drive_is_the_leapfrog() -> None:
    plain, driven = Oscillator(leapfrog(0.02)), Oscillator(driven_leapfrog(0.02, "0"), drive=1.0)
    for oscillator in (plain, driven):
        oscillator.start(START_NM, 0.3)
        oscillator.dynamics.step(500)
    # Round-off of 500 steps.
    np.testing.assert_allclose(plain.state(), driven.state(), atol=1e-12)


def test_kinetic_energy_is_the_thermostats_also_of_stiff_bonds() -> None:
    """A thousand particles on springs as stiff as bonds to hydrogen, 1.1 rad in a step."""
    count, omega_per_ps, timestep_ps, temperature_K = 1000, 550.0, 0.002, 300.0
    system = openmm.System()
    springs = openmm.CustomExternalForce(f"0.5*{omega_per_ps**2}*(x^2 + y^2 + z^2)")
    for index in range(count):
        system.addParticle(1.0)
        springs.addParticle(index)
    system.addForce(springs)
    one = Dynamics(system, langevin_middle(temperature_K, 50.0, timestep_ps, 1), seeds=(1,))
    one.start(np.zeros((count, 3)), np.zeros((count, 3)))
    one.step(100)  # ten times the time in which friction forgets the cold start
    thermal = 1.5 * count * BOLTZMANN_KJ_PER_MOL_K * temperature_K
    found, at_places = [], []
    for _ in range(50):
        one.step(10)
        frame = one.frame()
        found.append(frame.late_kinetic_kJ_per_mol / thermal)
        at_places.append(0.5 * np.sum(frame.velocities_nm_per_ps**2) / thermal)
    # sqrt(2/3000) = 2.6 % in a frame, 50 frames of which every other is independent: 0.5 %.
    assert np.mean(found) == pytest.approx(1, abs=0.02)
    # Velocities at the time of the positions are the means of two half a step from it.
    expected = 1 - (omega_per_ps * timestep_ps) ** 2 / 4
    assert np.mean(at_places) == pytest.approx(expected, abs=0.02)


def test_motion_runs_back_to_its_start() -> None:
    oscillator = Oscillator(leapfrog(0.02))
    oscillator.start(START_NM, 0.3)
    oscillator.dynamics.step(500)
    x_nm, v = oscillator.state()
    assert abs(x_nm - START_NM) > 1e-3
    oscillator.start(x_nm, -v)
    oscillator.dynamics.step(500)
    # Round-off of 1000 steps.
    np.testing.assert_allclose(oscillator.state(), (START_NM, -0.3), atol=1e-12)


def test_energy_is_that_of_positions_and_velocities_of_one_time() -> None:
    oscillator = Oscillator(leapfrog(0.02))
    oscillator.start(START_NM, 0.3)
    held = STIFFNESS / 2 * np.dot(HELD_NM, HELD_NM)
    for _ in range(5):
        oscillator.dynamics.step(17)
        energy = oscillator.dynamics.frame().energy_kJ_per_mol
        assert energy == pytest.approx(held + oscillator.energy(), rel=1e-14)  # round-off


@pytest.mark.parametrize("ramp_ps", [0.0, 2.5])
@pytest.mark.parametrize("drive_per_ps", [0.9, 3.0, 7.0])
def test_driven_oscillator_follows_its_closed_form(drive_per_ps: float, ramp_ps: float) -> None:
    force, duration_ps, steps = 5.0, 6.0, 3000
    course = sine_course(1e3 * drive_per_ps / (2 * np.pi), ramp_ps)
    oscillator = Oscillator(driven_leapfrog(duration_ps / steps, course), drive=force)
    times_ps, found, work, energy = [0.0], [(0.0, 0.0)], [0.0], [0.0]
    for frame in range(1, 101):
        oscillator.dynamics.step(steps // 100)
        times_ps.append(frame * duration_ps / 100)
        found.append(oscillator.state())
        work.append(oscillator.dynamics.drive_variable("work"))
        energy.append(oscillator.energy())
    response = sine_drive_response(times_ps, FREQUENCY_PER_PS, 0.0, drive_per_ps, ramp_ps)
    exact = np.stack(response, axis=1)[..., 0] * (force / MASS_DA)
    error = np.abs(np.array(found) - exact).max(axis=0) / np.abs(exact).max(axis=0)
    # (omega dt)²/24 per radian, over 18 to 42 rad: 6e-5 at omega dt = 6e-3 and 1.4e-2.
    assert error.max() < 3e-4
    # The spring's energy includes all that the drive put in. Error of the same order.
    np.testing.assert_allclose(work, energy, atol=1e-3 * max(energy))


def test_a_ramp_leaves_hardly_a_transient() -> None:
    # Far below resonance the answer is the static one, and a transient is all that differs.
    drive_per_ps, force, timestep_ps = 0.3, 5.0, 0.01
    static_nm = force / STIFFNESS / (1 - (drive_per_ps / FREQUENCY_PER_PS) ** 2)
    transients = []
    for ramp_ps in (0.0, 15.0):
        course = sine_course(1e3 * drive_per_ps / (2 * np.pi), ramp_ps)
        oscillator = Oscillator(driven_leapfrog(timestep_ps, course), drive=force)
        oscillator.dynamics.step(1600)
        left = []
        for step in range(1600, 2400, 5):
            wanted = static_nm * np.sin(drive_per_ps * step * timestep_ps)
            left.append(abs(oscillator.state()[0] - wanted) / static_nm)
            oscillator.dynamics.step(5)
        transients.append(max(left))
    # Switched on, it is drive/omega, what the jump of the force's slope sets off. A ramp leaves
    # the jumps of its curvature: (pi/ramp)²/(2 omega²) = 2.4e-3 at its end, and at its start
    # 1.5 drive (pi/ramp)²/omega³ = 0.7e-3.
    assert transients[0] == pytest.approx(0.1, rel=0.02)
    assert transients[1] < 3.2e-3


def test_pulse_delivers_its_impulse() -> None:
    width_ps, force, timestep_ps = 0.08, 3.0, 0.004
    integrator = driven_leapfrog(timestep_ps, gaussian_course(5 * width_ps, width_ps))
    oscillator = Oscillator(integrator, stiffness=0.0, drive=force)
    oscillator.dynamics.step(round(5 * width_ps / timestep_ps))
    impulse = force * width_ps * np.sqrt(2 * np.pi)
    # Symmetric about its height at five widths; the lost tail holds 3e-7.
    assert MASS_DA * oscillator.state()[1] == pytest.approx(impulse / 2, rel=1e-6)
    oscillator.dynamics.step(round(5 * width_ps / timestep_ps))
    v = oscillator.state()[1]
    assert MASS_DA * v == pytest.approx(impulse, rel=1e-6)
    assert force * oscillator.dynamics.drive_variable("impulse") == pytest.approx(impulse, rel=1e-6)
    # A free particle's energy is the work, p²/2m; at five widths the pulse has 4e-6 of its height.
    work = oscillator.dynamics.drive_variable("work")
    assert work == pytest.approx(impulse**2 / (2 * MASS_DA), rel=1e-5)


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_work_is_summed_often_enough_for_the_shortest_pulse(steps: int) -> None:
    # A scene's pulse is at least ten timesteps wide.
    timestep_ps, force = 0.002, 3.0
    width_ps = 10 * timestep_ps
    course = gaussian_course(5 * width_ps, width_ps)
    integrator = driven_leapfrog(timestep_ps, course, steps_per_sum=steps)
    oscillator = Oscillator(integrator, stiffness=0.0, drive=force)
    oscillator.dynamics.step(100)
    impulse = force * width_ps * np.sqrt(2 * np.pi)
    work = oscillator.dynamics.drive_variable("work")
    # Of fourth order in the interval, (steps/10)⁴/50 = 1.2e-3 at most; the lost tails hold 1e-5.
    assert work == pytest.approx(impulse**2 / (2 * MASS_DA), rel=(steps / 10) ** 4 / 50 + 2e-5)


def test_a_frame_ends_with_a_sum_of_the_work() -> None:
    for steps_per_frame in range(1, 200):
        steps = steps_per_sum(steps_per_frame)
        assert steps_per_frame % steps == 0
    assert steps_per_sum(33) == 3 and steps_per_sum(31) == 1 and steps_per_sum(100) == 5


def test_pulsed_oscillator_follows_its_closed_form() -> None:
    width_ps, force, timestep_ps = 0.3, 5.0, 0.002
    course = gaussian_course(5 * width_ps, width_ps)
    oscillator = Oscillator(driven_leapfrog(timestep_ps, course), drive=force)
    times_ps = 0.1 * np.arange(1, 41)
    found = []
    for _ in times_ps:
        oscillator.dynamics.step(50)
        found.append(oscillator.state())
    exact = gaussian_pulse_response(times_ps, FREQUENCY_PER_PS, 0.0, 5 * width_ps, width_ps)
    expected = np.stack(exact, axis=1)[..., 0] * (force / MASS_DA)
    # (omega dt)²/24 per radian, 2e-5; the first five widths lack 4e-6 of the height.
    for which in (0, 1):
        np.testing.assert_allclose(
            np.array(found)[:, which],
            expected[:, which],
            atol=1e-4 * np.abs(expected[:, which]).max(),
        )


@pytest.mark.parametrize("driven", [False, True])
def test_what_has_no_mass_never_moves(driven: bool) -> None:
    if driven:
        oscillator = Oscillator(driven_leapfrog(0.01, sine_course(500.0)), drive=1.0)
    else:
        oscillator = Oscillator(leapfrog(0.01))
        oscillator.start(START_NM)
    oscillator.dynamics.step(100)
    frame = oscillator.dynamics.frame()
    np.testing.assert_array_equal(frame.positions_nm[1], HELD_NM)
    assert not frame.velocities_nm_per_ps[1].any()
    assert frame.velocities_nm_per_ps[0, 0] != 0.0
    if driven:
        # Nor is work done on it: all there is moves with the other particle.
        work = oscillator.dynamics.drive_variable("work")
        assert work == pytest.approx(oscillator.energy(), rel=1e-3)  # (omega dt)²


def test_a_saved_moment_goes_on_to_the_last_digit() -> None:
    def make() -> Oscillator:
        return Oscillator(driven_leapfrog(0.01, sine_course(500.0, 3.0)), drive=2.0)

    whole, later = make(), make()
    whole.dynamics.step(137)
    saved = whole.dynamics.frame().saved
    text = openmm.XmlSerializer.serialize(saved.state)
    later.dynamics.restore(Saved(openmm.XmlSerializer.deserialize(text), saved.variables))
    for oscillator in (whole, later):
        oscillator.dynamics.step(500)
    assert later.state() == whole.state()
    for name in ("now", "impulse", "work"):
        assert later.dynamics.drive_variable(name) == whole.dynamics.drive_variable(name)
    assert whole.dynamics.drive_variable("work") > 0
