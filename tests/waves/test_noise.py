"""Noise: what is whitened with the right covariance is white."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.modal import impulse_response
from dnawaves.waves.estimators.noise import ColouredNoise, WhiteNoise, mode_directions
from dnawaves.waves.estimators.synthetic import thermal_velocity

CHAIN = ScalarChain.from_speed(12, 8.19, 0.34)
FRAMES, INTERVAL_PS, FRICTION = 150, 0.1, 0.4


def thermal(frames: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return thermal_velocity(CHAIN, frames, INTERVAL_PS, FRICTION, 2.0, rng)


def test_thermal_velocity_is_equipartitioned_and_remembers_as_the_impulse_response_says() -> None:
    modes = thermal(40_000, 1) @ CHAIN.shapes.T
    # 4 ns and memories of about 5 ps leave some 400 independent samples of a square: 5 % each.
    np.testing.assert_allclose(np.mean(modes**2, axis=0), 2.0, rtol=0.25)
    lag = 10
    found = np.mean(modes[lag:] * modes[:-lag], axis=0)
    frequencies = CHAIN.frequencies_rad_per_ps
    expected = 2.0 * impulse_response([lag * INTERVAL_PS], frequencies, FRICTION)[1][0]
    np.testing.assert_allclose(found, expected, atol=0.4)


def given() -> ColouredNoise:
    times = 3.0 + INTERVAL_PS * np.arange(FRAMES)
    return ColouredNoise.of_thermal_motion(CHAIN, times, FRICTION, 2.0)


def learnt() -> ColouredNoise:
    return ColouredNoise.of_quiet_data(thermal(30 * FRAMES, 2), FRAMES, mode_directions(CHAIN))


@pytest.mark.parametrize("make", [given, learnt])
def test_whitened_thermal_motion_is_white(make: object) -> None:
    noise = make()  # type: ignore[operator]
    white = np.array([noise.whiten(thermal(FRAMES, seed)) for seed in range(3, 9)])
    # 10,800 standard normal numbers: their variance is known to 1.4 %, a correlation to 1 %. The
    # learnt noise has errors of its own, of the inverse root of 30 records.
    assert np.var(white) == pytest.approx(1.0, abs=0.06)
    for lag in (1, 2, 5):
        assert np.mean(white[..., lag:] * white[..., :-lag]) == pytest.approx(0.0, abs=0.05)
    between = np.corrcoef(white.transpose(1, 0, 2).reshape(12, -1))
    assert np.abs(between - np.eye(12)).max() < 0.15


def test_white_noise_scales_each_channel() -> None:
    field = np.ones((5, 2))
    white = WhiteNoise([1.0, 2.0]).whiten(field)
    np.testing.assert_allclose(white, [[1.0] * 5, [0.5] * 5])
    assert not WhiteNoise().level_known


def test_noise_that_cannot_be_whitened_is_refused() -> None:
    with pytest.raises(InputError, match="positive definite"):
        ColouredNoise.of_covariance(np.array([[1.0, 2.0]]), np.eye(1))
    with pytest.raises(InputError, match="quiet data of 10 frames"):
        ColouredNoise.of_quiet_data(np.ones((10, 2)), 5)
