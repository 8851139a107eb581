"""A start that is bent or overtwisted over some base pairs, as a bound protein leaves it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def turned(
    positions_nm: Array,
    pairs: NDArray[np.intp],
    axis_points_nm: Array,
    first: int,
    last: int,
    rotation_rad: Array,
) -> Array:
    """Return positions in which base pair `last` is turned against `first`.

    The rotation vector (3,) is shared out evenly over the steps between the two; each step turns
    all that follows it, as one rigid body, about the axis point midway. Along the helix axis the
    vector overtwists, across it it bends in the plane normal to it.

    Parameters
    ----------
    positions_nm : (atoms, 3)
    pairs : (atoms,) index of each atom's base pair
    axis_points_nm : (N, 3) point of the helix axis at each base pair
    first, last : indices of the base pairs, first < last
    """
    one = Rotation.from_rotvec(np.asarray(rotation_rad) / (last - first))
    positions, points = positions_nm.copy(), axis_points_nm.copy()
    for step in range(first, last):
        pivot = (points[step] + points[step + 1]) / 2
        beyond = pairs > step
        positions[beyond] = pivot + one.apply(positions[beyond] - pivot)
        points[step + 1 :] = pivot + one.apply(points[step + 1 :] - pivot)
    return positions
