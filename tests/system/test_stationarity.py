"""The checks of an equilibration against processes whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

from dnawaves.system.stationarity import temperature_check, trend_check

RUNS, SAMPLES, INTERVAL_ps = 2000, 200, 0.05


def correlated(lifetime: float, seed: int = 1) -> NDArray[np.float64]:
    """Return stationary AR(1) series (RUNS, SAMPLES) of unit variance; lifetime in samples."""
    kept = np.exp(-1 / lifetime)
    burn_in = int(10 * lifetime)
    noise = np.random.default_rng(seed).normal(size=(RUNS, SAMPLES + burn_in))
    series = lfilter([np.sqrt(1 - kept**2)], [1, -kept], noise, axis=1)
    return series[:, burn_in:]


@pytest.mark.parametrize(("window_over_lifetime", "most"), [(50, 0.02), (10, 0.035), (5, 0.055)])
def test_sound_runs_are_seldom_called_drifting(window_over_lifetime: float, most: float) -> None:
    series = correlated(SAMPLES / window_over_lifetime)
    alarms = np.mean([not trend_check(one, INTERVAL_ps).sound for one in series])
    # As documented 1, 2, 4 %, each with three standard deviations of 2000 draws (0.2 to 0.4 %).
    assert 0.003 < alarms < most


def test_a_drift_is_found_and_measured() -> None:
    noise = correlated(4)[0]
    # Over the window ten standard deviations of a block's mean, 0.45 at four samples' lifetime.
    slope = 4.5 / (SAMPLES * INTERVAL_ps)
    check = trend_check(noise + slope * INTERVAL_ps * np.arange(SAMPLES), INTERVAL_ps)
    assert check.value == pytest.approx(slope, abs=3 * check.standard_error)
    assert check.standard_error < slope / 4
    assert not check.sound
    assert check.verdict.startswith("drifts (p = 0.00")


def test_too_few_samples_are_no_sound_run() -> None:
    check = trend_check(np.zeros(9), INTERVAL_ps)
    assert (check.sound, check.verdict) == (False, "too short to tell: 9 of 10 samples")


@pytest.mark.parametrize("friction_per_ps", [0.2, 2.0])
def test_the_standard_error_of_the_temperature_is_that_of_free_particles(
    friction_per_ps: float,
) -> None:
    freedom, target_K, runs = 30, 300.0, 500
    kept = np.exp(-friction_per_ps * INTERVAL_ps)
    generator = np.random.default_rng(3)
    velocity = generator.normal(size=(runs, freedom))
    temperatures = np.empty((runs, SAMPLES))
    for sample in range(SAMPLES):
        noise = generator.normal(size=velocity.shape)
        velocity = kept * velocity + np.sqrt(1 - kept**2) * noise
        temperatures[:, sample] = target_K * np.mean(velocity**2, axis=1)
    checks = [
        temperature_check(one, target_K, freedom, friction_per_ps, INTERVAL_ps)
        for one in temperatures
    ]
    # The spread of 500 means is known to 1/sqrt(1000) = 3 %: four of these.
    spread = np.std([check.value for check in checks])
    assert spread == pytest.approx(checks[0].standard_error, rel=0.12)
    # 0.3 % of 500 lie beyond three standard errors, somewhat more as few samples are skewed.
    assert sum(not check.sound for check in checks) <= 8


def test_a_wrong_temperature_is_said() -> None:
    check = temperature_check(np.full(100, 310.0), 300.0, 1200, 1.0, 0.1)
    # sqrt(2/(1200 * 10)) = 1.29 % of 300 K, a little less as the correlation ends within 10 ps.
    assert check.standard_error == pytest.approx(3.87, rel=0.06)
    assert check.sound
    wrong = temperature_check(np.full(100, 315.0), 300.0, 1200, 1.0, 0.1)
    assert not wrong.sound
    assert wrong.verdict == "+4.0 standard errors off 300 K"
