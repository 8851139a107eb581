"""Estimators on synthetic waves whose speed, friction and noise are known."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.dispersion import lattice_frequency
from dnawaves.rod.modal import sine_drive_response
from dnawaves.waves.estimators import (
    arrival_ps,
    damped_sine_fit,
    project_on_start,
    resonance_fit,
    waveform_fit,
)

PAIRS, SPACING_NM = 24, 0.34
HELD = [PAIRS - 1]


def kicked_chain(
    speed_A_per_ps: float, friction_per_ps: float = 0.0, crossings: float = 1.2
) -> tuple[np.ndarray, np.ndarray]:
    """Return times and velocities (time, pair) of a chain kicked on its first three pairs."""
    crossing_ps = 10 * SPACING_NM * (PAIRS - 1) / speed_A_per_ps
    times = np.linspace(0, crossings * crossing_ps, 90)
    chain = ScalarChain.from_speed(PAIRS, speed_A_per_ps, SPACING_NM, HELD)
    kick = np.zeros(PAIRS)
    kick[:3] = 0.1
    return times, chain.kick_response(times, kick, friction_per_ps)[1]


@pytest.mark.parametrize("speed", [5.06, 8.19, 16.0, 35.0])
def test_waveform_fit_finds_any_speed_without_being_told(speed: float) -> None:
    times, velocity = kicked_chain(speed, friction_per_ps=0.2)
    fit = waveform_fit(times, velocity, SPACING_NM, HELD)
    # Noise-free data of the model class: what is left is the optimiser's own tolerance.
    assert fit.rate == pytest.approx(speed, rel=1e-5)
    assert fit.friction_per_ps == pytest.approx(0.2, rel=1e-3)
    assert fit.misfit < 1e-5


def test_waveform_fit_is_unbiased_in_noise() -> None:
    rng = np.random.default_rng(1)
    times, velocity = kicked_chain(12.0)
    noise = np.abs(velocity[:, PAIRS - 2]).max() / 10
    speeds = []
    for _ in range(10):
        noisy = velocity + noise * rng.standard_normal(velocity.shape)
        # The source is what was put in, which a simulation knows without noise.
        noisy[0] = velocity[0]
        speeds.append(waveform_fit(times, noisy, SPACING_NM, HELD).rate)
    # Signal to noise 10 at the last free pair: the spread per draw is well below 0.5 %, so the
    # mean of ten lies within 0.2 % unless the estimator is biased.
    assert np.mean(speeds) == pytest.approx(12.0, rel=2e-3)


def test_waveform_fit_shows_that_the_model_is_wrong() -> None:
    stiffness = np.where(np.arange(PAIRS - 1) % 2 == 0, 1.0, 0.2)
    chain = ScalarChain(np.ones(PAIRS), stiffness, HELD)
    times = np.linspace(0, 30, 120)
    kick = np.zeros(PAIRS)
    kick[:3] = 1.0
    velocity = chain.kick_response(times, kick)[1]
    # Links that alternate by a factor 5 split the band; a uniform chain cannot follow.
    assert waveform_fit(times, velocity, SPACING_NM, HELD).misfit > 0.3


def test_observed_pairs_limit_what_is_fitted() -> None:
    times, velocity = kicked_chain(10.0)
    spoiled = velocity.copy()
    spoiled[1:, ::2] = 0.0
    odd = np.arange(PAIRS) % 2 == 1
    fit = waveform_fit(times, spoiled, SPACING_NM, HELD, odd)
    assert fit.rate == pytest.approx(10.0, rel=1e-5)


def test_damped_sine_fit_from_less_than_half_a_period() -> None:
    frequency, friction = 0.5, 0.16
    times = np.linspace(0, 6.0, 80)
    root = np.sqrt(frequency**2 - friction**2 / 4)
    # Velocity of a free damped oscillator after a unit impulse, in closed form.
    velocity = np.exp(-friction * times / 2) * (
        np.cos(root * times) - friction / (2 * root) * np.sin(root * times)
    )
    fit = damped_sine_fit(times, 0.3 * velocity)
    assert fit.rate == pytest.approx(frequency, rel=1e-6)
    assert fit.friction_per_ps == pytest.approx(friction, rel=1e-4)
    assert fit.gain == pytest.approx(0.3, rel=1e-5)


def test_resonance_fit_joins_drives_far_from_resonance() -> None:
    frequency, friction = 0.70, 0.08
    drives = [0.25, 0.45, 0.9]
    times = np.linspace(0, 12, 140)
    runs = [2.0 * sine_drive_response(times, [frequency], friction, d)[1][:, 0] for d in drives]
    fit = resonance_fit([times] * 3, runs, drives)
    assert fit.rate == pytest.approx(frequency, rel=1e-6)
    assert fit.friction_per_ps == pytest.approx(friction, rel=1e-3)


def test_resonance_fit_knows_how_the_drives_rise() -> None:
    frequency, friction = 0.70, 0.08
    drives, ramps = [0.25, 0.45, 0.9], [25.0, 14.0, 7.0]
    times = np.linspace(0, 12, 140)
    runs = [
        2.0 * sine_drive_response(times, [frequency], friction, drive, ramp)[1][:, 0]
        for drive, ramp in zip(drives, ramps, strict=True)
    ]
    fit = resonance_fit([times] * 3, runs, drives, ramps)
    assert fit.rate == pytest.approx(frequency, rel=1e-6)
    assert fit.friction_per_ps == pytest.approx(friction, rel=1e-3)
    # A drive that is there at once answers so differently that no oscillator can follow.
    assert resonance_fit([times] * 3, runs, drives).misfit > 0.3


def test_arrival_of_a_delta_kick_has_the_known_small_bias() -> None:
    speed = 8.19
    chain = ScalarChain.from_speed(60, speed, SPACING_NM, [])
    times = np.linspace(0, 12, 2400)
    kick = np.zeros(60)
    kick[10] = 1.0
    velocity = chain.kick_response(times, kick)[1]
    found = arrival_ps(times, velocity[:, 34])
    assert found is not None
    # On an endless chain the 66.3 % pick is +0.09 % off after 24 base pairs; the ends are too far
    # away to matter, the frames 5 fs apart: 0.2 %.
    assert 24 * 10 * SPACING_NM / found == pytest.approx(speed, rel=2e-3)


def test_arrival_sees_none_where_nothing_moves() -> None:
    assert arrival_ps(np.linspace(0, 5, 50), np.zeros(50)) is None


def test_projection_on_start_is_the_mode_that_was_kicked() -> None:
    speed = 12.0
    chain = ScalarChain.from_speed(PAIRS, speed, SPACING_NM, [0, PAIRS - 1])
    shape = np.sin(np.pi * np.arange(PAIRS) / (PAIRS - 1))
    shape[[0, -1]] = 0.0
    times = np.linspace(0, 5, 60)
    velocity = chain.kick_response(times, shape)[1]
    wavenumber = np.pi / (SPACING_NM * (PAIRS - 1))
    omega = float(lattice_frequency(wavenumber, speed, SPACING_NM))
    # A mode of the chain stays one: its projection is a pure cosine, to round-off.
    np.testing.assert_allclose(project_on_start((1.0, velocity)), np.cos(omega * times), atol=1e-10)


def test_arrival_needs_a_pair_that_was_at_rest() -> None:
    times = np.linspace(0, 2, 60)
    # Rises from 0.7 of its peak: the pick at 66.3 % has passed before the record begins.
    assert arrival_ps(times, 1 - 0.3 * (times - 1) ** 2) is None
