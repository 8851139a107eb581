"""Bend and shear in one plane as a model of a record: Timoshenko's beam on the lattice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.chain import PlaneChain
from dnawaves.rod.modal import ModalChain, free_pairs
from dnawaves.rod.rod import Rod
from dnawaves.units import A_PER_NM
from dnawaves.waves.estimators.lattices import FRICTION, FRICTIONS_PER_PS, LIKELIEST, Likeness
from dnawaves.waves.estimators.sources import Respond

Array = NDArray[np.float64]

# Both speeds of the starts: everything that a wave in a molecule might have.
SPEEDS_A_PER_PS = np.geomspace(2.0, 50.0, 10)
# Of the largest squared frequency: rigid motions of a free chain lie below it.
RIGID = 1e-10


@dataclass(frozen=True, eq=False)
class PlaneLattice:
    """Shear displacement (nm) and bend angle (rad) of a straight uniform chain, fields (pair, 2).

    Parameters are the speeds of short waves, sqrt(C/rho) and sqrt(D/I), and the friction. The
    pattern is one of velocities, or of accelerations if `forced`; `masses` are those of a base
    pair: Da, and Da nm^2 about the axis across the plane.
    """

    pairs: int
    spacing_nm: float
    held: Sequence[int]
    respond: Respond
    pattern: Array
    masses: tuple[float, float]
    forced: bool = False
    names: tuple[str, ...] = ("shear_A_per_ps", "bend_A_per_ps", FRICTION)

    @property
    def moving(self) -> NDArray[np.bool_]:
        return np.repeat(free_pairs(self.pairs, self.held)[:, np.newaxis], 2, axis=1)

    @cached_property
    def stiffnesses(self) -> tuple[Array, Array]:
        """The chain's stiffness for a speed of 1 Å/ps of shear alone, and of bend alone."""
        one, double = (self._chain_stiffness(bend) for bend in (1.0, 2.0))
        return 2 * one - double, double - one

    def _chain_stiffness(self, bend: float) -> Array:
        density, inertia = (mass / self.spacing_nm for mass in self.masses)
        square = A_PER_NM**-2
        shear, tilt = density * square, inertia * square * bend
        stiffness = np.diag([shear, shear, shear, tilt, tilt, tilt])
        rod = Rod(density, inertia * np.eye(3), stiffness, self.spacing_nm)
        return PlaneChain(rod, self.pairs, self.held).stiffness

    @cached_property
    def searched(self) -> list[dict[str, float]]:
        """Everywhere that a fit starts from."""
        return [
            dict(zip(self.names, (float(v), float(w), FRICTIONS_PER_PS[0]), strict=True))
            for v in SPEEDS_A_PER_PS
            for w in SPEEDS_A_PER_PS
        ]

    @cached_property
    def answers(self) -> Array:
        """The answers (searched, time, channel) there: they do not depend on the data."""
        return np.array([self.velocity(values) for values in self.searched])

    def starts(self, likeness: Likeness) -> list[dict[str, float]]:
        likeliest = np.argsort(-likeness(self.answers))[:LIKELIEST]
        return [self.searched[int(i)] for i in likeliest]

    def velocity(self, values: Mapping[str, float]) -> Array | None:
        shear, bend = self.stiffnesses
        total = values["shear_A_per_ps"] ** 2 * shear + values["bend_A_per_ps"] ** 2 * bend
        mass = np.tile(self.masses, self.pairs)
        try:
            chain = ModalChain(total, mass, self.moving, zero_mode=RIGID)
        except InputError:
            return None
        pattern = self.pattern * self.masses if self.forced else self.pattern
        return self.respond(chain, pattern, values[FRICTION])[:, self.moving]
