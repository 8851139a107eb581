"""Least-squares fits of a frequency or speed and a friction, started everywhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]

STARTING_FRICTIONS_PER_PS = (0.02, 0.5)


@dataclass(frozen=True)
class Fit:
    """A fitted rate (speed or frequency), the friction, the gain, and how badly they fit.

    `misfit` is the root of the residual's share in the data's sum of squares: 0 is perfect, 1 is
    no better than nothing.
    """

    rate: float
    friction_per_ps: float
    gain: float
    misfit: float


def fit_rate(model: Callable[[float, float], Array], data: Array, starts: Array) -> Fit:
    """Fit model(rate, friction) times a free gain to the data.

    The rate may be any positive number and the friction any that is not negative; the best of
    the fits from all `starts` is taken, so that no expectation chooses among the minima.
    """

    def gain(shape: Array) -> float:
        return float(np.vdot(shape, data) / max(np.vdot(shape, shape), np.finfo(float).tiny))

    def residual(parameters: Array) -> Array:
        shape = model(float(np.exp(parameters[0])), float(parameters[1] ** 2))
        return (gain(shape) * shape - data).ravel()

    scale = float(np.sqrt(np.vdot(data, data)))
    best = min(
        (
            least_squares(
                lambda p: residual(p) / scale, [np.log(start), np.sqrt(friction)], x_scale="jac"
            )
            for start in starts
            for friction in STARTING_FRICTIONS_PER_PS
        ),
        key=lambda result: float(result.cost),
    )
    rate, friction = float(np.exp(best.x[0])), float(best.x[1] ** 2)
    return Fit(rate, friction, gain(model(rate, friction)), float(np.sqrt(2 * best.cost)))
