"""Normal modes of a linear chain, and their response in time to kicks, drives and loads.

One mode obeys q'' + g q' + w^2 q = f(t). All its responses from rest are divided differences of
the exponential at -s1 t, -s2 t (the roots of s^2 - g s + w^2) and, if driven, i W t. Written so,
they hold without change for undamped, underdamped, critical, overdamped and zero-frequency modes
and for a drive at resonance.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Self

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# relative to the largest squared frequency: below it lies the round-off of the eigensolver
ZERO_MODE = 1e-12
# n-th term of the series is below 1/(2 n!) for arguments inside the unit circle
SERIES_TERMS = 19


def impulse_response(
    times_ps: ArrayLike, frequencies_rad_per_ps: ArrayLike, friction_per_ps: float
) -> tuple[FloatArray, FloatArray]:
    """Return q and q' (times, modes) after q(0) = 0, q'(0) = 1, without further force."""
    t, slow, fast = _times_and_roots(times_ps, frequencies_rad_per_ps, friction_per_ps)
    position = t * _exp_difference(-slow * t, -fast * t)
    velocity = np.exp(-fast * t) - slow * position
    return position.real, velocity.real


def sine_drive_response(
    times_ps: ArrayLike,
    frequencies_rad_per_ps: ArrayLike,
    friction_per_ps: float,
    drive_rad_per_ps: float,
) -> tuple[FloatArray, FloatArray]:
    """Return q and q' (times, modes) from rest under the force sin(drive t), transient included."""
    if not drive_rad_per_ps > 0:
        raise InputError(f"the drive's frequency is {drive_rad_per_ps} rad/ps; it must be positive")
    t, slow, fast = _times_and_roots(times_ps, frequencies_rad_per_ps, friction_per_ps)
    drive = np.asarray(1j * drive_rad_per_ps * t, dtype=np.complex128)
    position = t**2 * _exp_second_difference(-slow * t, -fast * t, drive)
    velocity = t * _exp_difference(-fast * t, drive) - slow * position
    return position.imag, velocity.imag


