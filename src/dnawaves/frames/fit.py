"""Base frames: the standard frame fitted to a base's ring atoms.

Instead of a singular value decomposition, the polar factor of a 3x2 matrix in closed form:
the standard rings are planar, but for G N3 (z = 0.001 Å), for which one Newton step follows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dnawaves.frames.vectors import Array, cross, dot, norm


class Frames(NamedTuple):
    """Right-handed frames: `origin` (3, ...) in Å, `axes` (3, 3, ...) as (axis, component, ...)."""

    origin: Array
    axes: Array


def fit_frames(standard_A: Array, positions_A: Array) -> Frames:
    """Fit the frame in which atoms lie closest to their standard places (least squares).

    `standard_A` is (atoms, 3), flat in z to some 0.01 Å; `positions_A` is (3, atoms, ...).
    Atoms on one line give NaN.
    """
    mean = standard_A.mean(axis=0)
    correlation = np.tensordot(standard_A - mean, positions_A, axes=([0], [1]))
    axes = planar_axes(correlation[0], correlation[1])
    if np.ptp(standard_A[:, 2]) > 0:
        axes = newton_step(axes, correlation)
    origin = positions_A.mean(axis=1) - np.tensordot(mean, axes, axes=1)
    return Frames(origin, axes)


def planar_axes(m1: Array, m2: Array) -> Array:
    """Return the axes (3, 3, ...) whose x and y are the orthonormal vectors closest to m1, m2.

    M (MᵀM)^(-1/2) with the square root of a 2x2 matrix G, (G + s)/t, s² = det G, t² = tr G + 2s.
    """
    g11, g22, g12 = dot(m1, m1), dot(m2, m2), dot(m1, m2)
    normal = cross(m1, m2)
    s = norm(normal)
    trace = g11 + g22
    collinear = s <= 1e-12 * trace
    scale = 1 / np.where(collinear, np.nan, s * np.sqrt(trace + 2 * s))
    axes = np.empty((3, *m1.shape))
    np.subtract(((g22 + s) * scale) * m1, (g12 * scale) * m2, out=axes[0])
    np.subtract(((g11 + s) * scale) * m2, (g12 * scale) * m1, out=axes[1])
    np.divide(normal, np.where(collinear, np.nan, s), out=axes[2])
    return axes


def newton_step(axes: Array, correlation: Array) -> Array:
    """Turn axes of a planar fit by one Newton step of the full least-squares problem.

    Maximises tr(B) over rotations, B_ij = axis_i . m_j: the step w solves (tr B - B_sym) w = a,
    a the axial vector of B. After a planar fit B_12 = B_21 and B_31 = B_32 = 0; B_13 and B_23 are
    small, and their square is neglected.
    """
    m1, m2, m3 = correlation
    b11, b22, b12 = dot(axes[0], m1), dot(axes[1], m2), dot(axes[0], m2)
    b13, b23, b33 = (dot(axis, m3) for axis in axes)
    h11, h22 = b22 + b33, b11 + b33
    determinant = h11 * h22 - b12**2
    w1 = (b12 * b13 - h22 * b23) / determinant
    w2 = (h11 * b13 - b12 * b23) / determinant
    w3 = (b13 * w1 + b23 * w2) / (2 * (b11 + b22))
    half = (w1 * axes[0] + w2 * axes[1] + w3 * axes[2]) / 2
    # Cayley's form keeps the axes orthonormal however large the step.
    factor = 2 / (1 + dot(half, half))
    turned = np.empty_like(axes)
    for i in range(2):
        turn = cross(half, axes[i])
        turned[i] = axes[i] + factor * (turn + cross(half, turn))
    turned[2] = cross(turned[0], turned[1])
    return turned
