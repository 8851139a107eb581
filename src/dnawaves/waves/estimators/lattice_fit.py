"""Full-waveform fits: whole records against lattices with the scene's source and ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.waves.estimators.intervals import residual_interval, split_like
from dnawaves.waves.estimators.lattices import FRICTION, Lattice
from dnawaves.waves.estimators.model_class import ModelClass, judge_model_class
from dnawaves.waves.estimators.noise import Noise, WhiteNoise
from dnawaves.waves.estimators.separable import Separable

Array = NDArray[np.float64]

REFINED_STARTS = 2
# Logarithm of a value, or root of a friction: further out a search has run away, and powers of the
# values overflow.
FARTHEST = 50.0
UNKNOWN_NOISE = WhiteNoise()


@dataclass(frozen=True, eq=False)
class Observation:
    """A record (time, *field) of one scene, the lattice that it is fitted with, and its noise.

    Without `noise` it is white and of unknown strength.
    """

    velocity: Array
    lattice: Lattice
    noise: Noise = UNKNOWN_NOISE


@dataclass(frozen=True)
class Value:
    """A fitted value with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class LatticeFit:
    """Fitted values by name, the amplitude of each record's source, and how well it all fits.

    The amplitude is 1 where the lattice's source is what was really put in.
    """

    values: dict[str, Value]
    amplitudes: tuple[float, ...]
    model_class: ModelClass

    def __getitem__(self, name: str) -> Value:
        return self.values[name]


def fit_lattice(
    observations: Sequence[Observation],
    starts: Sequence[dict[str, float]] | None = None,
    intervals: Sequence[str] | None = None,
) -> LatticeFit:
    """Fit one or several records at once; parameters of the same name are common to all.

    Each record's source has an amplitude of its own. `intervals` names the values whose intervals
    are wanted (all by default; others have infinite limits). They are profile likelihoods. Where
    the noise is given or learnt, residuals are whitened and one residual's variance is theirs, but
    not below the noise's; where it is not, that variance is multiplied by the number of residuals
    that make up one independent one (`correlation_inflation`).
    """
    names = tuple(dict.fromkeys(name for one in observations for name in one.lattice.names))
    data = [_whitened(one, one.velocity) for one in observations]
    flat = np.concatenate([part.ravel() for part in data])
    if not flat.any():
        raise InputError("nothing moves in the records: there is no wave to fit")
    fit = Separable(flat, partial(_columns, observations, names, [part.size for part in data]))
    begin = starts or observations[0].lattice.starts(
        lambda answers: explained(answers, data[0], observations[0].noise)
    )
    minimum = fit.best(np.array([_coordinates(names, start) for start in begin]), REFINED_STARTS)
    residual = flat - fit.fitted(minimum.parameters)
    residuals = split_like(residual, data)
    noises = [one.noise for one in observations]
    count = len(names) + len(observations)
    verdict = judge_model_class(data, residuals, noises, count)
    known = all(noise.level_known for noise in noises)
    found = {}
    for index, name in enumerate(names):
        value, to_value = minimum.parameters[index], _to_value(name)
        if intervals is not None and name not in intervals:
            found[name] = Value(to_value(value), -np.inf, np.inf)
            continue
        limits = residual_interval(fit, minimum, index, residuals, count, known, name == FRICTION)
        found[name] = Value(to_value(value), to_value(limits.low), to_value(limits.high))
    amplitudes = tuple(float(a) for a in fit.amplitudes(minimum.parameters))
    return LatticeFit(found, amplitudes, verdict)


def explained(answers: Array, data: Array, noise: Noise) -> Array:
    """Return the share of whitened data's sum of squares that each answer, scaled, explains."""
    columns = np.array([noise.whiten(answer).ravel() for answer in answers])
    norm = np.sum(columns**2, axis=1) * np.sum(data**2)
    return np.divide((columns @ data.ravel()) ** 2, norm, out=np.zeros(len(norm)), where=norm > 0)


def _whitened(observation: Observation, velocity: Array) -> Array:
    moving = velocity[:, observation.lattice.moving]
    if not np.isfinite(moving).all():
        raise InputError("the record to fit holds numbers that are not finite")
    return observation.noise.whiten(moving.reshape(len(moving), -1))


def _columns(
    observations: Sequence[Observation],
    names: tuple[str, ...],
    sizes: Sequence[int],
    parameters: Array,
) -> Array | None:
    """Return one column (amplitude, n) per record, zero in the others' places."""
    if np.any(np.abs(parameters) > FARTHEST):
        return None
    values = {name: _to_value(name)(float(x)) for name, x in zip(names, parameters, strict=True)}
    columns = np.zeros((len(observations), sum(sizes)))
    offset = 0
    for row, (one, size) in enumerate(zip(observations, sizes, strict=True)):
        velocity = one.lattice.velocity(values)
        if velocity is None or not np.isfinite(velocity).all():
            return None
        columns[row, offset : offset + size] = one.noise.whiten(velocity).ravel()
        offset += size
    return columns


def _coordinates(names: Sequence[str], values: dict[str, float]) -> Array:
    missing = [name for name in names if name not in values]
    if missing:
        raise InputError(f"the start of a fit lacks {', '.join(missing)}")
    return np.array([_to_coordinate(name)(values[name]) for name in names])


def _to_coordinate(name: str) -> Callable[[float], float]:
    if name == FRICTION:
        return lambda value: float(np.sqrt(value))
    if name.startswith("coupling"):
        return lambda value: float(np.arctanh(value))
    return lambda value: float(np.log(value))


def _to_value(name: str) -> Callable[[float], float]:
    if name == FRICTION:
        return lambda x: float(x**2)
    if name.startswith("coupling"):
        return lambda x: float(np.tanh(x))
    return lambda x: float(np.exp(x))
