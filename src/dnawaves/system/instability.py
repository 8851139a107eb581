"""What negative modes do to the answer: how fast the difference of two runs grows along them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.system.modes import EIGENVALUE_TOLERANCE_PER_PS2
from dnawaves.system.rigid_body import RigidBodies

Array = NDArray[np.float64]

# Part of the velocity put in that counts as a spoilt answer.
SPOILT = 0.01


@dataclass(frozen=True)
class Instability:
    """Negative modes that are left at a structure.

    `onset_ps` is the earliest time at which the growth along one of them makes up `SPOILT` of the
    motion after the kick of a single base pair that excites it most.
    """

    modes: int
    lowest_per_ps2: float
    onset_ps: float

    def __str__(self) -> str:
        if not self.modes:
            return "no mode is negative"
        rate = np.sqrt(-self.lowest_per_ps2)
        return (
            f"{self.modes} negative mode{'s' if self.modes > 1 else ''}, the lowest "
            f"{self.lowest_per_ps2:.3g} ps^-2: the difference of two runs grows along it by "
            f"{rate:.3g} per ps, and {SPOILT:.0%} of the motion after a kick of one base pair can "
            f"be such growth from {self.onset_ps:.3g} ps on"
        )


def instability(
    eigenvalues_per_ps2: Array, vectors: Array, masses_Da: Array, bodies: RigidBodies
) -> Instability:
    """Judge the modes of lowest eigenvalue, given by their mass-weighted vectors (3 atoms, modes).

    Along a mode of eigenvalue -g² a velocity grows as cosh(g t). The kick of one rigid base pair
    that puts most into a mode puts in the pair's share s of the mode's kinetic energy (Cauchy and
    Schwarz), so the growth reaches a part x of the kick when √s (cosh(g t) - 1) = x.
    """
    negative = eigenvalues_per_ps2 < -EIGENVALUE_TOLERANCE_PER_PS2
    lowest = float(eigenvalues_per_ps2[0])
    if not negative.any():
        return Instability(0, lowest, np.inf)
    rates = np.sqrt(-eigenvalues_per_ps2[negative])
    atoms = vectors[:, negative] / np.repeat(np.sqrt(masses_Da), 3)[:, None]
    shapes = (bodies.velocity_map() @ atoms).T.reshape(len(rates), -1, 6)
    shares = np.sum(shapes * bodies.momenta(shapes), axis=2).max(axis=1)
    onset_ps = np.arccosh(1 + SPOILT / np.sqrt(shares)) / rates
    return Instability(len(rates), lowest, float(onset_ps.min()))
