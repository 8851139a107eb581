"""Statistics of correlated samples: how many there are, and errors that know of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from dnawaves.waves.estimators.intervals import LEVEL

Array = NDArray[np.float64]

MOST_BLOCKS, FEWEST_BLOCKS = 20, 4
# Blocks of so many independent samples depend on each other by a few percent of their variance.
SAMPLES_IN_BLOCK = 5


def statistical_inefficiency(runs: Sequence[Array]) -> float:
    """Return how many successive samples of a series make up one independent one, at least 1.

    g = 1 + 2 sum (1 - t/T) C(t)/C(0) up to the first negative C (Chodera et al. 2007, J. Chem.
    Theory Comput. 3, 26); the runs (time,) have one mean. They count as alike long.
    """
    frames = min(len(run) for run in runs)
    series = np.array([run[:frames] for run in runs])
    series = series - series.mean()
    spectrum = np.abs(np.fft.rfft(series, n=2 * frames, axis=1)) ** 2
    products = np.fft.irfft(spectrum, n=2 * frames, axis=1)[:, :frames].mean(axis=0)
    if products[0] <= 0:
        return 1.0
    correlation = products / (frames - np.arange(frames)) * frames / products[0]
    negative = np.flatnonzero(correlation < 0)
    end = int(negative[0]) if len(negative) else frames
    lags = np.arange(1, end)
    return max(1.0, float(1 + 2 * np.sum((1 - lags / frames) * correlation[1:end])))


@dataclass(frozen=True)
class Blocks:
    """Runs cut into blocks: slices of runs; are the blocks long against the memory?"""

    pieces: tuple[tuple[int, slice], ...]
    frames: int
    inefficiency: float

    @property
    def long_enough(self) -> bool:
        """Whether a block holds several independent samples."""
        return self.frames >= SAMPLES_IN_BLOCK * self.inefficiency

    def of(self, runs: Sequence[Array]) -> list[Array]:
        """Return the blocks of series of these runs, (time, ...) each."""
        return [runs[run][piece] for run, piece in self.pieces]


def blocks_of(runs: Sequence[Array]) -> Blocks:
    """Return the cut of runs (time, channel) into blocks, by the slowest channel's memory.

    Variances are estimated from them, so memory is that of squared deviations. There are 4 to some
    20 blocks, one of each run at least, as many as leave each long against the memory; where 4 are
    too short for that they are cut anyway.
    """
    mean = np.concatenate(runs).mean(axis=0)
    squares = [(run - mean) ** 2 for run in runs]
    memory = max(
        statistical_inefficiency([one[:, channel] for one in squares])
        for channel in range(squares[0].shape[1])
    )
    total = sum(len(run) for run in runs)
    # No block joins runs: three runs have six blocks at least.
    fewest = -(-FEWEST_BLOCKS // len(runs)) * len(runs)
    wanted = np.clip(total / (SAMPLES_IN_BLOCK * memory), fewest, max(MOST_BLOCKS, fewest))
    frames = max(int(total / wanted), 1)
    pieces = []
    for index, run in enumerate(runs):
        count = max(round(len(run) / frames), 1)
        ends = np.linspace(0, len(run), count + 1).astype(int)
        pieces += [(index, slice(a, b)) for a, b in pairwise(ends)]
    return Blocks(tuple(pieces), frames, memory)


class Jackknifed(NamedTuple):
    """Estimates, their bias removed, and the limits of their 95 % intervals."""

    value: Array
    low: Array
    high: Array


def jackknife(
    sums: Array, estimate: Callable[[Array], Array], positive: NDArray[np.bool_]
) -> Jackknifed:
    """Return estimates from sums (block, ...) over blocks, each block left out in turn.

    The bias of order 1/n of ratios and inverses is taken off, and Student's t with one less than
    the number of blocks gives the interval (Quenouille 1956, Tukey 1958; Efron & Stein 1981).
    Quantities that are `positive` are logarithms meanwhile.
    """
    count = len(sums)

    def changed(values: Array) -> Array:
        return np.where(positive, np.log(np.where(positive, values, 1.0)), values)

    total = sums.sum(axis=0)
    whole = changed(estimate(total))
    without = np.array([changed(estimate(total - one)) for one in sums])
    centre = count * whole - (count - 1) * without.mean(axis=0)
    error = np.sqrt((count - 1) * without.var(axis=0))
    reach = float(stats.t.ppf((1 + LEVEL) / 2, count - 1)) * error

    def back(values: Array) -> Array:
        return np.where(positive, np.exp(np.where(positive, values, 0.0)), values)

    return Jackknifed(back(centre), back(centre - reach), back(centre + reach))
