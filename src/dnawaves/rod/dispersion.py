"""Dispersion relations: the general rod, and the closed forms of the simple ones.

Wavenumbers are in rad/nm, angular frequencies in rad/ps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.rod import BEND_1, BEND_2, SHEAR_1, SHEAR_2, FloatArray, Rod
from dnawaves.units import A_PER_NM


def dispersion(rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool) -> FloatArray:
    """Return the six angular frequencies (k, 6) of each wavenumber (k,), ascending, rad/ps.

    They are the singular values of K^(1/2) L M^(-1/2), hence real: L = ik + A is the strain
    operator of the rod, (2/a) sinh(a (ik + A)/2) that of the rigid-base-pair lattice (mid-frame
    strains). Wavenumbers are those of the cross-section's frame. Each frequency is right to
    round-off of the highest one at its wavenumber, about 1e-15 of it.
    """
    strain = strain_operator(rod, wavenumbers_rad_per_nm, lattice=lattice)
    stiffness_root, mass_root_inverse = energy_roots(rod)
    # eigenvalues of the square would take half the time and lose half the digits of slow waves
    operator = stiffness_root @ strain @ mass_root_inverse
    return np.asarray(np.linalg.svd(operator, compute_uv=False)[:, ::-1], dtype=float)


def energy_roots(rod: Rod) -> tuple[FloatArray, FloatArray]:
    """Return S and Q (6, 6) with K = S^T S and M^-1 = Q Q^T, both upper triangular."""
    inverse = scipy.linalg.solve_triangular(scipy.linalg.cholesky(rod.mass), np.eye(6))
    return scipy.linalg.cholesky(rod.stiffness), inverse


def strain_operator(
    rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool
) -> NDArray[np.complex128]:
    """Return L (k, 6, 6), 1/nm, which maps the amplitude of a plane wave to that of its strain.

    On the lattice this strain is exact for x_{j+1} = x_j E exp(a strain) E with the half-step E at
    rest: the small screw, seen in the mid-frame, by which a step exceeds the step at rest. The
    rotation vector of a whole step is not this strain (see `measured.mid_frame_jacobian`).
    """
    k = np.asarray(wavenumbers_rad_per_nm, dtype=float).reshape(-1, 1, 1)
    if not lattice:
        return 1j * k * np.eye(6) + rod.connection
    a = rod.spacing_nm
    half_step = scipy.linalg.expm(a * rod.connection / 2)
    phase = np.exp(0.5j * k * a)
    return (phase * half_step - np.linalg.inv(half_step) / phase) / a


def strain_operator_slope(
    rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool
) -> NDArray[np.complex128]:
    """Return dL/dk (k, 6, 6): i, or i cosh(a (ik + A)/2) on the lattice."""
    k = np.asarray(wavenumbers_rad_per_nm, dtype=float).reshape(-1, 1, 1)
    if not lattice:
        return np.broadcast_to(1j * np.eye(6), (len(k), 6, 6))
    half_step = scipy.linalg.expm(rod.spacing_nm * rod.connection / 2)
    phase = np.exp(0.5j * k * rod.spacing_nm)
    return 0.5j * (phase * half_step + np.linalg.inv(half_step) / phase)


def lattice_frequency(
    wavenumbers_rad_per_nm: ArrayLike, speed_A_per_ps: float, spacing_nm: float
) -> FloatArray:
    """Return omega = (2V/a) |sin(ka/2)|, rad/ps: extension or twist of a chain of base pairs."""
    phase = np.asarray(wavenumbers_rad_per_nm, dtype=float) * spacing_nm / 2
    return 2 * speed_A_per_ps / A_PER_NM / spacing_nm * np.abs(np.sin(phase))


def lattice_speed_from_frequency(
    frequency_rad_per_ps: ArrayLike, wavenumbers_rad_per_nm: ArrayLike, spacing_nm: float
) -> FloatArray:
    """Return the long-wave speed V, A/ps, of the chain whose wave k has this frequency.

    Inverse of `lattice_frequency`. Raises InputError where sin(ka/2) = 0.
    """
    phase = np.asarray(wavenumbers_rad_per_nm, dtype=float) * spacing_nm / 2
    if np.any(np.abs(np.sin(phase)) < 1e-12):
        raise InputError("a wave of wavenumber 0 (or 2 pi/spacing) has no speed on the lattice")
    frequency = np.asarray(frequency_rad_per_ps, dtype=float)
    return frequency * spacing_nm / (2 * np.abs(np.sin(phase))) * A_PER_NM


class Transverse(NamedTuple):
    """Constants of the bend and shear waves of an isotropic straight rod (rho, I, C, D, Gamma0)."""

    density: float
    inertia: float
    shear: float
    bend: float
    stretch: float


def transverse_constants(rod: Rod) -> Transverse:
    """Return rho, I, C, D and Gamma0 of a straight isotropic rod without couplings.

    Raises InputError if the two transverse axes differ or the transverse motion is coupled to
    anything else than by Gamma0 and the intrinsic twist.
    """
    transverse = [SHEAR_1, SHEAR_2, BEND_1, BEND_2]
    rows = rod.stiffness[transverse]
    shear, bend = rod.stiffness[SHEAR_1, SHEAR_1], rod.stiffness[BEND_1, BEND_1]
    inertia = rod.inertia_Da_nm[0, 0]
    isotropic = np.zeros((4, 6))
    isotropic[range(4), transverse] = [shear, shear, bend, bend]
    straight = np.hypot(*rod.gamma0[:2]) == 0 and np.hypot(*rod.omega0_rad_per_nm[:2]) == 0
    if not (
        straight
        and not rod.centre_nm.any()
        and np.allclose(rows, isotropic, rtol=1e-9, atol=1e-9 * min(shear, bend))
        and np.allclose(rod.inertia_Da_nm[:2], inertia * np.eye(2, 3), atol=1e-9 * inertia)
    ):
        raise InputError(
            "this closed form needs a straight, transversely isotropic rod without couplings, its "
            "centre of mass on the axis; "
            "see Rod.averaged_about_axis"
        )
    return Transverse(rod.density_Da_per_nm, inertia, shear, bend, rod.gamma0[2])


def bend_shear_branches(
    rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool
) -> FloatArray:
    """Return the lower and upper bend/shear branch (k, 2) of the isotropic rod, rad/ps.

    Bishop & Zhmudsky eq. 48a (Timoshenko). Wavenumbers q are those of the laboratory frame; in
    the frame of a cross-section with intrinsic twist use q = k + twist and q = k - twist.
    The lattice replaces q by (2/a) sin(qa/2) and Gamma0 by Gamma0 cos(qa/2).
    """
    density, inertia, shear, bend, stretch = transverse_constants(rod)
    q = np.asarray(wavenumbers_rad_per_nm, dtype=float)
    stretch_q = np.full_like(q, stretch)
    if lattice:
        phase = q * rod.spacing_nm / 2
        q, stretch_q = 2 / rod.spacing_nm * np.sin(phase), stretch * np.cos(phase)
    sum_of_roots = (shear * q**2 / density + (bend * q**2 + shear * stretch_q**2) / inertia) / 2
    product = shear * bend * q**4 / (density * inertia)
    upper = sum_of_roots + np.sqrt(np.maximum(sum_of_roots**2 - product, 0))
    # the difference of the two terms would lose all digits of the flexural branch at small q
    lower = np.divide(product, upper, out=np.zeros_like(q), where=upper > 0)
    return np.sqrt(np.stack([lower, upper], axis=-1))


def eq46_factorised_residual(
    rod: Rod, wavenumbers_rad_per_nm: ArrayLike, frequency_rad_per_ps: ArrayLike
) -> FloatArray:
    """Return how far (k, omega) is from the roots of the twisted isotropic rod, relative, (..., 2).

    Factorised form of Bishop & Zhmudsky eq. 46, one factor for each q = k + twist, k - twist:
    (rho w^2 - C q^2)(I w^2 - D q^2) = rho C Gamma0^2 w^2. Zero in either factor is a root.
    """
    density, inertia, shear, bend, stretch = transverse_constants(rod)
    twist = rod.omega0_rad_per_nm[2]
    k, w2 = np.asarray(wavenumbers_rad_per_nm, float), np.square(frequency_rad_per_ps)
    q2 = np.square(np.stack([k + twist, k - twist], axis=-1))
    w2 = w2[..., np.newaxis]
    left = (density * w2 - shear * q2) * (inertia * w2 - bend * q2)
    right = density * shear * stretch**2 * w2
    scale = (density * w2 + shear * q2) * (inertia * w2 + bend * q2) + right
    return (left - right) / scale


def eq46_expanded_residual(
    rod: Rod,
    wavenumbers_rad_per_nm: ArrayLike,
    frequency_rad_per_ps: ArrayLike,
    *,
    as_printed: bool = False,
) -> FloatArray:
    """Return the relative residual of eq. 46 in an expanded form P^2 = Q^2, between 0 and 1.

    The form follows from the component equations by elimination of the rotations; the paper's own
    arrangement of its terms may differ by a factor.

    As printed, the two denominators hold 4 k^2 D^2 Omega0^4 for 4 k^2 D^2 Omega0^2, which is
    wrong (and of the wrong dimension: it is evaluated in Angstrom, the paper's scale).
    """
    density, inertia, shear, bend, stretch = transverse_constants(rod)
    k, w2 = np.asarray(wavenumbers_rad_per_nm, float), np.square(frequency_rad_per_ps)
    twist = rod.omega0_rad_per_nm[2]
    twist_power = (twist / A_PER_NM) ** 4 * A_PER_NM**2 if as_printed else twist**2
    detuning = inertia * w2 - bend * (k**2 + twist**2)
    coupling = density * shear * stretch**2 * w2 / (detuning**2 - 4 * (k * bend) ** 2 * twist_power)
    diagonal = density * w2 - shear * (k**2 + twist**2) - coupling * detuning
    off_diagonal = 2 * k * twist * (shear + coupling * bend)
    return np.abs(diagonal**2 - off_diagonal**2) / (diagonal**2 + off_diagonal**2)
