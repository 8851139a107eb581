"""Waves upon thermal motion: pairs of opposite signs from several snapshots, averaged and fitted.

Half the difference of a pair holds the wave and what chaos has made of the kick since, which
differs from snapshot to snapshot and grows: a sample weighs as little as its spread is large. The
average ends where fewer than half of the replicas are left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from dnawaves.errors import InputError
from dnawaves.waves.estimators.intervals import LEVEL
from dnawaves.waves.estimators.lattice_fit import LatticeFit, Observation, Value, fit_lattice
from dnawaves.waves.estimators.lattices import FRICTION, Lattice
from dnawaves.waves.estimators.model_class import SIGNIFICANCE
from dnawaves.waves.estimators.noise import Noise

Array = NDArray[np.float64]

DRAWS = 100
MISFIT_DRAWS = 999
FEWEST_REPLICAS = 2


@dataclass(frozen=True, eq=False)
class Replicas:
    """Answers (replica, time, *field) to one excitation, and how many frames of each count."""

    answers: Array
    usable: NDArray[np.int64]

    @classmethod
    def of(cls, answers: Sequence[Array]) -> Replicas:
        """Return replicas, each as long as it counts, up to where half of them are left.

        And two of several.
        """
        if not answers:
            raise InputError("replicas: found none; allowed: one and more")
        usable = np.array([len(one) for one in answers])
        enough = min(max(FEWEST_REPLICAS, (len(answers) + 1) // 2), len(answers))
        frames = int(np.sort(usable)[::-1][enough - 1])
        filled = np.zeros((len(answers), frames, *answers[0].shape[1:]))
        for kept, answer in zip(filled, answers, strict=True):
            kept[: len(answer)] = answer[:frames]
        return cls(filled, usable)

    @property
    def frames(self) -> int:
        """Number of frames of the average."""
        return int(self.answers.shape[1])

    @property
    def count(self) -> Array:
        """Which frames of which replica count, (replica, time), 0 or 1."""
        return (np.arange(self.frames) < self.usable[:, np.newaxis]).astype(float)

    def mean(self, weights: Array | None = None) -> Array:
        """Return the average (time, *field), each replica as often as `weights` says."""
        share = self.count * (np.ones(len(self.answers)) if weights is None else weights)[:, None]
        return np.asarray(np.einsum("rt,rt...->t...", share / share.sum(axis=0), self.answers))

    def drawn(self, rng: np.random.Generator) -> Array:
        """Return how often each replica is in a draw with replacement that leaves no frame empty.

        A frame without any would be taken for one in which nothing moves.
        """
        number = len(self.answers)
        while True:
            times = np.bincount(rng.integers(number, size=number), minlength=number).astype(float)
            if np.all(times @ self.count > 0):
                return times

    def deviations(self, noise: Noise, moving: NDArray[np.bool_]) -> Array:
        """Return what each whitened replica adds to the mean's error, (replica, direction, time).

        Scaled so that the sum over replicas of independent such errors has the mean's variance.
        """
        number = np.maximum(self.count.sum(axis=0), 1)
        scale = np.sqrt(number / np.maximum(number - 1, 1)) / number
        moved = (self.answers - self.mean())[:, :, moving]
        return np.asarray(noise.whiten(moved) * (self.count * scale)[:, np.newaxis])


@dataclass(frozen=True, eq=False)
class SpreadNoise:
    """Noise of a spread (time,) along the directions of another, which knows no level."""

    directions: Noise
    sd: Array
    level_known: bool = True
    quiet_samples: float = np.inf

    @classmethod
    def between(
        cls, replicas: Replicas, directions: Noise, moving: NDArray[np.bool_]
    ) -> SpreadNoise:
        """Return the noise of the replicas' mean, from their spread, all directions pooled.

        At first all replicas are alike, and weights by the spread alone would look at the first
        frames only, where base pairs do not yet move as a lattice of rigid ones: so no frame has
        less than the median's.
        """
        squares = np.sum(replicas.deviations(directions, moving) ** 2, axis=0).mean(axis=0)
        return cls(directions, np.sqrt(np.maximum(squares, np.median(squares))))

    def whiten(self, field: Array) -> Array:
        return self.directions.whiten(field) / self.sd


@dataclass(frozen=True)
class ReplicaFit:
    """A lattice's fit to averaged replicas; the interval of a value is a bootstrap over them.

    `misfit` is the root of the residual's share of the signal, each sample over its noise;
    `p_value` how often the spread between the replicas leaves as much by chance.
    """

    value: Value
    friction_per_ps: float
    amplitude: float
    misfit: float
    p_value: float
    replicas: int
    frames: int
    interval: str

    @property
    def wrong(self) -> bool:
        """Whether more is left over than the replicas' spread explains, at 5 %."""
        return self.p_value < SIGNIFICANCE


