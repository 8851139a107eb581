"""Lattices as models of a record: parameters in, velocities of the moving channels out.

The shape of a wave, its dispersion, its reflections and its source are the lattice's own; only
parameters that belong to the molecule are free. No parameter is bounded by an expected value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.chain import FiniteChain, PlaneChain, ScalarChain
from dnawaves.rod.modal import ModalChain
from dnawaves.rod.rod import Rod
from dnawaves.waves.estimators.sources import Respond

Array = NDArray[np.float64]

# How much of the data (0..1) each of many answers (answer, time, channel) explains.
Likeness = Callable[[Array], Array]

FRICTION = "friction_per_ps"
# Steps of 2 %: a pulse that crosses 24 base pairs twice shifts by less than its width.
SPEEDS_A_PER_PS = np.geomspace(2.0, 50.0, 160)
COARSE_SPEEDS_A_PER_PS = np.geomspace(2.0, 50.0, 20)
FRICTIONS_PER_PS = (0.02, 0.5)
COUPLINGS = (-0.3, 0.0, 0.3)
LIKELIEST = 4


class Lattice(Protocol):
    """A model: its parameters by name, values to start from, and its answer.

    `velocity` returns (time, channel), the moving channels in the order of the flattened field,
    or None where no such lattice exists. Names that begin with "coupling" are correlations of
    two stiffnesses, in -1..1; friction is not negative; all others are positive.
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def moving(self) -> NDArray[np.bool_]: ...

    def starts(self, likeness: Likeness) -> list[dict[str, float]]: ...

    def velocity(self, values: Mapping[str, float]) -> Array | None: ...


@dataclass(frozen=True, eq=False)
class ScalarLattice:
    """Extension or twist alone: speed and friction of a uniform chain.

    `pattern` (pair,) is the source's; masses are 1, so that a force is an acceleration.
    """

    pairs: int
    spacing_nm: float
    held: Sequence[int]
    respond: Respond
    pattern: Array
    names: tuple[str, ...] = ("speed_A_per_ps", FRICTION)

    @cached_property
    def chain(self) -> ScalarChain:
        """The chain of 1 Å/ps."""
        return ScalarChain.from_speed(self.pairs, 1.0, self.spacing_nm, self.held)

    @property
    def moving(self) -> NDArray[np.bool_]:
        return self.chain.free

    @cached_property
    def searched(self) -> list[dict[str, float]]:
        """Everywhere that a fit starts from."""
        return [
            {"speed_A_per_ps": float(speed), FRICTION: friction}
            for friction in FRICTIONS_PER_PS
            for speed in SPEEDS_A_PER_PS
        ]

    @cached_property
    def answers(self) -> Array:
        """The answers (searched, time, channel) there: they do not depend on the data."""
        return np.array([self.velocity(values) for values in self.searched])

    def starts(self, likeness: Likeness) -> list[dict[str, float]]:
        return [self.searched[i] for i in _peaks(likeness(self.answers), len(SPEEDS_A_PER_PS))]

    def velocity(self, values: Mapping[str, float]) -> Array:
        chain = self.chain.scaled(values["speed_A_per_ps"])
        return self.respond(chain, self.pattern, values[FRICTION])[:, self.moving]


@dataclass(frozen=True, eq=False)
class AxialLattice:
    """Extension and twist of a straight uniform chain, coupled; fields (pair, 2), nm and rad.

    The 2x2 problem of one wavenumber has the same two polarisations at all of them, so that the
    chain is two scalar ones. Speeds are the uncoupled ones, sqrt(K33/m) and sqrt(K66/I), coupling
    is K36/sqrt(K33 K66). `masses` are m, Da, and I, Da nm^2, of a base pair. The pattern is one of
    velocities, or of forces (kJ/mol/nm, kJ/mol) if `forced`.
    """

    pairs: int
    spacing_nm: float
    held: Sequence[int]
    respond: Respond
    pattern: Array
    masses: tuple[float, float]
    forced: bool = False
    names: tuple[str, ...] = (
        "extension_A_per_ps",
        "twist_A_per_ps",
        "coupling_extension_twist",
        FRICTION,
    )

    @cached_property
    def chain(self) -> ScalarChain:
        """The scalar chain of 1 Å/ps."""
        return ScalarChain.from_speed(self.pairs, 1.0, self.spacing_nm, self.held)

    @property
    def moving(self) -> NDArray[np.bool_]:
        return np.repeat(self.chain.free[:, np.newaxis], 2, axis=1)

    @cached_property
    def answers(self) -> list[Array | None]:
        """Answers (speed, time, channel) of extension alone and of twist alone, where kicked."""
        alone = [
            replace(self, pattern=self.pattern * np.eye(2)[axis])
            if self.pattern[:, axis].any()
            else None
            for axis in range(2)
        ]
        return [
            np.array(
                [lattice.velocity(self._values(speed, speed, 0.0)) for speed in SPEEDS_A_PER_PS]
            )
            if lattice is not None
            else None
            for lattice in alone
        ]

    def starts(self, likeness: Likeness) -> list[dict[str, float]]:
        speeds = [
            COARSE_SPEEDS_A_PER_PS
            if answers is None
            else SPEEDS_A_PER_PS[_peaks(likeness(answers), len(SPEEDS_A_PER_PS))]
            for answers in self.answers
        ]
        return [self._values(v, w, r) for v in speeds[0] for w in speeds[1] for r in COUPLINGS]

    def _values(self, extension: float, twist: float, coupling: float) -> dict[str, float]:
        values = (float(extension), float(twist), coupling, FRICTIONS_PER_PS[0])
        return dict(zip(self.names, values, strict=True))

    def velocity(self, values: Mapping[str, float]) -> Array | None:
        extension, twist, coupling, friction = (values[name] for name in self.names)
        cross = coupling * extension * twist
        squared, vectors = np.linalg.eigh([[extension**2, cross], [cross, twist**2]])
        if squared[0] <= 0:
            return None
        root = np.sqrt(np.array(self.masses))
        loads = (self.pattern / root if self.forced else self.pattern * root) @ vectors
        answers = [
            self.respond(self.chain.scaled(float(np.sqrt(square))), load, friction)
            for square, load in zip(squared, loads.T, strict=True)
        ]
        fields = np.stack(answers, axis=-1) @ vectors.T / root
        return fields[:, self.chain.free].reshape(len(fields), -1)


