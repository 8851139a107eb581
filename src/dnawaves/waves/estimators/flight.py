"""Time of flight against length: what a delay that is the same at every length cannot bias."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from dnawaves.errors import InputError
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.model_class import SIGNIFICANCE


@dataclass(frozen=True)
class Flight:
    """Speed from the slope of arrival times over lengths, with the delay at length zero.

    `scatter_ps` is the standard deviation of the times about the line. `p_value` is that of
    chi-squared, where the times came with errors: is it a line at all?
    """

    speed_A_per_ps: Value
    delay_ps: Value
    scatter_ps: float
    p_value: float | None


def fit_flight(
    lengths_A: ArrayLike, times_ps: ArrayLike, errors_ps: ArrayLike | None = None
) -> Flight:
    """Fit times = delay + length/speed to three duplexes or more.

    Intervals of 95 %: Student's t of the regression, whose scatter is the data's own; with
    `errors` the normal distribution, wider by the root of chi-squared over its degrees of freedom
    if that is above 1. A slope that may be zero leaves the speed without an upper limit.
    """
    lengths, times = np.asarray(lengths_A, dtype=float), np.asarray(times_ps, dtype=float)
    if lengths.ndim != 1 or lengths.shape != times.shape or len(np.unique(lengths)) < 3:
        raise InputError("a time of flight over length needs at least three different lengths")
    errors = np.ones_like(times) if errors_ps is None else np.asarray(errors_ps, dtype=float)
    design = np.stack([np.ones_like(lengths), lengths], axis=1) / errors[:, np.newaxis]
    solution = np.linalg.lstsq(design, times / errors, rcond=None)[0]
    left = times / errors - design @ solution
    freedom = len(times) - 2
    chi_squared = float(left @ left)
    covariance = np.linalg.inv(design.T @ design)
    if errors_ps is None:
        variance = chi_squared / freedom
        reach = float(stats.t.ppf(1 - SIGNIFICANCE / 2, freedom)) * np.sqrt(variance)
        p_value = None
    else:
        reach = float(stats.norm.ppf(1 - SIGNIFICANCE / 2)) * np.sqrt(
            max(1.0, chi_squared / freedom)
        )
        p_value = float(stats.chi2.sf(chi_squared, freedom))
    limits = reach * np.sqrt(np.diag(covariance))
    delay, slope = (float(value) for value in solution)
    if slope <= 0:
        raise InputError("the times do not grow with the lengths: no wave has travelled")
    slowest, fastest = slope + limits[1], slope - limits[1]
    speed = Value(1 / slope, 1 / slowest, 1 / fastest if fastest > 0 else np.inf)
    scatter = float(np.sqrt(np.sum((left * errors) ** 2) / freedom))
    return Flight(speed, Value(delay, delay - limits[0], delay + limits[0]), scatter, p_value)
