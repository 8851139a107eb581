"""Vectors and quaternions of many bodies, component first, worked on in place.

Slicing costs as much as arithmetic on a few hundred numbers, so each component is sliced once,
when its array is made. Quaternions are (x, y, z, w); they turn body axes into laboratory axes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dnawaves.rod.rod import FloatArray


class Field(NamedTuple):
    """A vector at each body or link: all components (components, n), and each one (n,)."""

    all: FloatArray
    parts: tuple[FloatArray, ...]

    @classmethod
    def of(cls, array: FloatArray) -> Field:
        return cls(array, tuple(array))

    @classmethod
    def empty(cls, components: int, n: int) -> Field:
        return cls.of(np.empty((components, n)))

    def columns(self, columns: slice) -> Field:
        return Field.of(self.all[:, columns])

    @property
    def vector(self) -> Field:
        """The first three components: the vector part of a quaternion."""
        return Field(self.all[:3], self.parts[:3])


def cross(a: Field, b: Field, out: Field, scratch: Field) -> None:
    """Set `out` to a x b."""
    (a0, a1, a2), (b0, b1, b2), (o0, o1, o2), (s0, s1, s2) = (
        a.parts,
        b.parts,
        out.parts,
        scratch.parts,
    )
    np.multiply(a1, b2, out=o0)
    np.multiply(a2, b1, out=s0)
    np.multiply(a2, b0, out=o1)
    np.multiply(a0, b2, out=s1)
    np.multiply(a0, b1, out=o2)
    np.multiply(a1, b0, out=s2)
    np.subtract(out.all, scratch.all, out=out.all)


class Rotator:
    """Turns vectors by quaternions: R v = v + w t + r x t with t = 2 r x v."""

    def __init__(self, n: int) -> None:
        self._turn, self._scratch = Field.empty(3, n), Field.empty(3, n)

    def to_laboratory(self, vector: Field, quaternion: Field, out: Field) -> None:
        """Set `out` to R v."""
        axis, turn = quaternion.vector, self._turn
        cross(axis, vector, turn, self._scratch)
        np.add(turn.all, turn.all, out=turn.all)
        cross(axis, turn, out, self._scratch)
        self._finish(vector, quaternion, out)

    def to_body(self, vector: Field, quaternion: Field, out: Field) -> None:
        """Set `out` to R^T v."""
        axis, turn = quaternion.vector, self._turn
        cross(vector, axis, turn, self._scratch)
        np.add(turn.all, turn.all, out=turn.all)
        cross(turn, axis, out, self._scratch)
        self._finish(vector, quaternion, out)

    def _finish(self, vector: Field, quaternion: Field, out: Field) -> None:
        turn = self._turn.all
        np.multiply(quaternion.parts[3], turn, out=turn)
        np.add(out.all, turn, out=out.all)
        np.add(out.all, vector.all, out=out.all)


def multiply_quaternions(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the products a b (4, n) of quaternions (4, n) or (4, 1)."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by + ay * bw + az * bx - ax * bz,
            aw * bz + az * bw + ax * by - ay * bx,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )
