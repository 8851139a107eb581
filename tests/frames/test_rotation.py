"""Rotation vectors and matrices against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dnawaves.frames.rotation import rotation_matrix, rotation_vector

DIRECTIONS = np.random.default_rng(3).normal(size=(400, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, np.newaxis]


@pytest.mark.parametrize("angle", [0, 1e-200, 1e-12, 1e-6, 0.1, 1.5, 2.5, 3.1, np.pi - 1e-9])
def test_matrix_and_back(angle: float) -> None:
    vectors = angle * DIRECTIONS
    matrix = rotation_matrix(vectors.T)
    expected = Rotation.from_rotvec(vectors).as_matrix()
    # Round-off of a few operations on numbers of order 1 (and of pi).
    np.testing.assert_allclose(matrix.transpose(2, 0, 1), expected, atol=5e-16)
    np.testing.assert_allclose(rotation_vector(matrix).T, vectors, atol=3e-15)


def test_half_a_turn_about_each_axis() -> None:
    half_turns = np.stack([np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1]), np.diag([-1.0, -1, 1])])
    found = rotation_vector(half_turns.transpose(1, 2, 0))
    np.testing.assert_allclose(np.abs(found), np.pi * np.eye(3), atol=1e-15)


def test_a_missing_matrix_stays_missing() -> None:
    matrices = np.stack([np.eye(3), np.full((3, 3), np.nan)], axis=-1)
    with np.errstate(all="raise"):
        found = rotation_vector(matrices)
    np.testing.assert_array_equal(np.isnan(found), [[False, True]] * 3)
