"""What is decided once for a whole trajectory: the form of each base pair.

Source: 3DNA, Lu & Olson (2003) Nucleic Acids Res. 31, 5108-5121.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames
from dnawaves.frames.parameters import RigidBodyParameters, pair_parameters
from dnawaves.helical.bases import Base
from dnawaves.helical.geometry import Bases

# The longest hydrogen bond of 3DNA, Lu & Olson (2008) Nat. Protoc. 3, 1213.
LONGEST_BOND_A = 4.0


@dataclass(frozen=True, eq=False)
class BasePair:
    """Two paired bases, of strand I and strand II, and what holds for them at all times.

    `duplex` counts from 0; `joined`: the backbone runs on from the pair before in both strands;
    `parallel`: z of both bases point the same way (M+N in 3DNA), so strand II's is not reversed;
    `half_turned`: such a pair with an opening near 180 degrees, which is counted from 0 to 360,
    as +180 and -180 would give frames half a turn apart;
    `z_form`: z opposes strand I's direction, so x and z of the pair are reversed; `bond`: the ring
    atoms between which a hydrogen bond closes the pair.
    """

    first: Base
    second: Base
    duplex: int = 0
    joined: bool = True
    parallel: bool = False
    half_turned: bool = False
    z_form: bool = False
    bond: tuple[str, str] | None = None

    @property
    def label(self) -> str:
        """The pair as "A:1-B:24"."""
        return f"{self.first.label}-{self.second.label}"

    @property
    def sequence(self) -> str:
        """The pair's letters as "C-G"."""
        return f"{self.first.letter}-{self.second.letter}"

    @property
    def closing_atoms(self) -> tuple[str, str]:
        """The atoms of `bond`; Watson-Crick's N1 of purines and N3 of pyrimidines by default."""
        return self.bond or (_edges(self.first)[0], _edges(self.second)[0])


def decide_forms(
    bases: Bases, duplexes: Sequence[Sequence[tuple[int, int]]], joined: NDArray[np.bool_]
) -> tuple[BasePair, ...]:
    """Return the base pairs of all duplexes, with their forms as they are now.

    `joined` tells of each base whether the backbone runs on to the next. Only pairs whose bases
    face each other tell their own form. Others are parallel where most of their duplex are, and
    in the Z form where the nearest pair that tells is: a duplex may be part B, part Z.
    """
    pairs: list[BasePair] = []
    for number, duplex in enumerate(duplexes):
        first, second = (list(column) for column in zip(*duplex, strict=True))
        closed = bases.face(first, second)
        z = bases.frames.axes[2]
        parallel = _by_majority((z[:, first] * z[:, second]).sum(axis=0) > 0, closed)
        in_pairs = _pair_parameters(bases, first, second, parallel)
        half_turned = parallel & (np.abs(in_pairs.values[5]) > 90)
        z_form = _as_nearest(_opposes_strand(bases, first, in_pairs.middle.axes[2], closed), closed)
        for place, (one, other) in enumerate(duplex):
            before = duplex[place - 1] if place else None
            pairs.append(
                BasePair(
                    bases.bases[one],
                    bases.bases[other],
                    number,
                    before is None
                    or (_runs_on(before[0], one, joined) and _runs_on(before[1], other, joined)),
                    bool(parallel[place]),
                    bool(half_turned[place]),
                    bool(z_form[place]),
                    _closing_atoms(bases, one, other),
                )
            )
    return tuple(pairs)


def turned_over(frames: Frames, which: NDArray[np.bool_]) -> Frames:
    """Return frames (bases, ...) with y and z reversed where `which` (bases,) says so."""
    if not which.any():
        return frames
    axes = frames.axes.copy()
    axes[1:, :, which] *= -1
    return Frames(frames.origin, axes)


def _by_majority(decided: NDArray[np.bool_], tells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    usual = bool(decided[tells].mean() > 0.5) if tells.any() else False
    return np.where(tells, decided, usual)


def _pair_parameters(
    bases: Bases, first: list[int], second: list[int], parallel: NDArray[np.bool_]
) -> RigidBodyParameters:
    strand_I, strand_II = (
        Frames(bases.frames.origin[:, part], bases.frames.axes[:, :, part])
        for part in (first, second)
    )
    return pair_parameters(strand_I, turned_over(strand_II, parallel))


def _as_nearest(decided: NDArray[np.bool_], tells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return what the nearest of those that tell decide; of two as near, the one before."""
    telling = np.flatnonzero(tells)
    if not len(telling):
        return np.zeros_like(decided)
    away = np.abs(np.arange(len(decided))[:, None] - telling)
    return np.asarray(decided[telling[away.argmin(axis=1)]])


def _opposes_strand(
    bases: Bases, first: list[int], z: NDArray[np.float64], closed: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return where z of a closed pair (3, pairs) points against strand I's 5' to 3' direction.

    The direction is that from the closed pair before to the closed pair after: the base of an
    open one may be anywhere, or without a frame. False where no other pair is closed.
    """
    origin = bases.frames.origin[:, first].T
    known = np.flatnonzero(np.isfinite(origin).all(axis=1))
    # Summed up from base to base, as a box may be narrower than the way over many open ones.
    steps = bases.between(origin[known[:-1]], origin[known[1:]])
    path = np.full_like(origin, np.nan)
    path[known] = np.cumsum(np.vstack([np.zeros((min(1, len(known)), 3)), steps]), axis=0)
    opposes = np.zeros(len(first), dtype=bool)
    telling = np.flatnonzero(closed)
    for number, place in enumerate(telling):
        before, after = telling[max(0, number - 1)], telling[min(len(telling) - 1, number + 1)]
        opposes[place] = z[:, place] @ (path[after] - path[before]) < 0
    return opposes


def _runs_on(here: int, there: int, joined: NDArray[np.bool_]) -> bool:
    return abs(here - there) == 1 and bool(joined[min(here, there)])


def _closing_atoms(bases: Bases, one: int, other: int) -> tuple[str, str]:
    """Return the closest ring nitrogens of two bases if they bond, else those of Watson-Crick."""
    edges = list(product(_edges(bases.bases[one]), _edges(bases.bases[other])))
    starts = np.array([bases.place(one, atom) for atom, _ in edges])
    ends = np.array([bases.place(other, atom) for _, atom in edges])
    lengths_A = np.linalg.norm(bases.between(starts, ends), axis=1)
    bonded = np.flatnonzero(lengths_A <= LONGEST_BOND_A)
    if not len(bonded) or bonded[0] == 0:
        return edges[0]
    return edges[int(bonded[np.argmin(lengths_A[bonded])])]


def _edges(base: Base) -> tuple[str, ...]:
    """Return the ring nitrogens that bond, that of the Watson-Crick edge first."""
    return ("N1", "N7") if base.purine else ("N3",)
