"""Modal fits, ridges, resonance, thermal spectra, flight, correlation: known truth, number out."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.oscillator import sine_drive_response
from dnawaves.waves.cross_checks import LEAST_PEAK_OF_CHAIN
from dnawaves.waves.estimators.correlation import arrival_ps, first_peak_ps, lag_ps, threshold_ps
from dnawaves.waves.estimators.equilibrium import equilibrium_response
from dnawaves.waves.estimators.flight import fit_flight
from dnawaves.waves.estimators.intervals import (
    blocks,
    bootstrap_interval,
    correlation_inflation,
    residual_interval,
)
from dnawaves.waves.estimators.modal_fit import fit_modes
from dnawaves.waves.estimators.resonance import fit_resonance, steady_answer
from dnawaves.waves.estimators.ridges import ridges
from dnawaves.waves.estimators.separable import Separable
from dnawaves.waves.estimators.synthetic import thermal_velocity
from dnawaves.waves.estimators.whittle import expected_periodogram, periodogram, whittle_fit

PAIRS, SPACING_NM, SPEED, FRICTION = 24, 0.34, 12.0, 0.15
TIMES_PS = np.arange(0, 12, 0.1)


def kicked(held: list[int]) -> tuple[ScalarChain, np.ndarray]:
    chain = ScalarChain.from_speed(PAIRS, SPEED, SPACING_NM, held)
    pattern = np.zeros(PAIRS)
    pattern[1:4] = 0.1
    return chain, chain.kick_response(TIMES_PS, pattern, FRICTION)[1]


@pytest.mark.parametrize("held", [[], [0], [0, -1]])
def test_modal_fit_needs_no_source(held: list[int]) -> None:
    _, velocity = kicked(held)
    # From the middle of the motion, where no source is known any more.
    fit = fit_modes(TIMES_PS[20:], velocity[20:], SPACING_NM, held, range(1, 6))
    assert fit.speed_A_per_ps.value == pytest.approx(SPEED, rel=1e-5)
    assert fit.friction_per_ps == pytest.approx(FRICTION, rel=1e-3)


@pytest.mark.parametrize("held", [[], [0], [0, -1]])
def test_ridges_have_the_modes_own_frequency_and_width(held: list[int]) -> None:
    chain, velocity = kicked(held)
    found = ridges(TIMES_PS, velocity, SPACING_NM, held, [1, 2, 5])
    moving = chain.frequencies_rad_per_ps[chain.frequencies_rad_per_ps > 0]
    for ridge in found:
        assert ridge.frequency_rad_per_ps == pytest.approx(moving[ridge.mode - 1], rel=1e-5)
        assert ridge.width_per_ps == pytest.approx(FRICTION, rel=1e-3)
        k = ridge.wavenumber_rad_per_nm
        on_branch = 2 * SPEED / 10 / SPACING_NM * np.sin(k * SPACING_NM / 2)
        assert on_branch == pytest.approx(moving[ridge.mode - 1], rel=1e-9)


def test_modes_that_a_chain_does_not_have_are_refused() -> None:
    _, velocity = kicked([])
    for estimate in (ridges, fit_modes):
        with pytest.raises(InputError, match="1 to 23"):
            estimate(TIMES_PS, velocity, SPACING_NM, [], [24])


def test_resonance_has_frequency_width_amplitude_and_phase() -> None:
    drives, ramp_ps = [0.5, 0.7, 0.95], 4.0
    runs = [
        2.5 * sine_drive_response(TIMES_PS, [0.72], 0.1, drive, ramp_ps)[1][:, 0]
        for drive in drives
    ]
    found = fit_resonance([TIMES_PS] * 3, runs, drives, ramp_ps)
    assert found.frequency_rad_per_ps.value == pytest.approx(0.72, rel=1e-5)
    assert found.width_per_ps.value == pytest.approx(0.1, rel=1e-3)
    assert found.amplitude == pytest.approx(2.5, rel=1e-4)
    assert found.phase_rad == pytest.approx(0.0, abs=1e-4)


def test_resonance_sees_that_the_force_ran_ahead() -> None:
    drive, times = 0.7, np.arange(0, 20, 0.1)
    position, velocity = sine_drive_response(times, [0.72], 0.1, drive)
    # A force of sin(drive t + 0.3): its cosine part drives by the rate of change of the answer.
    cosine = (np.sin(drive * times) - 0.1 * velocity[:, 0] - 0.72**2 * position[:, 0]) / drive
    run = np.cos(0.3) * velocity[:, 0] + np.sin(0.3) * cosine
    assert fit_resonance([times], [run], [drive]).phase_rad == pytest.approx(0.3, abs=1e-3)


def test_steady_answer_of_a_resonant_drive_is_in_phase_with_it() -> None:
    times = np.arange(0, 150, 0.1)
    velocity = sine_drive_response(times, [0.7], 0.2, 0.7)[1][:, 0]
    amplitude, phase = steady_answer(times, velocity, 0.7)
    # At resonance force over friction; after 75 ps the transient has fallen to exp(-7.5).
    assert amplitude == pytest.approx(1 / 0.2, rel=5e-3)
    assert phase == pytest.approx(0.0, abs=5e-3)


def test_expected_periodogram_is_the_mean_of_periodograms() -> None:
    chain = ScalarChain.from_speed(PAIRS, SPEED, SPACING_NM)
    rng = np.random.default_rng(4)
    chosen = slice(1, 5)
    frames, draws = 400, 60
    found = []
    for _ in range(draws):
        velocity = thermal_velocity(chain, frames, 0.1, 0.5, 1.0, rng)
        frequency, power = periodogram(velocity @ chain.shapes[chosen].T, 0.1)
        found.append(power)
    modes = chain.frequencies_rad_per_ps[chosen]
    expected = expected_periodogram(frames, 0.1, modes, 0.5, frequency)
    ratio = np.mean(found, axis=0) / expected
    # Means of 60 exponential numbers, over 199 frequencies: 0.9 % for each mode.
    np.testing.assert_allclose(ratio.mean(axis=0), 1.0, atol=0.04)


def test_whittle_fit_of_1_ns_has_the_error_that_theory_says() -> None:
    chain = ScalarChain.from_speed(PAIRS, 8.19, SPACING_NM)
    velocity = thermal_velocity(chain, 10_000, 0.1, 0.5, 1.5, np.random.default_rng(6))
    wavenumbers = np.pi * np.arange(1, 5) / PAIRS / SPACING_NM
    fit = whittle_fit(velocity @ chain.shapes[1:5].T, 0.1, wavenumbers, SPACING_NM, 2.5)
    speed = fit.speed_A_per_ps
    # sd(omega_p) = sqrt(friction/2T): over four modes 0.9 % of the speed.
    expected = np.sqrt(0.5 / 2000 / np.sum(chain.frequencies_rad_per_ps[1:5] ** 2))
    assert expected == pytest.approx(0.0092, abs=1e-4)
    assert (speed.high - speed.low) / 2 / 1.96 / 8.19 == pytest.approx(expected, rel=0.1)
    assert speed.value == pytest.approx(8.19, rel=4 * expected)
    assert fit.mean_square == pytest.approx(1.5, rel=0.15)


def test_whittle_fit_sees_that_the_modes_are_not_of_one_lattice() -> None:
    chain = ScalarChain.from_speed(PAIRS, 8.19, SPACING_NM)
    velocity = thermal_velocity(chain, 10_000, 0.1, 0.3, 1.0, np.random.default_rng(7))
    wavenumbers = np.pi * np.array([1, 2, 3, 6]) / PAIRS / SPACING_NM
    fit = whittle_fit(velocity @ chain.shapes[1:5].T, 0.1, wavenumbers, SPACING_NM, 2.5)
    assert fit.wrong


def test_flight_against_length_is_not_biased_by_a_delay() -> None:
    lengths = np.array([40.0, 80.0, 160.0])
    flight = fit_flight(lengths, 0.9 + lengths / 8.19)
    assert flight.speed_A_per_ps.value == pytest.approx(8.19, rel=1e-9)
    assert flight.delay_ps.value == pytest.approx(0.9, rel=1e-9)


def test_flight_with_scatter_says_so() -> None:
    lengths = np.array([40.0, 80.0, 120.0, 160.0])
    times = lengths / 8.19 + np.array([0.5, -0.5, -0.5, 0.5])
    told = fit_flight(lengths, times, np.full(4, 0.01))
    assert told.p_value is not None and told.p_value < 1e-6
    own = fit_flight(lengths, times)
    assert own.speed_A_per_ps.low < 8.19 < own.speed_A_per_ps.high
    with pytest.raises(InputError, match="three different lengths"):
        fit_flight([40.0, 80.0], [1.0, 2.0])
    with pytest.raises(InputError, match="do not grow"):
        fit_flight(lengths, -times)


def test_lag_peak_and_threshold_of_a_delayed_gaussian() -> None:
    times = np.arange(0, 20, 0.1)
    early, late = (np.exp(-((times - centre) ** 2) / 2 / 0.5**2) for centre in (4.0, 9.23))
    # Five samples per standard deviation: a parabola through three of them is off by 1 fs or so.
    assert lag_ps(0.1, early, late) == pytest.approx(5.23, abs=2e-3)
    assert lag_ps(0.1, early, -late) == pytest.approx(5.23, abs=2e-3)
    assert first_peak_ps(times, late) == pytest.approx(9.23, abs=2e-3)
    threshold = threshold_ps(times, late, np.exp(-0.5))
    assert threshold == pytest.approx(8.73, abs=5e-3)


@pytest.mark.parametrize("pair", [20, 21])
def test_a_front_arrives_before_its_larger_reflection(pair: int) -> None:
    """Beside a held end a kick is followed by its mirror image, and both meet at the far end."""
    chain = ScalarChain.from_speed(PAIRS, SPEED, SPACING_NM, [0, PAIRS - 1])
    times_ps, pattern = np.arange(0, 14, 0.02), np.zeros(PAIRS)
    pattern[1:4] = 0.1
    velocity = chain.kick_response(times_ps, pattern)[1][:, pair]
    arrived = arrival_ps(times_ps, velocity, LEAST_PEAK_OF_CHAIN)
    assert arrived is not None
    # The pick of a kick of three pairs is ahead by up to half of its width, 8 % of the way.
    assert (pair - 2) * 10 * SPACING_NM / arrived == pytest.approx(SPEED, rel=0.08)
    assert velocity[np.argmax(np.abs(velocity))] < 0


def test_equilibrium_motion_tells_the_answer_to_an_impulse() -> None:
    chain = ScalarChain.from_speed(8, 8.19, SPACING_NM)
    velocity = thermal_velocity(chain, 60_000, 0.1, 1.0, 2.0, np.random.default_rng(8))
    impulse = np.eye(8)[0]
    mean, error = equilibrium_response(blocks(velocity, 1000), impulse, 2.0, 30)
    exact = chain.kick_response(np.arange(30) * 0.1, impulse, 1.0)[1]
    # 240 numbers, each within four of its standard errors.
    assert np.abs((mean - exact) / error).max() < 4.5
    assert error.max() < 0.1


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_interval_of_a_friction_does_not_depend_on_its_root_s_sign(sign: float) -> None:
    """exp(-x² t) with noise: a search may end at either root."""
    times = np.arange(0, 20, 0.1)
    noise = 0.02 * np.random.default_rng(3).standard_normal(len(times))
    data = np.exp(-0.01 * times) + noise
    fit = Separable(data, lambda x: np.exp(-(float(x[0]) ** 2) * times)[np.newaxis])
    best = fit.minimise(np.array([0.1 * sign]))
    residual = (data - fit.fitted(best.parameters))[np.newaxis]
    found = residual_interval(fit, best, 0, [residual], 2, root=True)
    # 0.02 of noise in 200 samples knows the rate to some 0.0004.
    assert 0.007 < found.low**2 < float(best.parameters[0]) ** 2 < found.high**2 < 0.013
    # Its rate alone is linear: the half width is two standard errors, by this fit's own slope.
    slope = fit.sensitivity(best.parameters, 0) / (2 * best.parameters[0])
    error = np.sqrt(best.sum_of_squares / 198 / np.sum(slope**2))
    assert (found.high**2 - found.low**2) / 2 == pytest.approx(1.97 * error, rel=0.3)


def test_residuals_with_memory_count_for_fewer() -> None:
    rng = np.random.default_rng(9)
    steps = rng.standard_normal((20, 4000))
    memory = np.zeros_like(steps)
    for frame in range(1, 4000):
        memory[:, frame] = 0.8 * memory[:, frame - 1] + steps[:, frame]
    slow = np.ones_like(memory)
    # Of a mean the variance grows by (1 + r)/(1 - r) = 9; 63 lags leave out little. Its estimate
    # from 4,000 frames scatters by about a fifth.
    assert correlation_inflation(memory, slow) == pytest.approx(9.0, rel=0.5)
    assert correlation_inflation(steps, slow) == pytest.approx(1.0, abs=0.5)


def test_bootstrap_interval_of_a_mean_is_that_of_its_standard_error() -> None:
    rng = np.random.default_rng(10)
    samples = rng.standard_normal(400)
    found = bootstrap_interval(samples, lambda drawn: float(drawn.mean()), rng)
    # Percentiles of 400 draws of the mean: 1.96/20, known to a tenth or so.
    assert (found.high - found.low) / 2 == pytest.approx(0.098, rel=0.25)
