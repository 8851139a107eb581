"""Ridges of a frequency-wavenumber map: frequency and width of each standing wave.

The modes are those of the uniform lattice with the scene's ends; within a mode the free motion
after the source is one damped oscillation, fitted in time, so that a record resolves more than
the inverse of its length. `modal_fit` ties the frequencies together by the dispersion relation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.modal import impulse_response
from dnawaves.waves.estimators.intervals import correlation_inflation
from dnawaves.waves.estimators.long_waves import wavenumbers_rad_per_nm
from dnawaves.waves.estimators.modal_fit import chain_modes
from dnawaves.waves.estimators.model_class import judge_model_class
from dnawaves.waves.estimators.noise import ColouredNoise, Noise, WhiteNoise
from dnawaves.waves.estimators.oscillation import oscillator_starts
from dnawaves.waves.estimators.separable import Separable

Array = NDArray[np.float64]

FRICTIONS_PER_PS = (0.05, 0.5)


@dataclass(frozen=True)
class Ridge:
    """One mode: wavenumber, frequency of the undamped wave and full width (the friction).

    `sd_rad_per_ps` is the frequency's standard error, `width_sd_per_ps` the width's; power is the
    mean square of the mode's motion; `wrong` says that one damped oscillation is not all of it.
    """

    mode: int
    wavenumber_rad_per_nm: float
    frequency_rad_per_ps: float
    sd_rad_per_ps: float
    width_per_ps: float
    width_sd_per_ps: float
    power: float
    wrong: bool


def ridges(
    times_ps: Array,
    velocity: Array,
    spacing_nm: float,
    held: Sequence[int],
    modes: Sequence[int],
    noise: ColouredNoise | None = None,
) -> list[Ridge]:
    """Return the ridges of some modes, counted from 1, of velocities (time, pair).

    The record begins when the source is over; all pairs are there, held ones too. `noise` has the
    directions of the modes of the same chain; without it the noise is white and of unknown level.
    """
    chain, chosen = chain_modes(velocity.shape[1], spacing_nm, held, modes)
    wavenumbers = wavenumbers_rad_per_nm(chain, spacing_nm)
    found = []
    for mode, index in zip(modes, chosen, strict=True):
        projection = velocity @ chain.shapes[index]
        own: Noise = WhiteNoise() if noise is None else noise.only([index])
        k = float(wavenumbers[index])
        found.append(_ridge(mode, k, times_ps - times_ps[0], projection, own))
    return found


def _ridge(mode: int, wavenumber: float, times: Array, projection: Array, noise: Noise) -> Ridge:
    data = noise.whiten(projection[:, np.newaxis])

    def columns(parameters: Array) -> Array:
        frequency, friction = float(np.exp(parameters[0])), float(parameters[1] ** 2)
        parts = impulse_response(times, [frequency], friction)
        # Any free motion is a combination of the two: position and velocity after an impulse.
        return np.array([noise.whiten(part).ravel() for part in parts])

    interval = float(times[1] - times[0])
    fit = Separable(data.ravel(), columns)
    best = fit.best(oscillator_starts(float(times[-1]), interval, FRICTIONS_PER_PS), 3)
    residual = (data.ravel() - fit.fitted(best.parameters)).reshape(data.shape)
    variance = best.sum_of_squares / (data.size - 4)
    spread = []
    for index in range(2):
        sensitivity = fit.sensitivity(best.parameters, index)
        inflation = 1.0
        if not noise.level_known:
            inflation = correlation_inflation(residual, sensitivity.reshape(data.shape))
        spread.append(float(np.sqrt(variance * inflation / max(np.sum(sensitivity**2), 1e-300))))
    frequency, root = float(np.exp(best.parameters[0])), float(best.parameters[1])
    verdict = judge_model_class([data], [residual], [noise], 4)
    return Ridge(
        mode,
        wavenumber,
        frequency,
        frequency * spread[0],
        root**2,
        2 * abs(root) * spread[1],
        float(np.mean(projection**2)),
        verdict.wrong,
    )
