"""Rotation vectors and matrices on arrays whose first axes are the components."""

from __future__ import annotations

import numpy as np

from dnawaves.frames.vectors import Array, dot, norm


def rotation_matrix(vector: Array) -> Array:
    """Return the matrices (3, 3, ...) of rotations about `vector` (3, ...) by its length in rad.

    Rodrigues: 1 + sin(a)/a [v] + (1 - cos(a))/a^2 [v]^2.
    """
    angle = norm(vector)
    # np.sinc(x) is sin(pi x)/(pi x), finite at 0.
    first = np.sinc(angle / np.pi)
    second = np.sinc(angle / (2 * np.pi)) ** 2 / 2
    matrix = second * vector[:, np.newaxis] * vector[np.newaxis]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrix[i, i] += np.cos(angle)
        matrix[j, i] += first * vector[k]
        matrix[i, j] -= first * vector[k]
    return matrix


def rotation_vector(matrix: Array) -> Array:
    """Return the rotation vectors (3, ...) in rad, at most pi long, of matrices (3, 3, ...).

    By way of the quaternion, so that no angle from 0 to pi loses digits; at pi itself either
    sign of the vector is right.
    """
    trace = matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
    axial = np.stack([matrix[k, j] - matrix[j, k] for j, k in ((1, 2), (2, 0), (0, 1))])
    if np.all(trace > 0):
        scalar, vector = 1 + trace, axial
    else:
        scalar, vector = _largest_quaternion(matrix, trace, axial)
    sine = norm(vector)
    half = np.arctan2(sine, np.abs(scalar))
    with np.errstate(divide="ignore", invalid="ignore"):
        per_sine = np.where(sine > 0, half / sine, 1 / np.abs(scalar))
    return np.where(scalar < 0, -2.0, 2.0) * per_sine * vector


def _largest_quaternion(matrix: Array, trace: Array, axial: Array) -> tuple[Array, Array]:
    """Return scalar and vector part of a multiple of the quaternion q: q times its largest part."""
    # Each column of 4 q q^T is such a multiple; its diagonal tells which is the largest.
    products = np.empty((4, 4, *trace.shape))
    products[0, 0] = 1 + trace
    products[0, 1:] = products[1:, 0] = axial
    products[1:, 1:] = matrix + matrix.swapaxes(0, 1)
    for i in range(3):
        products[i + 1, i + 1] += 1 - trace
    largest = np.argmax(np.stack([products[i, i] for i in range(4)]), axis=0)
    quaternion = np.take_along_axis(products, largest[np.newaxis, np.newaxis], axis=1)[:, 0]
    return quaternion[0], quaternion[1:]


def turned(axes: Array, vector: Array) -> Array:
    """Return axes (axis, component, ...) turned by rotation vectors given in their own frame."""
    matrix = rotation_matrix(vector)
    return np.stack([sum_of_axes(axes, matrix[:, k]) for k in range(3)])


def sum_of_axes(axes: Array, components: Array) -> Array:
    """Return vectors (3, ...) from their components (3, ...) along axes (axis, component, ...)."""
    return components[0] * axes[0] + components[1] * axes[1] + components[2] * axes[2]


def along_axes(axes: Array, vector: Array) -> Array:
    """Return the components (3, ...) of vectors along axes (axis, component, ...)."""
    return np.stack([dot(axis, vector) for axis in axes])