@dataclass(frozen=True, eq=False)
class RodLattice:
    """The full lattice of six coordinates, or of one plane, with some stiffness entries free.

    Parameters
    ----------
    rod : Rod
        The constants that are not free, and the first of the starts.
    free : mapping
        Name to entries (i, j) of the stiffness: of a diagonal one the name's value is the factor
        on the rod's, of an off-diagonal one K_ij/sqrt(K_ii K_jj); the name must then begin with
        "coupling".
    plane : bool
        Bend and shear in one plane of an untwisted rod, fields (pair, 2).
    """

    rod: Rod
    pairs: int
    held: Sequence[int]
    respond: Respond
    pattern: Array
    free: Mapping[str, Sequence[tuple[int, int]]]
    plane: bool = False
    mass_blocks: Array | None = None
    factors: Sequence[float] = (0.3, 0.6, 1.0, 1.7, 3.0)
    # Of the latest stiffness: friction, and scenes that share it (`replace`), need no other. With
    # what the key knows by identity, which lives as long as its entry.
    _last: dict[tuple[object, ...], tuple[ModalChain | None, object]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, entries in self.free.items():
            if name.startswith("coupling") != all(i != j for i, j in entries):
                raise InputError(
                    f"free stiffness '{name}': couplings, and only they, are off the diagonal"
                )

    @property
    def names(self) -> tuple[str, ...]:
        return (*self.free, FRICTION)

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        return self.solve({name: self._of_rod(name) for name in self.free}).free

    def starts(self, likeness: Likeness) -> list[dict[str, float]]:
        return [
            {
                name: self._of_rod(name) * (1 if name.startswith("coupling") else factor)
                for name in self.free
            }
            | {FRICTION: FRICTIONS_PER_PS[0]}
            for factor in self.factors
        ]

    def _of_rod(self, name: str) -> float:
        if not name.startswith("coupling"):
            return 1.0
        i, j = self.free[name][0]
        K = self.rod.stiffness
        return float(K[i, j] / np.sqrt(K[i, i] * K[j, j]))

    def stiffness(self, values: Mapping[str, float]) -> Array:
        """Return the 6x6 stiffness in the units of `Rod`."""
        K = np.array(self.rod.stiffness)
        scale = np.sqrt(np.diag(K))
        unit = K / np.outer(scale, scale)
        for name, entries in self.free.items():
            for i, j in entries:
                if i == j:
                    scale[i] *= np.sqrt(values[name])
                else:
                    unit[i, j] = unit[j, i] = values[name]
        return unit * np.outer(scale, scale)

    def solve(self, values: Mapping[str, float]) -> ModalChain:
        """Return the chain of these values; raises InputError where it would not be stable."""
        changed = replace(self.rod, stiffness=self.stiffness(values))
        if self.plane:
            return PlaneChain(changed, self.pairs, self.held)
        return FiniteChain(changed, self.pairs, self.held, self.mass_blocks)

    def velocity(self, values: Mapping[str, float]) -> Array | None:
        stiffness = tuple(self.stiffness(values).ravel())
        model = (self.pairs, tuple(self.held), self.plane, id(self.rod), id(self.mass_blocks))
        key = (*model, *stiffness)
        if key not in self._last:
            self._last.clear()
            try:
                solved = self.solve(values)
            except InputError:
                solved = None
            self._last[key] = solved, (self.rod, self.mass_blocks)
        chain, _ = self._last[key]
        if chain is None:
            return None
        return self.respond(chain, self.pattern, values[FRICTION])[:, chain.free]


def _peaks(likeness: Array, row: int) -> Array:
    """Return the largest local maxima of rows of likenesses, as indices of the whole."""
    rows = np.pad(likeness.reshape(-1, row), ((0, 0), (1, 1)), constant_values=-1.0)
    inner = rows[:, 1:-1]
    at = np.flatnonzero((inner >= rows[:, :-2]) & (inner > rows[:, 2:]))
    order = np.argsort(-likeness[at])
    return np.asarray(at[order[:LIKELIEST]])
