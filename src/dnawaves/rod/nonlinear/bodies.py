"""Free motion of rigid bodies: where they go between two kicks."""

from __future__ import annotations

import numpy as np

from dnawaves.rod.nonlinear.fields import Field, Rotator, multiply_quaternions
from dnawaves.rod.rod import FloatArray

# Strang splitting of the spin's energy into rotations about the principal axes, each exact
SPLITTING = ((0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5))


class Bodies:
    """Rigid bodies: centres of mass, principal axes and momenta, and their free motion.

    Momenta (6, n) are those of the laboratory: linear, then angular about the centre of mass. Both
    stay as they are while a body is free, so only kicks change them.

    Parameters
    ----------
    mass : (1, n) or (1, 1)
    moments : (3, n) or (3, 1)
        Principal moments of inertia.
    principal : (4, n) or (4, 1), optional
        Quaternions of the principal axes, seen from the bodies' own frames; None if they coincide.
    """

    def __init__(
        self, mass: FloatArray, moments: FloatArray, principal: FloatArray | None, n: int
    ) -> None:
        self.centres, self.quaternions = Field.empty(3, n), Field.empty(4, n)
        self.momenta = Field.empty(6, n)
        self._mass, self._moments, self._principal = mass, moments, principal
        self._linear = self.momenta.all[:3]
        self._spin_laboratory = Field(self.momenta.all[3:], self.momenta.parts[3:])
        self._spin, self._turned = Field.empty(3, n), Field.empty(4, n)
        self._scratch, self._lever = np.empty((3, n)), Field.empty(2, n).parts
        self._tangent, self._sine, self._cosine = (np.empty(n) for _ in range(3))
        self._rotator = Rotator(n)

    def drifts(self, time_ps: float) -> tuple[FloatArray, list[FloatArray]]:
        """Return what `drift` multiplies momenta by to move all bodies by a time."""
        half_turns = [share * time_ps / 2 / self._moments[axis] for axis, share in SPLITTING]
        return time_ps / self._mass, half_turns

    def drift(self, per_mass: FloatArray, half_turns: list[FloatArray]) -> None:
        """Move all bodies freely by the time of `drifts`."""
        np.multiply(self._linear, per_mass, out=self._scratch)
        np.add(self.centres.all, self._scratch, out=self.centres.all)
        if self._principal is not None:
            self._turn_axes(self._principal)
        self._rotator.to_body(self._spin_laboratory, self.quaternions, self._spin)
        for (axis, _), half_turn in zip(SPLITTING, half_turns, strict=True):
            self._rotate(axis, half_turn)
        # each turn by (tan(t/2), 1) lengthens the quaternion
        q, squares = self.quaternions.all, self._turned.all
        np.multiply(q, q, out=squares)
        np.add.reduce(squares, axis=0, out=self._tangent)
        np.sqrt(self._tangent, out=self._tangent)
        np.divide(q, self._tangent, out=q)
        if self._principal is not None:
            self._turn_axes(self._principal * np.array([[-1.0], [-1.0], [-1.0], [1.0]]))

    def _turn_axes(self, by: FloatArray) -> None:
        self.quaternions.all[:] = multiply_quaternions(self.quaternions.all, by)

    def _rotate(self, axis: int, half_turn: FloatArray) -> None:
        """Rotate about one body axis by t = spin 2 half_turn; the spin as seen from the body."""
        following, third = (axis + 1) % 3, (axis + 2) % 3
        q, spin, turned = self.quaternions.parts, self._spin.parts, self._turned
        tangent, sine, cosine = self._tangent, self._sine, self._cosine
        np.multiply(spin[axis], half_turn, out=tangent)
        np.tan(tangent, out=tangent)
        # q (1 + tan(t/2) e_axis)
        np.multiply(tangent, self.quaternions.all, out=turned.all)
        np.add(q[axis], turned.parts[3], out=q[axis])
        np.subtract(q[3], turned.parts[axis], out=q[3])
        np.add(q[following], turned.parts[third], out=q[following])
        np.subtract(q[third], turned.parts[following], out=q[third])
        # cos t = 2/(1 + tan^2) - 1, sin t = 2 tan/(1 + tan^2)
        np.multiply(tangent, tangent, out=cosine)
        np.add(cosine, 1.0, out=cosine)
        np.divide(2.0, cosine, out=cosine)
        np.multiply(tangent, cosine, out=sine)
        np.subtract(cosine, 1.0, out=cosine)
        first, second = self._lever
        np.multiply(sine, spin[following], out=first)
        np.multiply(sine, spin[third], out=second)
        np.multiply(cosine, spin[following], out=spin[following])
        np.add(spin[following], second, out=spin[following])
        np.multiply(cosine, spin[third], out=spin[third])
        np.subtract(spin[third], first, out=spin[third])
