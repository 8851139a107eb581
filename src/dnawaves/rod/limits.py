"""The waves of any rod at both ends of its dispersion relation: very short and very long."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
from scipy.optimize import linear_sum_assignment

from dnawaves.rod.plane_waves import MOTIONS, plane_waves
from dnawaves.rod.rod import FloatArray, Rod
from dnawaves.units import A_PER_NM

STRAINS = ("shear 1", "shear 2", "extension", "bend 1", "bend 2", "twist")


class ShortWaves(NamedTuple):
    """Speeds (6,) of the waves named in `STRAINS`, and the share (6,) of that strain in each."""

    speeds_A_per_ps: FloatArray
    shares: FloatArray


def short_waves(rod: Rod) -> ShortWaves:
    """Return the waves far shorter than the pitch and the radius of gyration, couplings included.

    There omega^2 M v = k^2 K v. Each is named after one strain, so that the shares of these strains
    in the elastic energy are in sum the largest.
    """
    squared, shapes = scipy.linalg.eigh(rod.stiffness, rod.mass)
    shares = shapes * (rod.stiffness @ shapes) / squared
    waves = linear_sum_assignment(-shares)[1]
    return ShortWaves(np.sqrt(squared[waves]) * A_PER_NM, shares[range(6), waves])


def long_wave_speeds_A_per_ps(rod: Rod) -> dict[str, float]:
    """Return the speeds, per arc length, of extension and twist waves longer than the pitch.

    The slopes of the two branches that start from rest at k = 0, of any rod, bent and coupled
    ones included. The two motions mix; "extension" is the wave that moves more along d3.
    """
    waves = plane_waves(rod, [0.0], lattice=False)
    slopes = waves.group_velocities_A_per_ps[0]
    at_rest = np.isfinite(waves.phase_velocities_A_per_ps[0])
    # the flexural waves of an untwisted rod rest too, and start flat
    acoustic = np.flatnonzero(at_rest)[np.argsort(slopes[at_rest])[-2:]]
    along = waves.kinetic_shares()[0, acoustic, list(MOTIONS).index("extension")]
    extension, twist = slopes[acoustic[np.argsort(-along)]]
    return {"extension": float(extension), "twist": float(twist)}
