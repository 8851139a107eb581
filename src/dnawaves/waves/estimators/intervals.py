"""Confidence intervals: profile likelihood of a separable fit, bootstrap over runs or blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from dnawaves.waves.estimators.separable import Minimum, Separable

Array = NDArray[np.float64]

LEVEL = 0.95
# Halvings or doublings on the way to a limit; a parameter without one there has none.
STEPS = 12
# Of the distance to the limit, far below what the interval's own scatter is.
CLOSE = 0.01
# Relative change of the sum of squares at which the search over the other parameters ends: a limit
# lies where it has risen by four parts in the number of residuals, thousands.
SETTLED = 1e-6


@dataclass(frozen=True)
class Interval:
    """A confidence interval in the search's own coordinate; a limit may be infinite."""

    low: float
    high: float


def profile_interval(
    fit: Separable,
    minimum: Minimum,
    index: int,
    variance: float,
    degrees_of_freedom: float,
    root: bool = False,
    level: float = LEVEL,
) -> Interval:
    """Return where the sum of squares, minimised over all else, exceeds its minimum by too much.

    That is by F(level; 1, degrees of freedom) times `variance`, that of one independent residual.
    Of a coordinate that is the `root` of a value only the square counts: its sign is dropped.
    """
    parameters, least = np.array(minimum.parameters), -np.inf
    if root:
        parameters[index], least = abs(parameters[index]), 0.0
    here = float(parameters[index])
    threshold = float(stats.f.ppf(level, 1, max(degrees_of_freedom, 1.0))) * variance
    slope = float(np.sum(fit.sensitivity(parameters, index) ** 2))
    if threshold <= 0 or slope <= 0:
        return Interval(here, here) if slope > 0 else Interval(least, np.inf)
    reach = np.sqrt(threshold / slope)

    def excess(offset: float) -> float:
        rest = fit.minimise(parameters, {index: here + offset}, SETTLED)
        return rest.sum_of_squares - minimum.sum_of_squares

    low, high = (here + limit_of_rise(excess, sign * reach, threshold) for sign in (-1, 1))
    return Interval(max(low, least), high)


def residual_interval(
    fit: Separable,
    minimum: Minimum,
    index: int,
    residuals: Sequence[Array],
    fitted: int,
    level_known: bool = False,
    root: bool = False,
) -> Interval:
    """Return the profile likelihood's interval in which what a fit leaves stands for the noise.

    `residuals` (series, time) are those of each record, `fitted` is the number of parameters and
    amplitudes. Residuals whitened by noise of a known level have a variance of 1 or more; that of
    others is multiplied by the number of them that make up one independent one.
    """
    freedom = float(sum(part.size for part in residuals) - fitted)
    variance, inflation = minimum.sum_of_squares / freedom, 1.0
    if level_known:
        variance = max(variance, 1.0)
    else:
        sensitivity = split_like(fit.sensitivity(minimum.parameters, index), residuals)
        inflation = max(map(correlation_inflation, residuals, sensitivity))
    return profile_interval(fit, minimum, index, variance * inflation, freedom / inflation, root)


def split_like(flat: Array, parts: Sequence[Array]) -> list[Array]:
    """Return a flat array cut into pieces of the shapes of some parts."""
    ends = np.cumsum([part.size for part in parts])[:-1]
    pieces = zip(np.split(flat, ends), parts, strict=True)
    return [piece.reshape(part.shape) for piece, part in pieces]


def limit_of_rise(excess: Callable[[float], float], offset: float, threshold: float) -> float:
    """Return the offset at which a nearly quadratic excess reaches the threshold."""
    inside, outside = 0.0, np.inf * np.sign(offset)
    for _ in range(STEPS):
        found = excess(offset)
        if abs(found / threshold - 1) < 2 * CLOSE:
            return offset
        if found < threshold:
            inside = offset
        else:
            outside = offset
        guess = offset * np.sqrt(threshold / found) if found > 0 else 2 * offset
        guess = np.sign(offset) * min(abs(guess), 3 * abs(offset))
        if not min(inside, outside) < guess < max(inside, outside):
            guess = (inside + outside) / 2
        offset = float(guess)
    return offset if np.isfinite(outside) else float(outside)


def correlation_inflation(residual: Array, sensitivity: Array) -> float:
    """Return how many residuals (series, time) go into one independent one, for one parameter.

    An estimate moves with the sum over residual times sensitivity. Its variance is that of the
    series in time of these products, summed over the series, which may be correlated with each
    other: the estimate of Newey & West (1987), Econometrica 55, 703, with n^(1/2) lags, over what
    it would be without any correlation. At least 1: residuals that alternate must not be taken
    for more than there are.
    """
    score = np.sum(residual * sensitivity, axis=0)
    independent = float(np.mean(residual**2) * np.sum(sensitivity**2))
    if independent <= 0:
        return 1.0
    length = 2 * len(score)
    products = np.fft.irfft(np.abs(np.fft.rfft(score, n=length)) ** 2, n=length)
    lags = np.arange(1, int(np.sqrt(len(score))) + 1)
    weights = 2 * (1 - lags / (len(lags) + 1))
    return max(1.0, float(products[0] + np.sum(weights * products[lags])) / independent)


def bootstrap_interval(
    samples: Array,
    estimate: Callable[[Array], float],
    rng: np.random.Generator,
    draws: int = 400,
    level: float = LEVEL,
) -> Interval:
    """Return percentiles of an estimate over samples (run or block, ...) drawn with replacement.

    Runs are independent; blocks must be longer than the correlation time, see `blocks`.
    """
    count = len(samples)
    values = [estimate(samples[rng.integers(count, size=count)]) for _ in range(draws)]
    low, high = np.quantile(values, [(1 - level) / 2, (1 + level) / 2])
    return Interval(float(low), float(high))


def blocks(series: Array, frames: int) -> Array:
    """Return a series (time, ...) cut into blocks (block, frames, ...); the rest is left out."""
    count = len(series) // frames
    return series[: count * frames].reshape(count, frames, *series.shape[1:])
