"""Normal modes of a linear chain, and its response in time to kicks, forces and loads."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Self, TypeAlias

import numpy as np
import scipy.sparse
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.normal_modes import ZERO_MODE, modes_of_stiffness, modes_of_strain
from dnawaves.rod.oscillator import (
    FloatArray,
    Response,
    gaussian_pulse_response,
    impulse_response,
    sampled_force_response,
    sine_drive_response,
)

__all__ = ["ModalChain", "free_pairs", "impulse_response", "sine_drive_response"]

Observe: TypeAlias = FloatArray | scipy.sparse.csr_array | None


class ModalChain:
    """Linear chain K, M with some coordinates held at zero, solved by its normal modes.

    Fields have the shape (pairs,) or (pairs, coordinates); K and M act on the flattened field, of
    n coordinates. Responses have the shape (times, *field), or (times, observed) for a matrix
    `observe` (observed, n), which may be sparse: only these combinations are computed. Every
    friction is the mass times a constant.

    Parameters
    ----------
    stiffness : (n, n)
        Symmetric, positive semi-definite. One copy of it is made, and the shapes are another.
    mass : (n, n) or (n,)
        Symmetric and positive definite, or the diagonal of such a matrix.
    free : bool, shape of the field
        False where the coordinate is held.
    strain_root : (r, n), optional
        B with B^T B = stiffness. If given, the modes are found from it instead: those of a stiff
        and soft chain keep their digits (see `normal_modes`). Needs the mass as a matrix.
    zero_mode : float
        Squared frequencies below this part of the largest are taken to be zero, without
        strain_root.

    Raises
    ------
    InputError
        If nothing is free, the mass is not positive definite, or the stiffness is negative.
    """

    def __init__(
        self,
        stiffness: FloatArray,
        mass: FloatArray,
        free: NDArray[np.bool_],
        strain_root: FloatArray | None = None,
        zero_mode: float = ZERO_MODE,
    ) -> None:
        if not free.any():
            raise InputError("every base pair of the chain is held: nothing can move")
        self.stiffness = stiffness
        self.mass = mass
        self.free = free
        index = self._free_index
        moving_mass = mass[index] if mass.ndim == 1 else mass[np.ix_(index, index)]
        if strain_root is None:
            moving = stiffness[np.ix_(index, index)]
            modes = modes_of_stiffness(moving, moving_mass, zero_mode)
        else:
            modes = modes_of_strain(strain_root[:, index], moving_mass)
        self.frequencies_rad_per_ps: FloatArray = modes[0]
        self._vectors = modes[1]

    @property
    def _free_index(self) -> NDArray[np.intp]:
        return np.flatnonzero(self.free)

    @property
    def shapes(self) -> FloatArray:
        """Mass-normalised mode shapes (modes, *field)."""
        return self._spread(self._vectors)

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
        self,
        times_ps: ArrayLike,
        velocities: ArrayLike,
        friction_per_ps: float = 0.0,
        observe: Observe = None,
    ) -> Response:
        """Return displacements and velocities after a kick at t = 0.

        Raises InputError if a held base pair is kicked: it cannot take up an impulse.
        """
        kick = self._field("velocities", velocities)
        if np.any(np.abs(kick[~self.free]) > 1e-9 * np.abs(kick).max()):
            raise InputError("the kick acts on a held base pair, which cannot move; kick beside it")
        flat = kick.ravel()
        momentum = self.mass * flat if self.mass.ndim == 1 else self.mass @ flat
        return self._respond(
            momentum, observe, lambda w: impulse_response(times_ps, w, friction_per_ps)
        )

    def driven_response(
        self,
        times_ps: ArrayLike,
        force_pattern: ArrayLike,
        frequency_rad_per_ps: float,
        friction_per_ps: float = 0.0,
        ramp_ps: float = 0.0,
        observe: Observe = None,
    ) -> Response:
        """Return displacements and velocities from rest under pattern sin(w t).

        The force rises during the first `ramp_ps` as (1 - cos(pi t/ramp))/2.
        """
        return self._respond(
            self._field("force_pattern", force_pattern).ravel(),
            observe,
            lambda w: sine_drive_response(
                times_ps, w, friction_per_ps, frequency_rad_per_ps, ramp_ps
            ),
        )

    def pulse_response(
        self,
        times_ps: ArrayLike,
        force_pattern: ArrayLike,
        centre_ps: float,
        width_ps: float,
        friction_per_ps: float = 0.0,
        observe: Observe = None,
    ) -> Response:
        """Return displacements and velocities under pattern exp(-(t - centre)^2/(2 width^2)).

        The chain is at rest long before the pulse; times may lie before, within and after it.
        """
        return self._respond(
            self._field("force_pattern", force_pattern).ravel(),
            observe,
            lambda w: gaussian_pulse_response(times_ps, w, friction_per_ps, centre_ps, width_ps),
        )

    def sampled_response(
        self,
        force: ArrayLike,
        interval_ps: float,
        force_pattern: ArrayLike,
        friction_per_ps: float = 0.0,
        observe: Observe = None,
    ) -> Response:
        """Return displacements and velocities under pattern force(t), at the samples' times.

        From rest at the first sample of the force (times,); exact for its cubic spline.
        """
        return self._respond(
            self._field("force_pattern", force_pattern).ravel(),
            observe,
            lambda w: sampled_force_response(force, interval_ps, w, friction_per_ps),
        )

    def static_response(self, forces: ArrayLike) -> FloatArray:
        """Return the displacements (*field) at rest under constant forces.

        Raises InputError if the forces push a motion that nothing resists (a free chain with a
        net force or torque).
        """
        amplitudes = self._vectors @ self._field("forces", forces).ravel()[self._free_index]
        moving = self.frequencies_rad_per_ps > 0
        if np.any(np.abs(amplitudes[~moving]) > 1e-9 * np.abs(amplitudes).max()):
            raise InputError("the forces do not balance and no held base pair resists them")
        relaxed = amplitudes[moving] / self.frequencies_rad_per_ps[moving] ** 2
        return self._spread(relaxed @ self._vectors[moving])[0]

    def _field(self, name: str, values: ArrayLike) -> FloatArray:
        field = np.asarray(values, dtype=float)
        if field.shape != self.free.shape:
            raise InputError(f"{name} has shape {field.shape}; the chain's is {self.free.shape}")
        return field

    def _respond(
        self, load: FloatArray, observe: Observe, response: Callable[[FloatArray], Response]
    ) -> Response:
        """Superpose the modes' responses to a force or momentum (n,) of one course in time."""
        amplitudes = self._vectors @ load[self._free_index]
        # modes of another kind of motion are exactly at rest; one is kept for the shape
        excited = amplitudes != 0
        excited[0] = True
        seen, spread = self._vectors[excited], observe is None
        if observe is not None:
            if observe.ndim != 2 or observe.shape[1] != self.free.size:
                raise InputError(
                    f"observe has shape {observe.shape}; it must be (observed, {self.free.size})"
                )
            seen = (observe[:, self._free_index] @ seen.T).T
        weighted = amplitudes[excited, np.newaxis] * seen
        position, velocity = (
            part @ weighted for part in response(self.frequencies_rad_per_ps[excited])
        )
        return (self._spread(position), self._spread(velocity)) if spread else (position, velocity)

    def _spread(self, values: FloatArray) -> FloatArray:
        """Return values of the free coordinates (..., free) as fields (m, *field)."""
        rows = np.atleast_2d(values)
        if self.free.all():
            return rows.reshape(-1, *self.free.shape)
        fields = np.zeros((len(rows), *self.free.shape))
        fields[:, self.free] = rows
        return fields


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
