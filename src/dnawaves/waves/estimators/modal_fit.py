"""Modal (f-k) fit: the free motion of several standing waves, tied by the dispersion relation.

It needs no source: every mode has an amplitude and a phase of its own. What it cannot use is what
the source says about them, so it knows less than a full-waveform fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.modal import impulse_response
from dnawaves.waves.estimators.intervals import residual_interval
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.lattices import FRICTIONS_PER_PS, SPEEDS_A_PER_PS
from dnawaves.waves.estimators.model_class import ModelClass, judge_model_class
from dnawaves.waves.estimators.noise import ColouredNoise, Noise, WhiteNoise
from dnawaves.waves.estimators.separable import Separable

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModalFit:
    """Speed with its interval, friction, and whether the modes are those of a uniform lattice."""

    speed_A_per_ps: Value
    friction_per_ps: float
    model_class: ModelClass


def fit_modes(
    times_ps: Array,
    velocity: Array,
    spacing_nm: float,
    held: Sequence[int],
    modes: Sequence[int],
    noise: ColouredNoise | None = None,
) -> ModalFit:
    """Fit speed and friction of the lattice to the free motion (time, pair) in some modes.

    Modes count from 1; the record begins when the source is over, and holds all pairs. `noise` has
    the directions of the modes of the same chain; without it, it is white and of unknown level.
    The interval is a profile likelihood as of `fit_lattice`.
    """
    chain, chosen = chain_modes(velocity.shape[1], spacing_nm, held, modes)
    own: Noise = WhiteNoise() if noise is None else noise.only(chosen)
    unit = chain.frequencies_rad_per_ps[chosen]
    times = times_ps - times_ps[0]
    data = own.whiten(velocity @ chain.shapes[chosen].T)

    def columns(parameters: Array) -> Array:
        speed, friction = float(np.exp(parameters[0])), float(parameters[1] ** 2)
        parts = impulse_response(times, speed * unit, friction)
        blocks = np.zeros((len(chosen), 2, *data.shape))
        for which, part in enumerate(parts):
            blocks[np.arange(len(chosen)), which, np.arange(len(chosen))] = own.whiten(part)
        return blocks.reshape(2 * len(chosen), -1)

    fit = Separable(data.ravel(), columns)
    starts = [[np.log(v), np.sqrt(g)] for v in SPEEDS_A_PER_PS for g in FRICTIONS_PER_PS]
    best = fit.best(np.array(starts), 2)
    residual = (data.ravel() - fit.fitted(best.parameters)).reshape(data.shape)
    count = 2 + 2 * len(chosen)
    limits = residual_interval(fit, best, 0, [residual], count, own.level_known)
    return ModalFit(
        Value(*(float(np.exp(x)) for x in (best.parameters[0], limits.low, limits.high))),
        float(best.parameters[1] ** 2),
        judge_model_class([data], [residual], [own], count),
    )


def chain_modes(
    pairs: int, spacing_nm: float, held: Sequence[int], modes: Sequence[int]
) -> tuple[ScalarChain, list[int]]:
    """Return the chain of 1 Å/ps, and which of its shapes are some vibrations, counted from 1."""
    chain = ScalarChain.from_speed(pairs, 1.0, spacing_nm, held)
    moving = np.flatnonzero(chain.frequencies_rad_per_ps > 0)
    if max(modes) > len(moving):
        raise InputError(f"mode {max(modes)}: this chain has 1 to {len(moving)}")
    return chain, [int(moving[mode - 1]) for mode in modes]
