"""The long waves in a record: its projection on the lowest standing waves between its ends.

Base pairs are no rigid bodies: a blow also sets off vibrations inside and between neighbouring
pairs that no lattice of rigid pairs has. A rod is a theory of long waves, so the headline fit looks
at waves at least as long as the duplex between its ends, record and model alike; what it leaves out
is fitted beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.dispersion import lattice_frequency

Array = NDArray[np.float64]

# A standing wave exactly as long as the duplex belongs to the long ones.
ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class Projection:
    """White noise of unknown level along some combinations of channels: the only ones looked at.

    `directions` are (direction, channel). See `noise.Noise`.
    """

    directions: Array
    level_known: bool = False
    quiet_samples: float = np.inf

    def whiten(self, field: Array) -> Array:
        return np.swapaxes(field @ self.directions.T, -1, -2)


def standing_waves(pairs: int, held: Sequence[int]) -> Array:
    """Return the shapes (wave, pair), orthonormal, of the uniform chain, the longest first.

    Of a free duplex the first is the uniform motion.
    """
    return ScalarChain.from_speed(pairs, 1.0, 1.0, held).shapes


def wavenumbers_rad_per_nm(chain: ScalarChain, spacing_nm: float) -> Array:
    """Return the wavenumbers (wave,) of the standing waves of a uniform chain of 1 Å/ps."""
    edge = lattice_frequency(np.pi / spacing_nm, 1.0, spacing_nm)
    sines = np.minimum(chain.frequencies_rad_per_ps / edge, 1.0)
    return np.asarray(2 / spacing_nm * np.arcsin(sines))


def long_wave_count(pairs: int, held: Sequence[int]) -> int:
    """Return how many standing waves are at least as long as the duplex between its ends.

    That is, modes 1 and 2 of a duplex with held ends, of one with a held end, and of a free one, to
    which the uniform motion is added.
    """
    chain = ScalarChain.from_speed(pairs, 1.0, 1.0, held)
    phase = wavenumbers_rad_per_nm(chain, 1.0)
    inside = np.flatnonzero(chain.free)
    first, last = max(inside[0] - 1, 0), min(inside[-1] + 1, pairs - 1)
    return int(np.sum(phase <= 2 * np.pi / (last - first) + ROUND_OFF))


def lowest_waves(
    pairs: int, held: Sequence[int], count: int, scales: Sequence[float] = (1.0,)
) -> Projection:
    """Return the projection of the moving pairs' channels on the lowest `count` standing waves.

    `scales` are one factor for each coordinate of a pair: the root of its mass, so that all count
    by their energy.
    """
    shapes = standing_waves(pairs, held)[:count]
    moving = np.ones(pairs, dtype=bool)
    moving[list(held)] = False
    return Projection(np.asarray(np.kron(shapes[:, moving], np.diag(scales)), dtype=np.float64))
