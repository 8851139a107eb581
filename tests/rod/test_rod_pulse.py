"""One mode under a Gaussian, a ramped sine and a sampled force: integration and limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from dnawaves.errors import InputError
from dnawaves.rod.oscillator import (
    gaussian_pulse_response,
    impulse_response,
    sampled_force_response,
    sine_drive_response,
)

TIMES = np.linspace(0, 40, 81)
CENTRE = 12.0

# undamped, underdamped, critical, a hair off critical, overdamped, far overdamped, no spring
OSCILLATORS = [
    (0.8, 0.0),
    (0.8, 0.3),
    (0.8, 1.6),
    (0.8, 1.6 + 1e-9),
    (0.8, 1.7),
    (0.8, 5.0),
    (1e-4, 5.0),
    (0.0, 0.7),
    (1e-9, 0.0),
    (0.0, 0.0),
]


def integrate(w: float, friction: float, force, times: np.ndarray = TIMES) -> np.ndarray:
    def rates(t: float, state: np.ndarray) -> list[float]:
        return [state[1], force(t) - friction * state[1] - w**2 * state[0]]

    # the short steps see the pulse and keep the interpolation between them as good as the steps
    return solve_ivp(
        rates,
        (times[0], times[-1]),
        [0.0, 0.0],
        "DOP853",
        times,
        rtol=1e-11,
        atol=1e-13,
        max_step=0.1,
    ).y


@pytest.mark.parametrize(("w", "friction"), OSCILLATORS)
@pytest.mark.parametrize("width", [0.46, 1.5])
def test_gaussian_pulse_agrees_with_integration(w: float, friction: float, width: float) -> None:
    expected = integrate(w, friction, lambda t: np.exp(-(((t - CENTRE) / width) ** 2) / 2))
    computed = gaussian_pulse_response(TIMES, [w], friction, CENTRE, width)
    for part, reference in zip(computed, expected, strict=True):
        # the integrator's tolerance, grown over 400 steps; it starts 8 widths before the pulse's
        # top, where the force is 1e-14
        assert part[:, 0] == pytest.approx(reference, rel=1e-8, abs=1e-10 * np.abs(reference).max())


@settings(max_examples=60, deadline=None)
@given(
    w=st.floats(0, 30),
    friction=st.floats(0, 60),
    width=st.floats(0.1, 10),
    offset=st.floats(-6, 40),
)
@example(w=0.0, friction=41.0, width=10.0, offset=0.0)
@example(w=30.0, friction=0.0, width=10.0, offset=40.0)
def test_gaussian_pulse_is_the_sum_of_the_impulses_before(
    w: float, friction: float, width: float, offset: float
) -> None:
    time = CENTRE + offset * width
    edges = CENTRE + width * np.arange(-9.0, 10.0)
    edges = np.append(edges[edges < time], min(time, CENTRE + 9 * width))

    def impulses(of: int) -> float:
        # pieces in which the fastest oscillation or decay goes through 3 radians or e-foldings
        pieces = 2 + int((edges[-1] - edges[0]) * max(w, friction) / 3)
        points = np.unique(np.concatenate([edges, np.linspace(edges[0], edges[-1], pieces)]))
        nodes, weights = np.polynomial.legendre.leggauss(20)
        middle, half = (points[1:] + points[:-1]) / 2, np.diff(points) / 2
        starts = middle[:, np.newaxis] + half[:, np.newaxis] * nodes
        force = np.exp(-(((starts - CENTRE) / width) ** 2) / 2)
        kicks = impulse_response(time - starts.ravel(), [w], friction)[of].reshape(starts.shape)
        return float(np.sum(half[:, np.newaxis] * weights * force * kicks))

    computed = gaussian_pulse_response([time], [w], friction, CENTRE, width)
    # size of the answer: force times duration, times the memory of the mode
    size = width * (1 + min(abs(offset) * width, 40 * width))
    for of in (0, 1):
        # round-off of terms whose sum is the size, and 1e-18 of the force beyond 9 widths
        assert computed[of][0, 0] == pytest.approx(impulses(of), abs=1e-12 * size)


def test_long_before_the_pulse_nothing_moves_and_a_slow_pulse_is_followed_at_rest() -> None:
    width, w = 3e4, 2.0
    for friction in (0.0, 0.5, 4.0, 50.0):
        before, _ = gaussian_pulse_response([-1e9, -50 * width], [w], friction, 0.0, width)
        assert np.all(before == 0)
        times = width * np.array([-6.0, -1.0, 0.0, 0.7, 6.0])
        position, _ = gaussian_pulse_response(times, [w], friction, 0.0, width)
        rest = np.exp(-((times / width) ** 2) / 2) / w**2
        # next order of slow motion: friction/w^2 times the rate 6/width
        assert position[:, 0] == pytest.approx(rest, rel=1.5 * 6 * (friction + 1e-3) / w**2 / width)


def test_a_short_pulse_is_a_kick_of_its_area_and_a_long_decay_does_not_overflow() -> None:
    width, times = 1e-4, np.array([0.1, 1.0, 50.0, 2000.0])
    for w, friction in OSCILLATORS:
        pulse = gaussian_pulse_response(times, [w], friction, 0.0, width)
        kick = impulse_response(times, [w], friction)
        for computed, expected in zip(pulse, kick, strict=True):
            # second moment of the pulse: (width times the fastest rate, 5 /ps)^2
            assert computed / (width * np.sqrt(2 * np.pi)) == pytest.approx(
                expected, rel=1e-6, abs=1e-10
            )
    for friction in (1e3, 1e5):
        position, velocity = gaussian_pulse_response([-5.0, 0.0, 5.0, 1e5], [3.0], friction, 0, 1)
        assert np.isfinite(position).all() and np.isfinite(velocity).all()


def test_momentum_of_a_pulse_without_spring_is_its_area() -> None:
    width = 0.7
    _, velocity = gaussian_pulse_response([CENTRE + 30 * width], [0.0], 0.0, CENTRE, width)
    # closed form
    assert velocity[0, 0] == pytest.approx(width * np.sqrt(2 * np.pi), rel=1e-14)
    position, _ = gaussian_pulse_response([CENTRE, CENTRE + 50], [0.0], 0.0, CENTRE, width)
    # half the distribution's first moment at its top, then straight on
    assert position[:, 0] == pytest.approx([width**2, 50 * width * np.sqrt(2 * np.pi)], rel=1e-14)


@pytest.mark.parametrize(("w", "friction"), OSCILLATORS)
# at, near and far from resonance; a ramp as slow as the drive itself, whose lower side band is
# then at rest, and one much faster
@pytest.mark.parametrize(("drive", "ramp"), [(0.8, 10.0), (2.3, np.pi / 2.3), (0.05, 30.0)])
def test_ramped_sine_agrees_with_integration(
    w: float, friction: float, drive: float, ramp: float
) -> None:
    def force(t: float) -> float:
        return np.sin(drive * t) * ((1 - np.cos(np.pi * t / ramp)) / 2 if t < ramp else 1.0)

    expected = integrate(w, friction, force)
    computed = sine_drive_response(TIMES, [w], friction, drive, ramp)
    for part, reference in zip(computed, expected, strict=True):
        # the step in which the force's second derivative jumps, at the end of the ramp
        assert part[:, 0] == pytest.approx(reference, rel=1e-7, abs=1e-8 * np.abs(reference).max())


def test_a_slow_ramp_leaves_no_transient() -> None:
    w, drive, ramp = 2.0, 0.6, 120.0
    times = np.linspace(ramp, ramp + 30, 61)
    steady = np.sin(drive * times) / (w**2 - drive**2)
    sudden, _ = sine_drive_response(times, [w], 0.0, drive)
    ramped, _ = sine_drive_response(times, [w], 0.0, drive, ramp)
    # without friction the free motion that a sudden start leaves is drive/w of the steady one; the
    # ramp's side bands at pi/ramp cancel it but for (pi/ramp)^2/(w - drive)^2
    assert np.abs(sudden[:, 0] - steady).max() > 0.2 * np.abs(steady).max()
    assert ramped[:, 0] == pytest.approx(steady, abs=4e-4 * np.abs(steady).max())


@pytest.mark.parametrize(("w", "friction"), OSCILLATORS)
def test_sampled_force_reproduces_the_gaussian_pulse(w: float, friction: float) -> None:
    width = 1.5
    errors = []
    for interval in (0.2, 0.1):
        times = np.arange(0, 40, interval)
        force = np.exp(-(((times - CENTRE) / width) ** 2) / 2)
        computed = sampled_force_response(force, interval, [w], friction)
        expected = gaussian_pulse_response(times, [w], friction, CENTRE, width)
        errors.append(
            max(
                np.abs(part - reference).max() / np.abs(reference).max()
                for part, reference in zip(computed, expected, strict=True)
            )
        )
    # a cubic spline misses by (interval/width)^4/384 and a higher derivative's factor of some 10
    assert errors[0] < 1e-5
    # fourth order, or better where the errors of neighbouring intervals cancel
    assert errors[1] < errors[0] / 12


def test_sampled_force_keeps_its_digits_for_a_stiff_mode() -> None:
    times = np.arange(0, 20, 0.05)
    force = np.sin(0.7 * times) ** 2
    position, _ = sampled_force_response(force, 0.05, [600.0], 900.0)
    # quasi-static: the next order is friction/w^2 times the rate 1.4
    assert position[:, 0] == pytest.approx(force / 600.0**2, abs=5e-3 / 600.0**2)


def test_impossible_forces_are_refused() -> None:
    with pytest.raises(InputError, match="width"):
        gaussian_pulse_response([1.0], [1.0], 0.1, 0.0, 0.0)
    with pytest.raises(InputError, match="friction"):
        gaussian_pulse_response([1.0], [1.0], -0.1, 0.0, 1.0)
    with pytest.raises(InputError, match="ramp"):
        sine_drive_response([1.0], [1.0], 0.1, 1.0, -1.0)
    with pytest.raises(InputError, match="series"):
        sampled_force_response([1.0], 0.1, [1.0], 0.1)
    with pytest.raises(InputError, match="interval"):
        sampled_force_response([1.0, 2.0], 0.0, [1.0], 0.1)
