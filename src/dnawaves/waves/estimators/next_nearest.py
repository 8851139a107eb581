"""A chain whose springs reach two neighbours: the simplest lattice beyond nearest neighbours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.modal import ModalChain, free_pairs
from dnawaves.units import A_PER_NM
from dnawaves.waves.estimators.lattices import FRICTION, Likeness, ScalarLattice
from dnawaves.waves.estimators.sources import Respond

Array = NDArray[np.float64]

SHARE = "coupling_next_nearest"
SHARES = (-0.4, 0.0, 0.4)


@dataclass(frozen=True, eq=False)
class NextNearestLattice:
    """Extension or twist alone: speed of long waves, share of the springs to second neighbours.

    V^2 = (k1 + 4 k2) a^2/m, and the share is 4 k2/(k1 + 4 k2). Above zero short waves are faster
    than on the lattice of nearest neighbours, below it slower. Masses are 1.
    """

    pairs: int
    spacing_nm: float
    held: Sequence[int]
    respond: Respond
    pattern: Array
    names: tuple[str, ...] = ("speed_A_per_ps", SHARE, FRICTION)

    @property
    def moving(self) -> NDArray[np.bool_]:
        return free_pairs(self.pairs, self.held)

    @cached_property
    def springs(self) -> tuple[Array, Array]:
        """Stiffness of the chain of 1 Å/ps with springs to the nearest, to the next pair only."""
        unit = (1 / A_PER_NM / self.spacing_nm) ** 2
        steps = [np.eye(self.pairs, k=k)[:-k] - np.eye(self.pairs)[:-k] for k in (1, 2)]
        return unit * steps[0].T @ steps[0], unit / 4 * steps[1].T @ steps[1]

    @cached_property
    def nearest(self) -> ScalarLattice:
        """The lattice of nearest neighbours alone, which tells where to start."""
        return ScalarLattice(self.pairs, self.spacing_nm, self.held, self.respond, self.pattern)

    def starts(self, likeness: Likeness) -> list[dict[str, float]]:
        nearest = self.nearest.starts(likeness)
        return [start | {SHARE: share} for start in nearest for share in SHARES]

    def velocity(self, values: Mapping[str, float]) -> Array | None:
        first, second = self.springs
        share = values[SHARE]
        stiffness = values["speed_A_per_ps"] ** 2 * ((1 - share) * first + share * second)
        try:
            chain = ModalChain(stiffness, np.ones(self.pairs), self.moving, zero_mode=1e-10)
        except InputError:
            return None
        return self.respond(chain, self.pattern, values[FRICTION])[:, self.moving]
