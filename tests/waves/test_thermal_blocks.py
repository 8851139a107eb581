"""Errors of correlated samples: a series of known memory, an inverse of known bias."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from dnawaves.waves.constants.thermal_blocks import blocks_of, jackknife, statistical_inefficiency

Array = NDArray[np.float64]


def autoregressive(memory: float, runs: int, frames: int, rng: np.random.Generator) -> Array:
    """Return series (run, time) of variance 1 with correlation `memory` of neighbours."""
    series = np.empty((runs, frames))
    series[:, 0] = rng.standard_normal(runs)
    for frame in range(1, frames):
        fresh = np.sqrt(1 - memory**2) * rng.standard_normal(runs)
        series[:, frame] = memory * series[:, frame - 1] + fresh
    return series


@pytest.mark.parametrize("memory", [0.0, 0.8, 0.95])
def test_inefficiency_of_a_known_memory(memory: float) -> None:
    series = autoregressive(memory, 10, 4000, np.random.default_rng(1))
    exact = (1 + memory) / (1 - memory)
    # Ten runs of 100 and more independent samples: the sum of correlations is known to some 10 %.
    assert statistical_inefficiency(list(series)) == pytest.approx(exact, rel=0.25)


def test_blocks_are_as_many_as_memory_allows() -> None:
    rng = np.random.default_rng(2)
    quick = blocks_of([one[:, np.newaxis] for one in autoregressive(0.5, 3, 2000, rng)])
    assert (len(quick.pieces), quick.long_enough) == (21, True)
    slow = blocks_of([one[:, np.newaxis] for one in autoregressive(0.999, 1, 2000, rng)])
    assert (len(slow.pieces), slow.long_enough) == (4, False)


@pytest.mark.parametrize("runs", [1, 2, 3, 5, 30])
def test_blocks_are_four_at_least_and_as_long_as_they_say(runs: int) -> None:
    rng = np.random.default_rng(4)
    slow = blocks_of([one[:, np.newaxis] for one in autoregressive(0.999, runs, 200, rng)])
    lengths = [piece.stop - piece.start for _, piece in slow.pieces]
    assert len(lengths) >= 4
    # Whole frames: a third of 100 is 33.
    assert np.allclose(lengths, slow.frames, atol=1)


def stiffness(sums: Array) -> Array:
    """Return the inverse variance from number, sum and sum of squares."""
    number, first, second = sums
    return np.array([(number - 1) / (second - first**2 / number)])


def test_an_inverse_variance_comes_without_its_bias_and_with_its_error() -> None:
    draws, frames, memory = 200, 400, 0.6
    # Squares remember as memory^2: g = 2.1, 188 independent ones.
    series = autoregressive(memory, draws, frames, np.random.default_rng(3))
    naive, found, inside = [], [], []
    for one in series:
        blocks = blocks_of([one[:, np.newaxis]]).of([one])
        sums = np.array([[len(x), x.sum(), x @ x] for x in blocks])
        naive.append(stiffness(sums.sum(axis=0))[0])
        result = jackknife(sums, stiffness, np.array([True]))
        found.append(result.value[0])
        inside.append(result.low[0] <= 1 <= result.high[0])
    # The mean of 200 of spread sqrt(2/188) = 0.10 is known to 0.007. The naive bias is that of the
    # inverse, 2/188, and of the mean taken off, 4/400.
    assert np.mean(naive) == pytest.approx(1.02, abs=0.02)
    assert np.mean(found) == pytest.approx(1.0, abs=0.02)
    # 95 % of 200: four standard errors are 6 %.
    assert 0.89 <= np.mean(inside) <= 1.0
