"""Strains of base-pair steps: the rotation vector and the displacement in the mid-step frame.

Source: Simo & Vu-Quoc (1986) Comput. Methods Appl. Mech. Eng. 58, 79-116 (strains of a rod whose
cross-sections are rigid), here between two rigid base pairs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dnawaves.frames.fit import Frames
from dnawaves.frames.rotation import along_axes, rotation_matrix, rotation_vector, turned
from dnawaves.frames.vectors import Array, norm


class StepStrains(NamedTuple):
    """Strains (6, ...), displacement in Å and rotation vector in rad; the mid-step frames."""

    values: Array
    middle: Frames


def step_strains(pairs: Frames) -> StepStrains:
    """Return Γ = R_midᵀ(x_{j+1} - x_j) and Ω = log(R_jᵀ R_{j+1}) of successive pairs.

    Frames run over (pairs, ...); R_mid = R_j exp(Ω/2). Components are along the mid-step axes.
    These are not shift to twist (the CEHS parameters): see docs/frames.md.
    """
    origin, axes = pairs
    return strains_between(
        Frames(origin[:, :-1], axes[:, :, :-1]), Frames(origin[:, 1:], axes[:, :, 1:])
    )


def strains_between(first: Frames, second: Frames) -> StepStrains:
    """Return the strains that carry `first` into `second`, see `step_strains`."""
    rotation = np.stack([along_axes(second.axes, axis) for axis in first.axes])
    omega = rotation_vector(rotation)
    axes = turned(first.axes, omega / 2)
    gamma = along_axes(axes, second.origin - first.origin)
    middle = Frames((first.origin + second.origin) / 2, axes)
    return StepStrains(np.concatenate([gamma, omega]), middle)


def strain_deviations(pairs: Frames, reference: Frames) -> Array:
    """Return (δΓ, δΩ) (6, steps, times), in Å and rad: the strains less those of a reference.

    `pairs` runs over (pairs, times), `reference` over (pairs,).
    """
    return step_strains(pairs).values - step_strains(reference).values[:, :, np.newaxis]


def strain_jacobian(reference: Array) -> Array:
    """Return the exact linear map (6, 12, ...) from displacements of two pairs to (δΓ, δΩ).

    `reference` (6, ...) are the strains about which is linearised. The columns are displacement
    (Å) and rotation vector (rad) of the first pair, then of the second, each in its own frame.
    With w = [Ω]/2, q1 = exp(-w) θ_1 and q2 = exp(w) θ_2 (the rotations seen from the middle),
    δΩ = w/sinh(w) (q2 - q1), from the left and right Jacobians of the rotation group; the
    mid-frame turns by (q1 + q2)/2 - tanh(w/2)/2 (q2 - q1), and Γ with it, backwards. The lattice
    of `dnawaves.rod` counts other strains, see `dnawaves.rod.measured.mid_frame_jacobian`.
    """
    gamma, omega = cross_matrices(reference[:3]), cross_matrices(reference[3:])
    to_middle = rotation_matrix(reference[3:] / 2)
    from_first = to_middle.swapaxes(0, 1)
    identity = np.eye(3).reshape(3, 3, *np.ones(omega.ndim - 2, dtype=int))
    lean = _half_tangent(reference[3:]) * omega
    per_difference = _matrix_of_differences(reference[3:])
    jacobian = np.zeros((6, 12, *reference.shape[1:]))
    jacobian[:3, :3] = -from_first
    jacobian[:3, 6:9] = to_middle
    jacobian[:3, 3:6] = _product(gamma, _product(identity / 2 + lean, from_first))
    jacobian[:3, 9:] = _product(gamma, _product(identity / 2 - lean, to_middle))
    jacobian[3:, 3:6] = -_product(per_difference, from_first)
    jacobian[3:, 9:] = _product(per_difference, to_middle)
    return jacobian


def linear_strains(jacobian: Array, displacements: Array) -> Array:
    """Return (δΓ, δΩ) (6, steps, ...) of small displacements (6, pairs, ...) in own frames.

    `jacobian` (6, 12, steps) is that of `strain_jacobian`.
    """
    return np.einsum("ijs,js...->is...", jacobian[:, :6], displacements[:, :-1]) + np.einsum(
        "ijs,js...->is...", jacobian[:, 6:], displacements[:, 1:]
    )


def in_own_frames(displacements: Array, pairs: Frames) -> Array:
    """Return displacements (6, pairs, ...) of the laboratory along each pair's own axes (pairs,).

    Displacement of the origin, then rotation vector.
    """
    axes = pairs.axes.reshape(*pairs.axes.shape, *np.ones(displacements.ndim - 2, dtype=int))
    return np.concatenate(
        [along_axes(axes, displacements[:3]), along_axes(axes, displacements[3:])]
    )


def cross_matrices(vector: Array) -> Array:
    """Return the matrices (3, 3, ...) that map y to vector x y."""
    matrix = np.zeros((3, 3, *vector.shape[1:]))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrix[j, i] = vector[k]
        matrix[i, j] = -vector[k]
    return matrix


def _half_tangent(omega: Array) -> Array:
    """Return t with tanh(w/2)/2 = t [Ω], w = [Ω]/2."""
    angle = norm(omega)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(angle > 1e-8, np.tan(angle / 4) / (2 * angle), 1 / 8)


def _matrix_of_differences(omega: Array) -> Array:
    """Return w/sinh(w), w = [Ω]/2: 1 along Ω and (|Ω|/2)/sin(|Ω|/2) across it."""
    angle = norm(omega)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(angle > 1e-8, (1 / np.sinc(angle / (2 * np.pi)) - 1) / angle**2, 1 / 24)
    crossed = cross_matrices(omega)
    matrix = -factor * _product(crossed, crossed)
    for i in range(3):
        matrix[i, i] += 1.0
    return matrix


def _product(a: Array, b: Array) -> Array:
    return np.einsum("ij...,jk...->ik...", a, b)