class ModalChain:
    """Linear chain K, M with some coordinates held at zero, solved by its normal modes.

    Fields have the shape (pairs,) or (pairs, coordinates); K and M act on the flattened field.

    Parameters
    ----------
    stiffness, mass : (n, n)
        Symmetric; mass positive definite, stiffness positive semi-definite.
    free : bool, shape of the field
        False where the coordinate is held.

    Raises
    ------
    InputError
        If nothing is free, or the mass is not positive definite.
    """

    def __init__(self, stiffness: FloatArray, mass: FloatArray, free: NDArray[np.bool_]) -> None:
        if not free.any():
            raise InputError("every base pair of the chain is held: nothing can move")
        self.stiffness = stiffness
        self.mass = mass
        self.free = free
        index = np.flatnonzero(free)
        try:
            squared, vectors = scipy.linalg.eigh(
                stiffness[np.ix_(index, index)], mass[np.ix_(index, index)]
            )
        except scipy.linalg.LinAlgError as error:
            raise InputError("the masses of the chain are not positive definite") from error
        squared[np.abs(squared) < ZERO_MODE * np.abs(squared).max()] = 0.0
        if squared[0] < 0:
            raise InputError("the stiffness of the chain is not positive: it has no stable rest")
        self.frequencies_rad_per_ps: FloatArray = np.sqrt(squared)
        self._vectors = np.zeros((len(index), free.size))
        self._vectors[:, index] = vectors.T

    @property
    def shapes(self) -> FloatArray:
        """Mass-normalised mode shapes (modes, *field)."""
        return self._vectors.reshape(-1, *self.free.shape)

    def modes(self) -> tuple[FloatArray, FloatArray]:
        """Return the frequencies (modes,), ascending, rad/ps, and the mass-normalised shapes."""
        return self.frequencies_rad_per_ps, self.shapes

    def scaled(self, speed_ratio: float) -> Self:
        """Return this chain with all speeds multiplied, without solving it again.

        A common factor r^2 in the stiffness scales every frequency by r and leaves the shapes.
        """
        if not speed_ratio > 0:
            raise InputError(f"the ratio of speeds is {speed_ratio}; it must be positive")
        other = copy.copy(self)
        other.stiffness = self.stiffness * speed_ratio**2
        other.frequencies_rad_per_ps = self.frequencies_rad_per_ps * speed_ratio
        return other

    def kick_response(
        self, times_ps: ArrayLike, velocities: ArrayLike, friction_per_ps: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Return displacements and velocities (times, *field) after a kick at t = 0.

        Raises InputError if a held base pair is kicked: it cannot take up an impulse.
        """
        kick = self._field("velocities", velocities)
        if np.any(np.abs(kick[~self.free]) > 1e-9 * np.abs(kick).max()):
            raise InputError("the kick acts on a held base pair, which cannot move; kick beside it")
        amplitudes = self._vectors @ (self.mass @ kick.ravel())
        response = impulse_response(times_ps, self.frequencies_rad_per_ps, friction_per_ps)
        return self._superpose(response, amplitudes)

    def driven_response(
        self,
        times_ps: ArrayLike,
        force_pattern: ArrayLike,
        frequency_rad_per_ps: float,
        friction_per_ps: float = 0.0,
    ) -> tuple[FloatArray, FloatArray]:
        """Return displacements and velocities (times, *field) from rest under pattern sin(w t)."""
        amplitudes = self._vectors @ self._field("force_pattern", force_pattern).ravel()
        response = sine_drive_response(
            times_ps, self.frequencies_rad_per_ps, friction_per_ps, frequency_rad_per_ps
        )
        return self._superpose(response, amplitudes)

    def static_response(self, forces: ArrayLike) -> FloatArray:
        """Return the displacements (*field) at rest under constant forces.

        Raises InputError if the forces push a motion that nothing resists (a free chain with a
        net force or torque).
        """
        amplitudes = self._vectors @ self._field("forces", forces).ravel()
        moving = self.frequencies_rad_per_ps > 0
        if np.any(np.abs(amplitudes[~moving]) > 1e-9 * np.abs(amplitudes).max()):
            raise InputError("the forces do not balance and no held base pair resists them")
        relaxed = amplitudes[moving] / self.frequencies_rad_per_ps[moving] ** 2
        return (relaxed @ self._vectors[moving]).reshape(self.free.shape)

    def _field(self, name: str, values: ArrayLike) -> FloatArray:
        field = np.asarray(values, dtype=float)
        if field.shape != self.free.shape:
            raise InputError(f"{name} has shape {field.shape}; the chain's is {self.free.shape}")
        return field

    def _superpose(
        self, response: tuple[FloatArray, FloatArray], amplitudes: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        position, velocity = (
            (part * amplitudes @ self._vectors).reshape(-1, *self.free.shape) for part in response
        )
        return position, velocity


def free_pairs(pairs: int, held: Sequence[int]) -> NDArray[np.bool_]:
    """Return which of the base pairs (pairs,) may move; `held` are indices from 0, or from -1 back.

    Raises InputError for fewer than two base pairs or an index outside the chain.
    """
    if pairs < 2:
        raise InputError(f"a chain has at least 2 base pairs, not {pairs}")
    outside = [index for index in held if not -pairs <= index < pairs]
    if outside:
        raise InputError(f"held base pairs {outside} are not in a chain of {pairs}")
    free = np.ones(pairs, dtype=bool)
    free[list(held)] = False
    return free


def _times_and_roots(
    times_ps: ArrayLike, frequencies_rad_per_ps: ArrayLike, friction_per_ps: float
) -> tuple[FloatArray, ComplexArray, ComplexArray]:
    """Return times as a column and the two roots s of s^2 - g s + w^2, the slower decay first."""
    t = np.asarray(times_ps, dtype=float).reshape(-1, 1)
    if np.any(t < 0):
        raise InputError("times before the start of the motion are asked for")
    if friction_per_ps < 0:
        raise InputError(f"the friction is {friction_per_ps} /ps; it must not be negative")
    w = np.asarray(frequencies_rad_per_ps, dtype=float).reshape(1, -1)
    half = friction_per_ps / 2
    # (half - w)(half + w) keeps the digits near critical damping, where the squares nearly cancel
    fast = half + np.sqrt(((half - w) * (half + w)).astype(complex))
    # their product is w^2: half - sqrt(...) would lose the slow root of an overdamped mode
    slow = np.divide(w.astype(complex) ** 2, fast, out=np.zeros_like(fast), where=fast != 0)
    return t, slow, fast


def _exp_difference(x: ComplexArray, y: ComplexArray) -> ComplexArray:
    """Return (e^y - e^x)/(y - x), also where x = y."""
    x, y = np.broadcast_arrays(x, y)
    # the larger exponential is taken out, so that expm1 never overflows
    swapped = y.real > x.real
    largest = np.where(swapped, y, x)
    z = np.where(swapped, x, y) - largest
    ratio = np.divide(np.expm1(z), z, out=np.ones_like(z), where=z != 0)
    return np.exp(largest) * ratio


def _exp_second_difference(x: ComplexArray, y: ComplexArray, z: ComplexArray) -> ComplexArray:
    """Return the divided difference of exp at x, y, z, where |z - y| >= |x|, |y|, |z|."""
    gap = np.broadcast_to(z - y, np.broadcast_shapes(x.shape, y.shape, z.shape))
    near = np.abs(gap) < 1.0
    difference = _exp_difference(x, z) - _exp_difference(x, y)
    result = np.divide(difference, gap, out=np.zeros_like(difference), where=~near)
    points = [np.broadcast_to(point, gap.shape)[near] for point in (x, y, z)]
    result[near] = _exp_second_difference_series(*points)
    return result


def _exp_second_difference_series(
    x: ComplexArray, y: ComplexArray, z: ComplexArray
) -> ComplexArray:
    """Return the same for points inside the unit circle, where the difference would cancel.

    Sum of h_n(x, y, z)/(n + 2)! with the complete homogeneous symmetric polynomials h_n.
    """
    one = two = three = np.ones_like(x)
    factorial = 2.0
    total = three / factorial
    for n in range(1, SERIES_TERMS):
        one = one * x
        two = one + y * two
        three = two + z * three
        factorial *= n + 2
        total = total + three / factorial
    return total
