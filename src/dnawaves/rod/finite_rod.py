"""Exact modes of a continuous rod of finite length, with free, held or pinned ends.

The rod between two points is described by its dynamic stiffness: the forces at its ends per
displacement of its ends at a frequency. The number of modes below a frequency follows from the
signs of its eigenvalues (Wittrick & Williams, Q. J. Mech. Appl. Math. 24, 263 (1971)), so that
bisection finds every mode, once each, also where several branches propagate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.rod import BEND_2, EXTENSION, SHEAR_1, TWIST, FloatArray, Rod

End = Literal["free", "held", "pinned"]
IntArray = NDArray[np.int64]

# coordinates of the motions that a straight rod without couplings keeps apart
COORDINATE_SETS: dict[str, tuple[int, ...]] = {
    "extension": (EXTENSION,),
    "twist": (TWIST,),
    "bend": (SHEAR_1, BEND_2),
    "all": tuple(range(6)),
}
# The rod is joined from two unequal parts: a mode with a node at the joint has to be seen
# elsewhere, and symmetric modes have theirs at simple fractions of the length.
JOINT = (np.sqrt(5) - 1) / 2
# halvings of a bracket: beyond the digits of a number
BISECTIONS = 52


@dataclass(frozen=True)
class FiniteRod:
    """A uniform rod of finite length.

    Parameters
    ----------
    rod : Rod
    length_nm : float
    ends : two of "free", "held", "pinned"
        Held: neither position nor rotation change; pinned: the position does not.
    coordinates : sequence of int
        Those that move: all six, or a set of `COORDINATE_SETS`.

    Raises
    ------
    InputError
        If the length is not positive, an end is unknown, or the coordinates are coupled to others.
    """

    rod: Rod
    length_nm: float
    ends: tuple[End, End]
    coordinates: Sequence[int] = COORDINATE_SETS["all"]

    def __post_init__(self) -> None:
        if not (np.isfinite(self.length_nm) and self.length_nm > 0):
            raise InputError(f"the rod's length is {self.length_nm} nm; it must be positive")
        unknown = [end for end in self.ends if end not in ("free", "held", "pinned")]
        if unknown or len(self.ends) != 2:
            raise InputError(f"ends {self.ends}: a rod has two, each free, held or pinned")
        inside = np.isin(np.arange(6), self.coordinates)
        for matrix in (self.rod.stiffness, self.rod.mass, self.rod.connection):
            across = (
                np.abs(matrix[np.ix_(inside, ~inside)]),
                np.abs(matrix[np.ix_(~inside, inside)]),
            )
            if max(part.max(initial=0) for part in across) > 1e-9 * np.abs(matrix).max():
                raise InputError(
                    f"the coordinates {list(self.coordinates)} are coupled to others; "
                    "see Rod.averaged_about_axis for the straight, untwisted rod"
                )

    @property
    def zero_modes(self) -> int:
        """Number of rigid motions that the ends allow."""
        connection = self._part(self.rod.connection)
        rigid = scipy.linalg.expm(-self.length_nm * connection)
        start, stop = self._fixed_ends()
        constraints = np.concatenate([np.eye(len(connection))[start], rigid[stop]])
        if not len(constraints):
            return len(connection)
        return len(connection) - int(np.linalg.matrix_rank(constraints))

    def count_below(self, frequencies_rad_per_ps: ArrayLike) -> IntArray:
        """Return the number of modes, zero modes included, below each frequency (> 0)."""
        w = np.asarray(frequencies_rad_per_ps, dtype=float).ravel()
        left, left_count = self._dynamic_stiffness(w, self.length_nm * JOINT)
        right, right_count = self._dynamic_stiffness(w, self.length_nm * (1 - JOINT))
        n = left.shape[-1] // 2
        joined = np.zeros((len(w), 3 * n, 3 * n))
        joined[:, : 2 * n, : 2 * n] += left
        joined[:, n:, n:] += right
        start, stop = self._fixed_ends()
        free = np.concatenate([~start, np.ones(n, dtype=bool), ~stop])
        return left_count + right_count + _negative(joined[:, free][:, :, free])

    def frequencies_rad_per_ps(self, count: int) -> FloatArray:
        """Return the lowest `count` frequencies above zero, ascending, each by its multiplicity."""
        if count < 1:
            raise InputError(f"{count} modes are asked for; at least one is")
        wanted = self.zero_modes + np.arange(1, count + 1)
        low, high = np.zeros(count), np.full(count, self._slowest_speed() * np.pi / self.length_nm)
        while np.any(short := self.count_below(high) < wanted):
            low[short], high[short] = high[short], 2 * high[short]
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            below = self.count_below(middle) < wanted
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return (low + high) / 2

    def modes(self, count: int, points: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest frequencies above zero and their shapes.

        Shapes (count, points + 1, coordinates) are those at `points` + 1 places from end to end,
        exact but for the mass normalisation, which integrates by the trapezoid rule.
        """
        frequencies = self.frequencies_rad_per_ps(count)
        parts, _ = self._dynamic_stiffness(frequencies, self.length_nm / points)
        n = len(self.coordinates)
        start, stop = self._fixed_ends()
        free = np.concatenate([~start, np.ones(n * (points - 1), dtype=bool), ~stop])
        weight = np.full(points + 1, self.length_nm / points)
        weight[[0, -1]] /= 2
        mass = scipy.linalg.block_diag(
            *weight[:, np.newaxis, np.newaxis] * self._part(self.rod.mass)
        )
        shapes = np.zeros((count, n * (points + 1)))
        for i, part in enumerate(parts):
            whole = np.zeros_like(mass)
            for j in range(0, n * points, n):
                whole[j : j + 2 * n, j : j + 2 * n] += part
            # of a mode that shares its frequency with k lower ones, the first k + 1 are all alike
            earlier = int(np.sum(np.isclose(frequencies[:i], frequencies[i], rtol=1e-10, atol=0)))
            squared, vectors = scipy.linalg.eigh(
                whole[np.ix_(free, free)], mass[np.ix_(free, free)]
            )
            shapes[i, free] = vectors[:, np.argsort(np.abs(squared), kind="stable")[earlier]]
        return frequencies, shapes.reshape(count, points + 1, n)

    def _part(self, matrix: FloatArray) -> FloatArray:
        return matrix[np.ix_(self.coordinates, self.coordinates)]

    def _fixed_ends(self) -> list[NDArray[np.bool_]]:
        """Return which coordinates do not move at the first and at the last end."""
        position = np.asarray(self.coordinates) < 3
        fixed = {"free": position & False, "held": position | True, "pinned": position}
        return [fixed[end] for end in self.ends]

    def _scaled(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return S with S^T S = K, and connection and mass for the coordinates z = S x."""
        root = scipy.linalg.cholesky(self._part(self.rod.stiffness))
        inverse = np.linalg.inv(root)
        connection = root @ self._part(self.rod.connection) @ inverse
        return root, connection, inverse.T @ self._part(self.rod.mass) @ inverse

    def _slowest_speed(self) -> float:
        return 1 / float(np.sqrt(np.linalg.eigvalsh(self._scaled()[2])[-1]))

    def _dynamic_stiffness(self, w: FloatArray, length: float) -> tuple[FloatArray, IntArray]:
        """Return the dynamic stiffness (w, 2n, 2n) of a part, and its modes below w if held."""
        root, connection, mass = self._scaled()
        n = len(root)
        # with both ends held a part has no mode below (pi/part - |connection|) times the slowest
        # speed: |z' + connection z| >= (pi/part - |connection|) |z|
        slow = np.linalg.norm(connection, 2) + w.max() / self._slowest_speed()
        doublings = max(0, int(np.ceil(np.log2(1.1 * length * slow / np.pi))))
        part = length / 2**doublings
        # z and the stress times the part's length have similar sizes
        generator = np.zeros((len(w), 2 * n, 2 * n))
        generator[:, :n, :n] = -connection * part
        generator[:, n:, n:] = connection.T * part
        generator[:, :n, n:] = np.eye(n)
        generator[:, n:, :n] = -((w * part) ** 2)[:, np.newaxis, np.newaxis] * mass
        transfer = scipy.linalg.expm(generator)
        compliance = np.linalg.inv(transfer[:, :n, n:])
        first = compliance @ transfer[:, :n, :n] / part
        last = transfer[:, n:, n:] @ compliance / part
        across = -compliance / part
        count = np.zeros(len(w), dtype=np.int64)
        for _ in range(doublings):
            middle = _symmetric(first + last)
            count = 2 * count + _negative(middle)
            to_last = np.linalg.solve(middle, across)
            to_first = np.linalg.solve(middle, across.transpose(0, 2, 1))
            first, last = first - across @ to_first, last - across.transpose(0, 2, 1) @ to_last
            across = -across @ to_last
        stiffness = np.block([[first, across], [across.transpose(0, 2, 1), last]])
        ends = scipy.linalg.block_diag(root, root)
        return _symmetric(ends.T @ stiffness @ ends), count


def _symmetric(matrices: FloatArray) -> FloatArray:
    return (matrices + matrices.transpose(0, 2, 1)) / 2


def _negative(matrices: FloatArray) -> IntArray:
    """Return how many eigenvalues of each symmetric matrix are negative."""
    return (np.linalg.eigvalsh(matrices) < 0).sum(axis=-1)
