"""Bases in one periodic image: what a wrapped trajectory needs before frames are fitted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from MDAnalysis.lib.mdamath import triclinic_vectors
from numpy.typing import NDArray

Boxes = NDArray[np.floating]


class Imaging:
    """Lays every atom beside its base's first one, and every base beside the one it hangs on.

    `sizes` are the bases' numbers of atoms; `anchors` holds for each base the number of the base
    that it is laid beside, itself for none, always one that comes earlier in `order`.
    """

    def __init__(self, sizes: Sequence[int], anchors: Sequence[int], order: Sequence[int]) -> None:
        self._base_of_atom = np.repeat(np.arange(len(sizes)), sizes)
        begins = np.cumsum([0, *sizes[:-1]])
        # A base without atoms has no place of its own: it takes that of its anchor.
        self._first_atom = np.zeros(len(sizes), dtype=np.int64)
        for base in order:
            self._first_atom[base] = (
                begins[base] if sizes[base] else self._first_atom[anchors[base]]
            )
        self._anchors = np.asarray(anchors)
        self._order = list(order)

    def __call__(
        self, positions_A: NDArray[np.floating], boxes: Boxes | None
    ) -> NDArray[np.floating]:
        """Return positions (times, atoms, 3) made whole; `boxes` are lengths and angles (times, 6).

        Every distance from an atom or base to the one it is laid beside has to be below half the
        box's smallest width. Times without a box (`boxes` None, or a length of 0) stay as they are.
        """
        if boxes is None or not np.all(boxes[:, :3] > 0, axis=1).any():
            return positions_A
        boxed = np.flatnonzero(np.all(boxes[:, :3] > 0, axis=1))
        vectors = np.array([triclinic_vectors(boxes[time]) for time in boxed], dtype=np.float64)
        inverse = np.linalg.inv(vectors)
        positions = positions_A[boxed]
        first = self._without_gaps(positions[:, self._first_atom])
        of_atoms = _images(positions - first[:, self._base_of_atom], inverse)
        of_bases = _images(first - first[:, self._anchors], inverse)
        for base in self._order:
            if self._anchors[base] != base:
                of_bases[:, base] += of_bases[:, self._anchors[base]]
        of_atoms += of_bases[:, self._base_of_atom]
        if not of_atoms.any():
            return positions_A
        whole = positions_A.astype(np.float64)
        whole[boxed] += of_atoms @ vectors
        return whole

    def _without_gaps(self, first_A: NDArray[np.floating]) -> NDArray[np.floating]:
        """Give a base at NaN (times, bases, 3) a neighbour's place, so that others can hang on it.

        That of its anchor, or where nothing before it is known, of a base that hangs on it.
        """
        if not np.isnan(first_A).any():
            return first_A
        hung = [base for base in self._order if self._anchors[base] != base]
        links = [(base, self._anchors[base]) for base in hung]
        for base, other in links + [(anchor, base) for base, anchor in reversed(links)]:
            gap = np.isnan(first_A[:, base]).any(axis=1)
            first_A[gap, base] = first_A[gap, other]
        return np.nan_to_num(first_A)


def _images(between_A: NDArray[np.floating], inverse: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return how many box vectors bring vectors (times, n, 3) to their shortest."""
    return np.asarray(-np.round(between_A @ inverse), dtype=np.float64)
