"""Plane waves of the general rod: frequencies, velocities, polarisation, participation.

At each wavenumber the mass-normalised waves are the right singular vectors v of
B = K^(1/2) L M^(-1/2), the stresses they make the left ones u, their frequencies its singular
values (see `dispersion`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import energy_roots, strain_operator, strain_operator_slope
from dnawaves.rod.rod import BEND_1, BEND_2, EXTENSION, SHEAR_1, SHEAR_2, TWIST, FloatArray, Rod
from dnawaves.units import A_PER_NM

ComplexArray = NDArray[np.complex128]

MOTIONS = {
    "extension": [EXTENSION],
    "twist": [TWIST],
    "bend": [BEND_1, BEND_2],
    "shear": [SHEAR_1, SHEAR_2],
}
# Of the highest frequency: nearer ones are one, smaller ones zero. Above round-off (1e-15) by
# enough for eigenvectors that are right to 1e-5.
SAME_FREQUENCY = 1e-10
ZERO_FREQUENCY = 1e-12


@dataclass(frozen=True, eq=False)
class PlaneWaves:
    """The six plane waves exp(i(ks - wt)) of each wavenumber, in the cross-section's frame.

    Frequencies (k, 6) in rad/ps and group velocities (k, 6) in nm/ps belong to the columns of
    `motion` and `stress` (k, 6, 6): orthonormal in the inner products of kinetic and of elastic
    energy.
    """

    rod: Rod
    wavenumbers_rad_per_nm: FloatArray
    frequencies_rad_per_ps: FloatArray
    group_velocities_nm_per_ps: FloatArray
    motion: ComplexArray
    stress: ComplexArray

    @property
    def group_velocities_A_per_ps(self) -> FloatArray:
        """d(omega)/dk (k, 6).

        Where branches cross, each its own. Where a frequency is zero it has a kink: the slope
        towards larger k.
        """
        return self.group_velocities_nm_per_ps * A_PER_NM

    @property
    def phase_velocities_A_per_ps(self) -> FloatArray:
        """omega/k (k, 6); at k = 0 its limit from above: the slope of a wave of zero frequency,
        infinite for others."""
        k = self.wavenumbers_rad_per_nm[:, np.newaxis]
        omega = self.frequencies_rad_per_ps
        at_rest = omega <= ZERO_FREQUENCY * omega.max(axis=1, keepdims=True)
        limit = np.where(at_rest, self.group_velocities_nm_per_ps, np.inf)
        return np.divide(omega, k, out=limit, where=k != 0) * A_PER_NM

    @property
    def velocity_vectors(self) -> ComplexArray:
        """Amplitudes (k, 6, wave) of (u, th) with v M v = 1: nm/ps and rad/ps at 1 kJ/mol/nm."""
        return energy_roots(self.rod)[1] @ self.motion

    @property
    def strain_vectors(self) -> ComplexArray:
        """Amplitudes (k, 6, wave) of the strain with e K e = 1; of waves at rest their limit."""
        return np.linalg.inv(energy_roots(self.rod)[0]) @ self.stress

    def kinetic_shares(self) -> FloatArray:
        """Return the shares (k, wave, motion) of `MOTIONS` in the kinetic energy; their sum is 1.

        Here extension is motion along the axis, shear across it, bend and twist are rotations.
        A share is velocity times momentum: where M or K couples two motions one share may be < 0.
        """
        return _shares(self.velocity_vectors, self.rod.mass)

    def strain_shares(self) -> FloatArray:
        """Return the shares (k, wave, motion) of `MOTIONS` in the elastic energy; their sum is 1.

        A share is strain times stress. These shares tell bend from shear: see `kinetic_shares`.
        """
        return _shares(self.strain_vectors, self.rod.stiffness)


def plane_waves(rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool) -> PlaneWaves:
    """Return the plane waves of each wavenumber (k,), by frequency.

    Waves of one frequency are those that are continuous along k: they diagonalise dB/dk within
    their space, and stand in the order in which they leave it towards larger k.
    """
    k = np.atleast_1d(np.asarray(wavenumbers_rad_per_nm, dtype=float))
    if k.ndim != 1 or not np.isfinite(k).all():
        raise InputError("wavenumbers must be a list of finite numbers, in rad/nm")
    stiffness_root, mass_root_inverse = energy_roots(rod)
    operator = stiffness_root @ strain_operator(rod, k, lattice=lattice) @ mass_root_inverse
    slope = stiffness_root @ strain_operator_slope(rod, k, lattice=lattice) @ mass_root_inverse
    left, values, right = np.linalg.svd(operator)
    left, values, right = left[:, :, ::-1], values[:, ::-1], right[:, ::-1]
    motion, stress = right.conj().swapaxes(1, 2).copy(), left.copy()
    velocities = _split_degenerate(values, motion, stress, slope)
    _split_at_rest(values, motion, stress, slope, velocities)
    return PlaneWaves(rod, k, values, velocities, motion, stress)


def _split_degenerate(
    values: FloatArray, motion: ComplexArray, stress: ComplexArray, slope: ComplexArray
) -> FloatArray:
    """Return the group velocities (k, 6); turn degenerate vectors, in place, to have them.

    Hellmann and Feynman: d(omega)/dk = Re u.B'.v; within a degenerate space, the eigenvalues of
    the Hermitian part of u.B'.v.
    """
    gap = np.diff(values, axis=1)
    apart = (gap > SAME_FREQUENCY * values[:, -1:]) | (gap > 1e-3 * values[:, 1:])
    level = np.concatenate([np.zeros((len(values), 1)), np.cumsum(apart, axis=1)], axis=1)
    within = level[:, :, np.newaxis] == level[:, np.newaxis]
    coupling = stress.conj().swapaxes(1, 2) @ slope @ motion
    hermitian = np.where(within, (coupling + coupling.conj().swapaxes(1, 2)) / 2, 0)
    # one eigh for all spaces: an offset per level, wider than any slope, keeps them in order
    offset = 4 * np.linalg.norm(slope, axis=(1, 2)).max() * level
    hermitian[:, range(6), range(6)] += offset
    eigenvalues, turn = np.linalg.eigh(hermitian)
    motion[:], stress[:] = motion @ turn, stress @ turn
    return eigenvalues - offset


def _split_at_rest(
    values: FloatArray,
    motion: ComplexArray,
    stress: ComplexArray,
    slope: ComplexArray,
    velocities: FloatArray,
) -> None:
    """Do the same, in place, for the waves of zero frequency.

    To first order B is then dk B', so that their slopes are singular values of u.B'.v.
    """
    at_rest = (values <= ZERO_FREQUENCY * values[:, -1:]).sum(axis=1)
    for index in np.flatnonzero(at_rest):
        zero = slice(at_rest[index])
        u, v = stress[index, :, zero], motion[index, :, zero]
        left, steepness, right = np.linalg.svd(u.conj().T @ slope[index] @ v)
        stress[index, :, zero] = u @ left[:, ::-1]
        motion[index, :, zero] = v @ right.conj().T[:, ::-1]
        velocities[index, zero] = steepness[::-1]


def _shares(vectors: ComplexArray, energy: FloatArray) -> FloatArray:
    work = (vectors.conj() * (energy @ vectors)).real
    return np.stack([work[:, rows].sum(axis=1) for rows in MOTIONS.values()], axis=-1)
