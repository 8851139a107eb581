"""One damped oscillation that an impulse has started: frequency, width, and how well it fits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.modal import impulse_response
from dnawaves.waves.estimators.intervals import residual_interval
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.separable import Separable

Array = NDArray[np.float64]

FRICTIONS_PER_PS = (0.02, 0.5)
STARTS = 60


@dataclass(frozen=True)
class Oscillation:
    """Frequency of the undamped oscillator, full width (the friction), amplitude and misfit.

    The amplitude is the velocity right after the impulse.
    """

    frequency_rad_per_ps: Value
    width_per_ps: float
    amplitude: float
    misfit: float


def fit_oscillation(times_ps: Array, velocity: Array, interval: bool = True) -> Oscillation:
    """Fit the velocity (time,) of one oscillator that is at rest until the impulse at t = 0.

    The interval is a profile likelihood of 95 % with the residual as noise, as of `fit_lattice`;
    without `interval` its limits are infinite.
    """

    def columns(parameters: Array) -> Array:
        frequency, friction = float(np.exp(parameters[0])), float(parameters[1] ** 2)
        return np.asarray(impulse_response(times_ps, [frequency], friction)[1].T)

    step = float(times_ps[1] - times_ps[0])
    fit = Separable(velocity, columns)
    best = fit.best(oscillator_starts(float(times_ps[-1]), step, FRICTIONS_PER_PS), 3)
    low, high = -np.inf, np.inf
    if interval:
        residual = (velocity - fit.fitted(best.parameters))[np.newaxis]
        limits = residual_interval(fit, best, 0, [residual], 3)
        low, high = limits.low, limits.high
    return Oscillation(
        Value(*(float(np.exp(x)) for x in (best.parameters[0], low, high))),
        float(best.parameters[1] ** 2),
        float(fit.amplitudes(best.parameters)[0]),
        float(np.sqrt(best.sum_of_squares / np.sum(velocity**2))),
    )


def oscillator_starts(
    longest_ps: float, interval_ps: float, frictions_per_ps: Sequence[float]
) -> Array:
    """Return starts (start, 2) for an oscillator: ln of the frequency, root of the friction.

    Everywhere from a quarter of a period in the record to half of the Nyquist frequency.
    """
    frequencies = np.geomspace(np.pi / 2 / longest_ps, np.pi / 2 / interval_ps, STARTS)
    return np.array([[np.log(w), np.sqrt(g)] for w in frequencies for g in frictions_per_ps])


def share_of_start(fields: Sequence[tuple[float, Array]]) -> Array:
    """Return the motion's share (time,) in the shape that it had at first, 1 at the start.

    Each field (time, pair) comes with its mass or moment of inertia as weight.
    """
    overlap = sum(weight * field @ field[0] for weight, field in fields)
    return np.asarray(overlap / overlap[0])
