"""The frame of every base of a trajectory: the standard frame fitted to its ring atoms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames, newton_step, planar_axes
from dnawaves.frames.standard import standard_ring
from dnawaves.frames.vectors import Array
from dnawaves.helical.bases import Base

# A frame has six degrees of freedom; two atoms fix five.
MINIMUM_ATOMS = 3


class BaseFit:
    """The least-squares fit of many bases at once, prepared for many frames of time.

    Centre and correlation of a base with its standard ring are sums over its atoms: one small
    matrix product for each base does them for all frames of a chunk.
    """

    def __init__(self, bases: Sequence[Base]) -> None:
        self._count = len(bases)
        self._centre = np.zeros((3, self._count, 1))
        self._fitted: list[tuple[int, slice, Array]] = []
        # Only rings that are not flat (G has N3 at z = 0.001 Å) need the Newton step.
        self._raised: list[tuple[int, slice, Array]] = []
        self._unknown: list[int] = []
        begin = 0
        for number, base in enumerate(bases):
            columns = slice(begin, begin + len(base.atoms))
            begin += len(base.atoms)
            if len(base.atoms) < MINIMUM_ATOMS:
                self._unknown.append(number)
                continue
            ring = standard_ring(base.letter)
            standard = np.array([ring[atom] for atom in base.atoms])
            centre = standard.mean(axis=0)
            self._centre[:, number, 0] = centre
            mean = np.full(len(standard), 1 / len(standard))
            self._fitted.append((number, columns, np.vstack([mean, (standard - centre).T[:2]])))
            heights = standard[:, 2] - centre[2]
            if heights.any():
                self._raised.append((number, columns, heights[np.newaxis]))

    def __call__(self, positions_A: NDArray[np.floating]) -> Frames:
        """Return the frames over (bases, times).

        `positions_A` is (times, atoms, 3), the bases' atoms one base after the other. A base with
        fewer than three ring atoms gets NaN.
        """
        times = len(positions_A)
        # (component, atoms, times), with the atoms of a frame side by side in memory.
        places = np.ascontiguousarray(positions_A.transpose(2, 0, 1), dtype=np.float64)
        places = places.swapaxes(1, 2)
        # (sum, component, bases, times): centre and the first two columns of the correlation.
        sums = np.empty((3, 3, self._count, times))
        sums[:, :, self._unknown] = np.nan
        for number, columns, weights in self._fitted:
            np.matmul(weights, places[:, columns], out=sums[:, :, number].swapaxes(0, 1))
        centre, *correlation = sums
        axes = planar_axes(correlation[0], correlation[1])
        if self._raised:
            raised = [number for number, _, _ in self._raised]
            of_raised = np.empty((3, 3, len(raised), times))
            of_raised[:2] = [part[:, raised] for part in correlation]
            for place, (_, columns, weights) in enumerate(self._raised):
                of_raised[2, :, place] = np.matmul(weights, places[:, columns])[:, 0]
            axes[:, :, raised] = newton_step(axes[:, :, raised], of_raised)
        for i in range(3):
            centre -= self._centre[i] * axes[i]
        return Frames(centre, axes)


def base_frames(positions_A: NDArray[np.floating], bases: Sequence[Base]) -> Frames:
    """Fit the frame of every base in every frame of time.

    `positions_A` is (times, atoms, 3), indexed by the bases' `indices`; the result runs over
    (bases, times). A base with fewer than three ring atoms gets NaN.
    """
    return BaseFit(bases)(positions_A[:, atom_indices(bases)])


def atom_indices(bases: Sequence[Base]) -> NDArray[np.int64]:
    """Return the indices of all ring atoms, one base after the other."""
    return np.concatenate([base.indices for base in bases])
