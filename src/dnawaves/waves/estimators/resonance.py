"""Resonance curve of a driven mode: frequency, width, amplitude and phase, transient included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.oscillator import sine_drive_response
from dnawaves.waves.estimators.intervals import Interval, residual_interval, split_like
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.model_class import ModelClass, judge_model_class
from dnawaves.waves.estimators.noise import Noise, WhiteNoise
from dnawaves.waves.estimators.oscillation import oscillator_starts
from dnawaves.waves.estimators.separable import Separable

Array = NDArray[np.float64]

WIDTHS_PER_PS = (0.02, 0.2, 1.0)


@dataclass(frozen=True)
class Resonance:
    """Frequency and full width (the friction) of a driven mode, and its answer.

    `amplitude` is force over mass in the mode, `phase_rad` how far the motion runs ahead of that
    of a driven oscillator: 0 unless the force has acted otherwise than thought.
    """

    frequency_rad_per_ps: Value
    width_per_ps: Value
    amplitude: float
    phase_rad: float
    model_class: ModelClass


def fit_resonance(
    times_ps: Sequence[Array],
    velocities: Sequence[Array],
    drives_rad_per_ps: Sequence[float],
    ramp_ps: float | Sequence[float] = 0.0,
    noise: Noise | None = None,
    intervals: bool = True,
) -> Resonance:
    """Fit one oscillator to a mode's velocities (time,) in runs of several drive frequencies.

    Each starts from rest under sin(drive t), which rises during the ramp: one for all runs or one
    for each. Intervals are profile likelihoods of 95 %, as of `fit_lattice`, or infinite without
    `intervals`. Runs of one length may have a common `noise` of one channel.
    """
    if not len(times_ps) == len(velocities) == len(drives_rad_per_ps) > 0:
        raise InputError("a resonance needs times, velocities and a drive for each run")
    ramps = [ramp_ps] * len(times_ps) if isinstance(ramp_ps, float | int) else list(ramp_ps)
    own = noise if noise is not None else WhiteNoise()
    data = [own.whiten(velocity[:, np.newaxis]) for velocity in velocities]

    def columns(parameters: Array) -> Array:
        frequency, friction = float(np.exp(parameters[0])), float(parameters[1] ** 2)
        parts = []
        for times, drive, ramp in zip(times_ps, drives_rad_per_ps, ramps, strict=True):
            position, velocity = sine_drive_response(times, [frequency], friction, drive, ramp)
            # The answer to the force's rate of change is the rate of change of the answer.
            force = _ramped_sine(times, drive, ramp)[:, np.newaxis]
            quadrature = (force - friction * velocity - frequency**2 * position) / drive
            parts.append([own.whiten(part).ravel() for part in (velocity, quadrature)])
        return np.concatenate([np.array(part) for part in parts], axis=1)

    flat = np.concatenate([part.ravel() for part in data])
    fit = Separable(flat, columns)
    longest = max(float(times[-1]) for times in times_ps)
    interval = float(times_ps[0][1] - times_ps[0][0])
    best = fit.best(oscillator_starts(longest, interval, WIDTHS_PER_PS), 3)
    residuals = split_like(flat - fit.fitted(best.parameters), data)
    limits = [Interval(-np.inf, np.inf), Interval(0.0, np.inf)]
    if intervals:
        limits = [
            residual_interval(fit, best, index, residuals, 4, own.level_known, root=index == 1)
            for index in range(2)
        ]
    in_phase, ahead = fit.amplitudes(best.parameters)
    return Resonance(
        Value(*(float(np.exp(x)) for x in (best.parameters[0], limits[0].low, limits[0].high))),
        Value(*(float(x**2) for x in (best.parameters[1], limits[1].low, limits[1].high))),
        float(np.hypot(in_phase, ahead)),
        float(np.arctan2(ahead, in_phase)),
        judge_model_class(data, residuals, [own] * len(data), 4),
    )


def steady_answer(times_ps: Array, velocity: Array, drive_rad_per_ps: float) -> tuple[float, float]:
    """Return amplitude and phase of a velocity (time,) at the drive, over the last whole periods.

    velocity = amplitude sin(drive t + phase): a point of the resonance curve once the transient
    has died, at resonance in phase with the force.
    """
    period = 2 * np.pi / drive_rad_per_ps
    periods = int((times_ps[-1] - times_ps[0]) / period / 2)
    if periods < 1:
        raise InputError("the record is shorter than two periods of the drive")
    late = times_ps > times_ps[-1] - periods * period
    phase = drive_rad_per_ps * times_ps[late]
    columns = np.stack([np.sin(phase), np.cos(phase)], axis=1)
    sine, cosine = np.linalg.lstsq(columns, velocity[late], rcond=None)[0]
    return float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))


def _ramped_sine(times: Array, drive: float, ramp_ps: float) -> Array:
    rising = np.ones_like(times)
    if ramp_ps > 0:
        rising = (1 - np.cos(np.pi * np.minimum(times / ramp_ps, 1.0))) / 2
    return np.asarray(rising * np.sin(drive * times))
