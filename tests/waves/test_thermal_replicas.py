"""Waves upon thermal motion: averages over snapshots, their speed, and errors that chaos makes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.chain import ScalarChain
from dnawaves.waves.estimators.lattices import ScalarLattice
from dnawaves.waves.estimators.long_waves import Projection, lowest_waves
from dnawaves.waves.estimators.replicas import ReplicaFit, Replicas, fit_replicas
from dnawaves.waves.estimators.sources import kick
from dnawaves.waves.estimators.synthetic import thermal_velocity
from dnawaves.waves.thermal_replicas import variant

Array = NDArray[np.float64]

PAIRS, SPACING_nm, SPEED_A_PER_PS, FRICTION_PER_PS, INTERVAL_ps = 12, 0.34, 8.0, 0.3, 0.15
TIMES_ps = INTERVAL_ps * np.arange(60)
HELD = [PAIRS - 1]
# A standard error of 30 draws is known to 13 %.
DRAWS = 30
PATTERN = np.where(np.arange(PAIRS) < 3, 1.0, 0.0)
CHAIN = ScalarChain.from_speed(PAIRS, SPEED_A_PER_PS, SPACING_nm, HELD)
WAVE = CHAIN.kick_response(TIMES_ps, PATTERN, FRICTION_PER_PS)[1]


def chaos(count: int, snr: float, rng: np.random.Generator) -> Array:
    """Return what grows between two copies, (replica, time, pair): thermal motion times a growth.

    Their mean has at the middle of the record, at the last free pair, this ratio of peak to noise.
    """
    moving = thermal_velocity(
        CHAIN, count * len(TIMES_ps), INTERVAL_ps, FRICTION_PER_PS, 1.0, rng
    ).reshape(count, len(TIMES_ps), PAIRS)
    growth = np.exp((TIMES_ps - TIMES_ps.mean()) / 3.0)[:, np.newaxis]
    level = np.abs(WAVE[:, -2]).max() / snr * np.sqrt(count) / moving[..., -2].std()
    return np.asarray(level * growth * moving)


def fitted(answers: Array, rng: np.random.Generator, directions: Projection) -> ReplicaFit:
    replicas = Replicas.of(list(answers))
    lattice = ScalarLattice(PAIRS, SPACING_nm, HELD, kick(TIMES_ps[: replicas.frames]), PATTERN)
    return fit_replicas([(replicas, lattice)], directions, "speed_A_per_ps", rng, DRAWS)


def test_speed_and_interval_from_few_replicas() -> None:
    rng, scenes, count = np.random.default_rng(1), 10, 6
    directions = lowest_waves(PAIRS, HELD, 4)
    fits = [fitted(WAVE + chaos(count, 10.0, rng), rng, directions) for _ in range(scenes)]
    speeds = np.array([fit.value.value for fit in fits])
    # The spread is some 1 %, the mean's 0.3 %.
    assert speeds.mean() == pytest.approx(SPEED_A_PER_PS, rel=0.01)
    inside = [fit.value.low <= SPEED_A_PER_PS <= fit.value.high for fit in fits]
    # 95 % of 10: seven and fewer come once in 90 times.
    assert sum(inside) >= 8
    # An interval is as wide as Student's t of 5 degrees, 2.6, times the spread, to a factor of 2.
    half = np.median([(fit.value.high - fit.value.low) / 2 for fit in fits])
    assert 1.3 < half / speeds.std() < 5.2
    assert np.mean([fit.amplitude for fit in fits]) == pytest.approx(1.0, abs=0.05)
    assert fits[0].interval == "95 %, bootstrap over 6 replicas"
    # A flag of 5 %: three and more of 10 come once in 90 times.
    assert sum(fit.wrong for fit in fits) <= 2


def test_a_wave_of_another_kind_looks_wrong() -> None:
    # Every other link ten times as soft: no uniform lattice.
    rng = np.random.default_rng(2)
    links = CHAIN.stiffness[0, 0] * np.where(np.arange(PAIRS - 1) % 2, 1.0, 0.1)
    uneven = ScalarChain(np.ones(PAIRS), links, HELD)
    wave = uneven.kick_response(TIMES_ps, PATTERN, FRICTION_PER_PS)[1]
    everything = lowest_waves(PAIRS, HELD, PAIRS - 1)
    found = fitted(wave + chaos(8, 30.0, rng), rng, everything)
    assert found.wrong
    assert found.misfit > 0.2


def test_replicas_end_where_half_are_left() -> None:
    lengths = [60, 50, 30, 12]
    replicas = Replicas.of([WAVE[:length] for length in lengths])
    assert replicas.frames == 50
    # Without noise the mean of those that are left is the wave itself.
    np.testing.assert_allclose(replicas.mean(), WAVE[:50], atol=1e-12)
    with pytest.raises(InputError, match="found none"):
        Replicas.of([])


def test_no_draw_leaves_a_frame_without_replicas() -> None:
    # Without the two long ones, in 8 % of all draws, the mean would end early.
    usable = np.array([60, 60, 20, 20, 20])
    counts = np.arange(60) < usable[:, np.newaxis]
    replicas, rng = Replicas(WAVE * counts[..., np.newaxis], usable), np.random.default_rng(4)
    for _ in range(200):
        np.testing.assert_allclose(replicas.mean(replicas.drawn(rng)), WAVE, atol=1e-12)


def test_one_replica_has_no_interval() -> None:
    found = fitted(WAVE[np.newaxis], np.random.default_rng(3), lowest_waves(PAIRS, HELD, 4))
    # Of an exact wave the fit is exact to the optimiser's tolerance.
    assert found.value.value == pytest.approx(SPEED_A_PER_PS, rel=1e-3)
    assert (found.value.low, found.value.high, found.interval) == (0.0, np.inf, "")


def test_names_of_members() -> None:
    assert [variant(name) for name in ("r1", "x0.5r12", "f2r1", "x1")] == ["", "x0.5", "f2", "x1"]
