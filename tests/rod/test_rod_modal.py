"""Closed-form responses of one mode against numerical integration and limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dnawaves.errors import InputError
from dnawaves.rod.modal import impulse_response, sine_drive_response

TIMES = np.linspace(0, 30, 61)

# undamped, underdamped, critical, a hair off critical, overdamped, far overdamped, no spring
OSCILLATORS = [
    (0.8, 0.0),
    (0.8, 0.3),
    (0.8, 1.6),
    (0.8, 1.6 + 1e-9),
    (0.8, 5.0),
    (1e-4, 5.0),
    (0.0, 0.7),
    (0.0, 0.0),
]


def integrate(w: float, friction: float, velocity: float, drive: float | None) -> np.ndarray:
    def rates(t: float, state: np.ndarray) -> list[float]:
        force = 0.0 if drive is None else np.sin(drive * t)
        return [state[1], force - friction * state[1] - w**2 * state[0]]

    # the short steps keep the interpolation between them as good as the steps
    solution = solve_ivp(
        rates,
        (0, TIMES[-1]),
        [0.0, velocity],
        "DOP853",
        TIMES,
        rtol=1e-11,
        atol=1e-12,
        max_step=0.1,
    )
    return solution.y


@pytest.mark.parametrize(("w", "friction"), OSCILLATORS)
def test_kick_agrees_with_integration(w: float, friction: float) -> None:
    position, velocity = impulse_response(TIMES, [w], friction)
    expected = integrate(w, friction, 1.0, None)
    # the integrator's relative tolerance of 1e-11, grown over some 1e2 steps; position reaches 30
    assert position[:, 0] == pytest.approx(expected[0], rel=1e-8, abs=1e-9)
    assert velocity[:, 0] == pytest.approx(expected[1], rel=1e-8, abs=1e-9)


@pytest.mark.parametrize(("w", "friction"), OSCILLATORS)
@pytest.mark.parametrize("drive", [0.8, 0.8 + 1e-7, 2.3, 1e-3])
def test_drive_agrees_with_integration_at_and_off_resonance(
    w: float, friction: float, drive: float
) -> None:
    position, velocity = sine_drive_response(TIMES, [w], friction, drive)
    expected = integrate(w, friction, 0.0, drive)
    # the integrator's tolerance, as above
    assert position[:, 0] == pytest.approx(expected[0], rel=1e-8, abs=1e-9)
    assert velocity[:, 0] == pytest.approx(expected[1], rel=1e-8, abs=1e-9)


def test_undamped_resonance_grows_linearly() -> None:
    w, t = 0.656, np.linspace(0, 200, 401)
    position, velocity = sine_drive_response(t, [w], 0.0, w)
    # round-off times the amplitude of 150
    assert position[:, 0] == pytest.approx(
        (np.sin(w * t) - w * t * np.cos(w * t)) / (2 * w**2), abs=1e-11
    )
    assert velocity[:, 0] == pytest.approx(t * np.sin(w * t) / 2, abs=1e-11)


@pytest.mark.parametrize("time_ps", [1e-6, 1e-3])
def test_early_motion_keeps_its_digits(time_ps: float) -> None:
    w, friction, drive = 2.0, 0.1, 1.5
    position, velocity = impulse_response([time_ps], [w], friction)
    driven, _ = sine_drive_response([time_ps], [w], friction, drive)
    # next order of the expansion in t: friction t/2 and friction t/4 (relative)
    assert position[0, 0] == pytest.approx(time_ps, rel=friction * time_ps)
    assert velocity[0, 0] == pytest.approx(1 - friction * time_ps, rel=3 * time_ps**2)
    assert driven[0, 0] == pytest.approx(drive * time_ps**3 / 6, rel=friction * time_ps)


def test_a_stiff_overdamped_mode_does_not_overflow() -> None:
    position, velocity = impulse_response([0.0, 1e4], [1e-3], 50.0)
    # slow root w^2/g = 2e-8 /ps to within (w/g)^2 = 4e-10 relative
    assert position[1, 0] == pytest.approx(np.exp(-2e-4) / 50, rel=1e-8)
    assert velocity[1, 0] == pytest.approx(-2e-8 * position[1, 0], rel=1e-8)


def test_impossible_requests_are_refused() -> None:
    with pytest.raises(InputError, match="before the start"):
        impulse_response([-1.0], [1.0], 0.0)
    with pytest.raises(InputError, match="friction"):
        impulse_response([1.0], [1.0], -0.1)
    with pytest.raises(InputError, match="positive"):
        sine_drive_response([1.0], [1.0], 0.1, 0.0)
