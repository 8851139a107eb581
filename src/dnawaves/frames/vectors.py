"""Vector algebra on arrays whose first axis is the component."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def dot(a: Array, b: Array) -> Array:
    """Return the scalar product over the first axis."""
    total = a[0] * b[0]
    total += a[1] * b[1]
    total += a[2] * b[2]
    return np.asarray(total)


def cross(a: Array, b: Array) -> Array:
    """Return the vector product over the first axis."""
    product = np.empty((3, *np.broadcast_shapes(a.shape[1:], b.shape[1:])))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        # Into place: stacking three new arrays would copy each of them once more.
        np.multiply(a[j], b[k], out=product[i, ...])
        product[i] -= a[k] * b[j]
    return product


def norm(a: Array) -> Array:
    """Return the length over the first axis."""
    return np.sqrt(dot(a, a))
