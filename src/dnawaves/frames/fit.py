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
    axes = _planar_polar_factor(correlation[0], correlation[1])
    if np.ptp(standard_A[:, 2]) > 0:
        axes = _newton_step(axes, correlation)
    origin = positions_A.mean(axis=1) - np.tensordot(mean, axes, axes=1)
    return Frames(origin, axes)


def _planar_polar_factor(m1: Array, m2: Array) -> Array:
    """Return the axes (3, 3, ...) whose x and y are the orthonormal vectors closest to m1, m2.

    M (MᵀM)^(-1/2) with the square root of a 2x2 matrix G, (G + s)/t, s² = det G, t² = tr G + 2s.
    """
    g11, g22, g12 = dot(m1, m1), dot(m2, m2), dot(m1, m2)
    s = norm(cross(m1, m2))
    trace = g11 + g22
    collinear = s <= 1e-12 * trace
    scale = 1 / np.where(collinear, np.nan, s * np.sqrt(trace + 2 * s))
    x = scale * ((g22 + s) * m1 - g12 * m2)
    y = scale * ((g11 + s) * m2 - g12 * m1)
    return np.stack([x, y, cross(x, y)])


def _newton_step(axes: Array, correlation: Array) -> Array:
    """Turn axes by one Newton step of the full least-squares problem.

    Maximises tr(B) over rotations, B_ij = axis_i . m_j: the step w solves (tr B - B_sym) w = a,
    a the axial vector of B.
    """
    b = np.stack([np.stack([dot(axis, m) for m in correlation]) for axis in axes])
    axial = np.stack([b[2, 1] - b[1, 2], b[0, 2] - b[2, 0], b[1, 0] - b[0, 1]])
    hessian = -(b + b.swapaxes(0, 1)) / 2
    for i in range(3):
        hessian[i, i] += b[0, 0] + b[1, 1] + b[2, 2]
    h1, h2, h3 = hessian
    cofactors = np.stack([cross(h2, h3), cross(h3, h1), cross(h1, h2)])
    step = np.stack([dot(row, axial) for row in cofactors]) / dot(h1, cofactors[0])
    half = (step[0] * axes[0] + step[1] * axes[1] + step[2] * axes[2]) / 2
    # Cayley's form keeps the axes orthonormal however large the step.
    factor = 2 / (1 + dot(half, half))
    turns = [cross(half, axis) for axis in axes]
    return np.stack(
        [axis + factor * (turn + cross(half, turn)) for axis, turn in zip(axes, turns, strict=True)]
    )