def fit_replicas(
    scenes: Sequence[tuple[Replicas, Lattice]],
    directions: Noise,
    name: str,
    rng: np.random.Generator,
    draws: int = DRAWS,
) -> ReplicaFit:
    """Fit averages of replicas, each with a lattice of as many frames; `name` is the value wanted.

    Several, such as those of several drives, share the parameters. Least squares along the
    `directions` with the spread over replicas as weights. The interval is that of Student's t with
    the standard error of a bootstrap over replicas of the value's logarithm (Efron & Tibshirani
    1993, ch. 12): neither the colour of the noise nor its growth is assumed. Of one replica the
    limits are infinite.
    """
    count = min(len(replicas.answers) for replicas, _ in scenes)
    noises = [
        SpreadNoise.between(replicas, directions, lattice.moving)
        if count >= FEWEST_REPLICAS
        else directions
        for replicas, lattice in scenes
    ]

    def fit(fields: list[Array], starts: list[dict[str, float]] | None = None) -> LatticeFit:
        observations = [
            Observation(field, lattice, noise)
            for field, (_, lattice), noise in zip(fields, scenes, noises, strict=True)
        ]
        return fit_lattice(observations, starts, [])

    best = fit([replicas.mean() for replicas, _ in scenes])
    values = {key: one.value for key, one in best.values.items()}
    signal = residual = 0.0
    for (replicas, lattice), noise, amplitude in zip(scenes, noises, best.amplitudes, strict=True):
        answer = lattice.velocity(values)
        assert answer is not None
        data = noise.whiten(replicas.mean()[:, lattice.moving])
        signal += float(np.sum(data**2))
        residual += float(np.sum((data - amplitude * noise.whiten(answer)) ** 2))
    value, p_value, interval = Value(values[name], 0.0, np.inf), 1.0, ""
    if count >= FEWEST_REPLICAS:
        drawn = []
        for _ in range(draws):
            fields = [replicas.mean(replicas.drawn(rng)) for replicas, _ in scenes]
            drawn.append(np.log(fit(fields, [values])[name].value))
        # A bootstrap's spread is that of a variance over n, in place of n - 1.
        error = float(np.std(drawn)) * np.sqrt(count / (count - 1))
        reach = float(stats.t.ppf((1 + LEVEL) / 2, count - 1)) * error
        value = Value(*(float(values[name] * np.exp(x)) for x in (0.0, -reach, reach)))
        deviations = [
            replicas.deviations(noise, lattice.moving)
            for (replicas, lattice), noise in zip(scenes, noises, strict=True)
        ]
        p_value = _p_spread(deviations, residual, rng)
        interval = f"95 %, bootstrap over {count} replicas"
    return ReplicaFit(
        value,
        values[FRICTION],
        abs(float(best.amplitudes[0])),
        float(np.sqrt(residual / signal)),
        p_value,
        count,
        min(replicas.frames for replicas, _ in scenes),
        interval,
    )


def _p_spread(deviations: Sequence[Array], residual: float, rng: np.random.Generator) -> float:
    """Return how often errors of the means, drawn from the replicas', leave as much.

    Multipliers of mean 0 and variance 1 keep the deviations' correlations in time and space (Wu
    1986, Ann. Stat. 14, 1261).
    """
    by_chance = np.zeros(MISFIT_DRAWS)
    for one in deviations:
        flat = one.reshape(len(one), -1)
        multipliers = rng.standard_normal((MISFIT_DRAWS, len(flat)))
        by_chance += np.einsum("dr,rs,ds->d", multipliers, flat @ flat.T, multipliers)
    return float((1 + np.sum(by_chance >= residual)) / (1 + MISFIT_DRAWS))
