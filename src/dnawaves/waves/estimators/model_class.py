"""Does a fit leave more than noise? A fit of the wrong model class must look wrong."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from dnawaves.waves.estimators.noise import Noise

Array = NDArray[np.float64]

SIGNIFICANCE = 0.05
LAGS = 6


@dataclass(frozen=True)
class ModelClass:
    """Whether the whitened residual of a fit is noise of the known strength, without memory.

    `misfit` is the root of the residual's share in the whitened data, `excess` the residual's
    variance over the noise's (None where the noise's level is unknown). `wrong` is the flag
    "wrong model class": with the right one it is raised in 5 % of the cases.
    """

    misfit: float
    excess: float | None
    p_level: float
    p_memory: float
    wrong: bool


def judge_model_class(
    data: list[Array], residuals: list[Array], noises: list[Noise], parameters: int
) -> ModelClass:
    """Judge the whitened residuals (direction, time) of records that were fitted together.

    Two tests share the significance of 5 %. The level: the sum of squares, against the noise's,
    by an F test (chi-squared if the noise is given). The memory: autocorrelation at the first
    lags, of each direction and pooled over them, by Ljung & Box (1978), Biometrika 65, 297.
    """
    squares = sum(float(np.sum(part**2)) for part in residuals)
    total = sum(float(np.sum(part**2)) for part in data)
    count = sum(part.size for part in residuals)
    misfit = float(np.sqrt(squares / total)) if total > 0 else 0.0
    known = all(noise.level_known for noise in noises)
    excess, p_level = None, 1.0
    if known:
        learnt = sum(
            noise.quiet_samples * len(part) for noise, part in zip(noises, residuals, strict=True)
        )
        excess = squares / (count - parameters)
        p_level = float(
            stats.f.sf(excess, count - parameters, learnt)
            if np.isfinite(learnt)
            else stats.chi2.sf(squares, count - parameters)
        )
    memory = [_p_memory(part, noise) for part, noise in zip(residuals, noises, strict=True)]
    p_memory = min(1.0, len(memory) * min(memory))
    share = SIGNIFICANCE / (2 if known else 1)
    return ModelClass(misfit, excess, p_level, p_memory, min(p_level, p_memory) < share)


def _p_memory(residual: Array, noise: Noise) -> float:
    directions, frames = residual.shape
    correlations = []
    norm = np.sum(residual**2, axis=1)
    norm = np.where(norm > 0, norm, 1.0)
    lags = np.arange(1, min(LAGS, frames // 4) + 1)
    for lag in lags:
        products = np.sum(residual[:, lag:] * residual[:, :-lag], axis=1)
        correlations.append(products / norm)
    r = np.array(correlations)
    # What was learnt from quiet data predicts the record with errors of its own.
    variance = ((frames - lags) / (frames * (frames + 2)) + 1 / noise.quiet_samples)[:, np.newaxis]
    each = float(np.sum(r**2 / variance))
    pooled = float(np.sum(r.mean(axis=1) ** 2 / variance[:, 0] * directions))
    return min(1.0, 2 * min(stats.chi2.sf(each, r.size), stats.chi2.sf(pooled, len(lags))))
