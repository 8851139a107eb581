"""A little friction damps a standing wave and leaves its speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from dnawaves.scene.models import SceneSpec
from dnawaves.trajectory.pattern import kick_pattern
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member

Array = NDArray[np.float64]
HELD = {"first": "held", "last": "held"}
WAVE = {"kind": "standing_wave", "wave": "twist", "mode": 1, "angular_velocity_rad_per_ps": 0.01}
FRICTION_PER_PS = 0.01


def damped(times_ps: Array, amplitude: float, omega: float, rate: float) -> Array:
    wave: Array = amplitude * np.exp(-rate * times_ps) * np.sin(omega * times_ps)
    return wave


@pytest.mark.parametrize("friction_per_ps", [FRICTION_PER_PS, 10 * FRICTION_PER_PS])
def test_friction_leaves_the_speed_and_damps_as_it_says(
    relaxed: Any, make_scene: Callable[..., SceneSpec], friction_per_ps: float
) -> None:
    """With the thermostat's own integrator at 0 K, on a mode of six base pairs."""
    duplex = relaxed.duplex
    fits, courses = [], []
    for thermostat in (None, {"friction_per_ps": friction_per_ps}):
        scene = make_scene(duplex, WAVE, HELD, thermostat)
        shape = kick_pattern(scene.excitation, scene.ends, 6).angular
        motion = run_member(duplex, scene, Plan(0.002, 20, 76), "x1", {}).dataset()
        odd = 0.5 * (motion["rotation"].sel(sign=1) - motion["rotation"].sel(sign=-1)).values
        course = odd @ motion["direction"].sel(axis="helix").values @ shape
        times_ps = motion["time"].values
        fits.append(curve_fit(damped, times_ps, course, (0.01, 1.8, 0.1))[0])
        courses.append(course)
    (_, omega, _), (_, with_friction, _) = fits
    # A damped oscillator's frequency is omega sqrt(1 - (friction/2 omega)²): less by 4e-6 at a
    # friction of 0.01/ps. The kick's other modes blur the fit by more, in proportion to it.
    assert abs(with_friction / omega - 1) < 0.005
    if friction_per_ps == FRICTION_PER_PS:
        assert abs(with_friction / omega - 1) < 1e-3
    # The answer to a kick, sin(omega t)/omega of every mode, decays at half the rate of a momentum;
    # what else friction does is of second order, (friction/2 omega)² t omega = 2e-3 at 0.1/ps.
    decayed = courses[0] * np.exp(-friction_per_ps * times_ps / 2)
    largest = np.abs(courses[0]).max()
    np.testing.assert_allclose(courses[1], decayed, atol=0.1 * friction_per_ps * largest)
    assert np.abs(decayed - courses[0]).max() > 0.7 * friction_per_ps * largest
