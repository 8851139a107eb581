"""All parameters and frames of many base pairs over a chunk of frames of time."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.helix import helix_of_steps
from dnawaves.frames.parameters import (
    RigidBodyParameters,
    pair_parameters,
    rigid_body_parameters,
)
from dnawaves.frames.standard import standard_place, standard_ring
from dnawaves.frames.vectors import dot
from dnawaves.helical.bases import Base
from dnawaves.helical.flags import (
    ATOMS_MISSING,
    NO_FRAME,
    NO_HELICAL_AXIS,
    NOT_CONSECUTIVE,
    OPEN,
    OPPOSED,
    PARALLEL,
    Z_FORM,
)
from dnawaves.helical.form import LONGEST_BOND_A, BasePair, turned_over
from dnawaves.helical.frames import MINIMUM_ATOMS, BaseFit, atom_indices
from dnawaves.helical.imaging import Imaging
from dnawaves.helical.pairs import ABSURD_A

Arrays = dict[str, NDArray[np.generic]]

# Bases times frames of time that are worked on together: enough that the cost of calling numpy
# is small, few enough that a chunk takes some 50 MB.
_CHUNK = 48_000
_TEMPORARIES_BYTES = 30 * 2**20


class Duplexes:
    """Base pairs of one or more duplexes, prepared for many frames of time.

    `indices` are the atoms to read, in this order; `chunk` is how many frames of time to give at
    once. Without `keep_frames` the result has parameters and flags only: a quarter of the memory.
    """

    def __init__(self, pairs: Sequence[BasePair], keep_frames: bool = True) -> None:
        if not pairs:
            raise InputError("no base pairs were given")
        self._keep_frames = keep_frames
        self.pairs = tuple(pairs)
        count = len(pairs)
        self.bases = [pair.first for pair in pairs] + [pair.second for pair in pairs]
        self.indices = atom_indices(self.bases)
        self.chunk = max(1, _CHUNK // len(self.bases))
        self._fit = BaseFit(self.bases)
        duplex = np.array([pair.duplex for pair in pairs])
        # The first pair of each step; the second is the next one.
        self.steps = np.flatnonzero(duplex[1:] == duplex[:-1])
        self._image = Imaging(
            [len(base.atoms) for base in self.bases],
            [max(0, n - int(n > 0 and duplex[n] == duplex[n - 1])) for n in range(count)]
            + list(range(count)),
            range(2 * count),
        )
        self._parallel = np.array([pair.parallel for pair in pairs])
        self._half_turned = np.array([pair.half_turned for pair in pairs])
        self._z_form = np.array([pair.z_form for pair in pairs])
        self._closing = [
            np.array(
                [
                    standard_place(getattr(pair, strand).letter, pair.closing_atoms[n])
                    for pair in pairs
                ]
            ).T[..., None]
            for n, strand in enumerate(("first", "second"))
        ]
        self._pair_flag, self._step_flag = self._lasting_flags()
        warn_of_missing_atoms(self.pairs)

    def bytes_per_time(self) -> int:
        """Return the size of the result for one frame of time."""
        return sum(kind.itemsize * math.prod(shape) for shape, kind in self._shapes().values())

    def views(self, memory: NDArray[np.uint8], times: int) -> Arrays:
        """Return the arrays of the result, time last, as views of `memory` (bytes,)."""
        arrays: Arrays = {}
        end = 0
        for name, (shape, kind) in self._shapes().items():
            begin, end = end, end + kind.itemsize * math.prod(shape) * times
            arrays[name] = memory[begin:end].view(kind).reshape(*shape, times)
        return arrays

    def _shapes(self) -> dict[str, tuple[tuple[int, ...], np.dtype[np.generic]]]:
        """Return shape (without time) and type of each array of the result."""
        pairs, steps = len(self.pairs), len(self.steps)
        shapes: dict[str, tuple[int, ...]] = {
            "pair_parameters": (6, pairs),
            "step_parameters": (6, steps),
            "helix_parameters": (6, steps),
        }
        if self._keep_frames:
            for name, count in (("base_", 2 * pairs), ("", pairs), ("step_", steps)):
                shapes |= {f"{name}origin": (3, count), f"{name}axes": (3, 3, count)}
        real, byte = np.dtype(np.float64), np.dtype(np.uint8)
        # Bytes last, where they leave the numbers before them aligned.
        return {name: (shape, real) for name, shape in shapes.items()} | {
            "pair_flag": ((pairs,), byte),
            "step_flag": ((steps,), byte),
        }

    def __call__(
        self,
        positions_A: NDArray[np.floating],
        boxes: NDArray[np.floating] | None = None,
        frames: Sequence[int] | NDArray[np.int64] | None = None,
    ) -> Arrays:
        """Return the arrays of the result, time last, for positions (times, atoms, 3) of `indices`.

        `boxes` (times, 6) are lengths in Å and angles in degrees; `frames` numbers the times for
        messages. Raises `InputError` where most pairs are absurdly far apart.
        """
        count = len(self.pairs)
        bases = self._fit(self._image(positions_A, boxes))
        first, second = _part(bases, slice(count)), _part(bases, slice(count, None))
        in_pairs = pair_parameters(first, turned_over(second, self._parallel))
        self._refuse_apart(in_pairs.values, bases.origin, frames)
        pairs = in_pairs.middle
        if self._half_turned.any():
            _count_from_zero(in_pairs, self._half_turned)
        if self._z_form.any():
            pairs.axes[::2, :, self._z_form] *= -1
        here, there = _part(pairs, self._at(0)), _part(pairs, self._at(1))
        in_steps = rigid_body_parameters(here, there)
        in_helix, unrotated = helix_of_steps(in_steps.values)
        closing = first.origin - second.origin
        # Ring nitrogens lie in the plane of their base.
        for i in range(2):
            closing += self._closing[0][i] * first.axes[i]
            closing -= self._closing[1][i] * second.axes[i]
        is_open = dot(closing, closing) > LONGEST_BOND_A**2
        return {
            "pair_parameters": in_pairs.values,
            "step_parameters": in_steps.values,
            "helix_parameters": in_helix,
            "pair_flag": _flags(self._pair_flag, in_pairs.values, in_pairs.opposed, is_open),
            "step_flag": _flags(
                self._step_flag,
                in_steps.values,
                in_steps.opposed,
                is_open[self._at(0)] | is_open[self._at(1)],
                unrotated,
            ),
            "base_origin": bases.origin,
            "base_axes": bases.axes,
            "origin": pairs.origin,
            "axes": pairs.axes,
            "step_origin": in_steps.middle.origin,
            "step_axes": in_steps.middle.axes,
        }

    def _at(self, later: int) -> slice | NDArray[np.int64]:
        """Return which pairs begin (0) or end (1) the steps."""
        if len(self.steps) == len(self.pairs) - 1:
            return slice(later, len(self.steps) + later)
        return self.steps + later

    def _lasting_flags(self) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        pair_flag = np.array(
            [
                ATOMS_MISSING * any(_missing(base) for base in (pair.first, pair.second))
                | Z_FORM * pair.z_form
                | PARALLEL * pair.parallel
                for pair in self.pairs
            ],
            dtype=np.uint8,
        )
        broken = [NOT_CONSECUTIVE * (not self.pairs[step + 1].joined) for step in self.steps]
        step_flag = pair_flag[self.steps] | pair_flag[self.steps + 1]
        return pair_flag, step_flag | np.array(broken, dtype=np.uint8)

    def _refuse_apart(
        self,
        values: NDArray[np.float64],
        origins_A: NDArray[np.float64],
        frames: Sequence[int] | NDArray[np.int64] | None,
    ) -> None:
        far = dot(values, values) > ABSURD_A**2
        if not far.any():
            return
        times = np.flatnonzero(far.any(axis=0))
        joined = np.array([pair.joined for pair in self.pairs], dtype=bool)
        steps = self.steps[joined[self.steps + 1]]
        here = np.concatenate([steps, steps + len(self.pairs)])
        chain_A = origins_A[:, here + 1][..., times] - origins_A[:, here][..., times]
        # Strands that melt are whole; those that jump to another image are torn, or all apart.
        torn = (dot(chain_A, chain_A) > ABSURD_A**2).any(axis=0)
        apart = times[torn | (2 * far[:, times].sum(axis=0) > len(self.pairs))]
        if len(apart):
            number = int(apart[0]) if frames is None else int(frames[apart[0]])
            raise InputError(
                f"frame {number}: the strands do not lie side by side: bases are over"
                f" {ABSURD_A:g} Å from their partners, more than half of them or with a jump in"
                " the chain; make the molecules whole in one periodic image (or give the file its"
                " box), or end before the strands part"
            )


def _count_from_zero(pairs: RigidBodyParameters, which: NDArray[np.bool_]) -> None:
    """Count opening from 0 to 360 degrees in some pairs: turn their frames where it is negative."""
    sign = np.where(which[:, None] & (pairs.values[5] < 0), -1.0, 1.0)
    pairs.values[[0, 1, 3, 4]] *= sign
    pairs.values[5] += np.where(sign < 0, 360.0, 0.0)
    pairs.middle.axes[:2] *= sign


def keep_freed_memory() -> None:
    """Let glibc keep what numpy frees: the temporaries of a chunk would otherwise be mapped and
    cleared by the kernel each time, which costs as much as the arithmetic.

    A freed block raises malloc's thresholds to its size; elsewhere this does nothing.
    """
    np.empty(_TEMPORARIES_BYTES, dtype=np.uint8)


def warn_of_missing_atoms(pairs: Sequence[BasePair]) -> None:
    """Warn of each base that lacks ring atoms."""
    for pair in pairs:
        for base in (pair.first, pair.second):
            missing = _missing(base)
            if missing:
                outcome = "fitted to the rest" if len(base.atoms) >= MINIMUM_ATOMS else "undefined"
                warnings.warn(
                    f"base {base.letter} {base.label} lacks {', '.join(sorted(missing))}:"
                    f" its frame is {outcome}",
                    stacklevel=4,
                )


def _missing(base: Base) -> set[str]:
    return set(standard_ring(base.letter)) - set(base.atoms)


def _part(frames: Frames, which: slice | NDArray[np.int64]) -> Frames:
    return Frames(frames.origin[:, which], frames.axes[:, :, which])


def _flags(
    lasting: NDArray[np.uint8],
    values: NDArray[np.float64],
    opposed: NDArray[np.bool_],
    is_open: NDArray[np.bool_],
    unrotated: NDArray[np.bool_] | None = None,
) -> NDArray[np.uint8]:
    undefined = np.isnan(values[0])
    flags = lasting[:, None] | np.multiply(is_open, OPEN, dtype=np.uint8)
    flags |= np.multiply(undefined & ~opposed, NO_FRAME, dtype=np.uint8)
    flags |= np.multiply(opposed, OPPOSED, dtype=np.uint8)
    if unrotated is not None:
        flags |= np.multiply(unrotated, NO_HELICAL_AXIS, dtype=np.uint8)
    return flags
