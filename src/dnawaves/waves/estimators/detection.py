"""Is there a wave at all? The false-alarm probability of the best of all fits to noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dnawaves.waves.estimators.lattice_fit import Observation

Array = NDArray[np.float64]

DRAWS = 999


class Searched(Protocol):
    """A lattice with its answers (searched, time, channel) everywhere that a fit starts from."""

    @property
    def answers(self) -> Array: ...


@dataclass(frozen=True)
class Detection:
    """Share of the whitened data that the likeliest wave explains, and how often noise does so."""

    explained: float
    p_value: float


class Detector:
    """Tests records of one scene for an amplitude that is not zero.

    The statistic is the likelihood ratio of the likeliest wave, over all speeds and frictions that
    a fit starts from, to none; with the noise's level free it is the share of the sum of squares
    that this wave explains. That it is the best of many is accounted for without a trials factor:
    the same search in `draws` records of whitened noise gives the statistic's distribution, and
    the p value is the rank among them.
    """

    def __init__(
        self,
        lattice: Searched,
        observation: Observation,
        rng: np.random.Generator,
        draws: int = DRAWS,
    ) -> None:
        whitened = [observation.noise.whiten(answer).ravel() for answer in lattice.answers]
        columns = np.array(whitened)
        norm = np.linalg.norm(columns, axis=1)
        self._observation = observation
        self._columns = columns[norm > 0] / norm[norm > 0, np.newaxis]
        # Only the columns' own space matters; what lies outside adds its chi-squared.
        basis = np.linalg.svd(self._columns, full_matrices=False)
        inside = basis[1] > 1e-9 * basis[1][0]
        reduced = self._columns @ basis[2][inside].T
        noise = rng.standard_normal((int(inside.sum()), draws))
        outside = rng.chisquare(columns.shape[1] - len(noise), draws)
        largest = np.max((reduced @ noise) ** 2, axis=0)
        self._by_chance = largest / (np.sum(noise**2, axis=0) + outside)

    def __call__(self, velocity: Array) -> Detection:
        moving = velocity[:, self._observation.lattice.moving]
        data = self._observation.noise.whiten(moving).ravel()
        explained = float(np.max((self._columns @ data) ** 2) / np.sum(data**2))
        above = int(np.sum(self._by_chance >= explained))
        return Detection(explained, (1 + above) / (1 + len(self._by_chance)))
