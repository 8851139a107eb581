"""Frames from parameters: the forward code gives the parameters back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.inverse import bases_from_pairs, pairs_from_steps
from dnawaves.frames.parameters import pair_parameters, step_parameters

RNG = np.random.default_rng(8)
FIRST = Frames(np.array([3.0, -40.0, 7.0]), Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix().T)
# Bends to 155 degrees, twists to all but half a turn.
WIDEST = np.array([10, 10, 10, 110, 110, 179.9])

unit = st.floats(-1, 1)


@settings(max_examples=200, deadline=None)
@given(arrays(np.float64, (6, 5), elements=unit))
def test_steps_come_back(shares: np.ndarray) -> None:
    values = WIDEST[:, np.newaxis] * shares
    found = step_parameters(pairs_from_steps(values, FIRST)).values
    # The condition grows as bend/sin(bend), here up to 6; coordinates of 80 Å round at 1e-14.
    np.testing.assert_allclose(found, values, atol=1e-9)


@settings(max_examples=200, deadline=None)
@given(arrays(np.float64, (6, 3), elements=unit))
def test_pairs_come_back(shares: np.ndarray) -> None:
    values = WIDEST[:, np.newaxis] * shares
    pairs = pairs_from_steps(np.tile([[0.2], [0.5], [3.4], [1.0], [2.0], [36.0]], 2), FIRST)
    found = pair_parameters(*bases_from_pairs(values, pairs))
    np.testing.assert_allclose(found.values, values, atol=1e-9)
    np.testing.assert_allclose(found.middle.origin, pairs.origin, atol=1e-12)
    np.testing.assert_allclose(found.middle.axes, pairs.axes, atol=1e-12)


def test_a_long_duplex_over_time() -> None:
    values = RNG.normal([0, 0, 3.4, 0, 2, 35], [0.5, 0.5, 0.3, 5, 5, 5], size=(7, 199, 6)).T
    first = Frames(RNG.normal(size=(3, 7)), np.repeat(FIRST.axes[..., np.newaxis], 7, axis=-1))
    pairs = pairs_from_steps(values, first)
    assert pairs.origin.shape == (3, 200, 7) and pairs.axes.shape == (3, 3, 200, 7)
    np.testing.assert_array_equal(pairs.origin[:, 0], first.origin)
    # Round-off of 200 products of rotations.
    np.testing.assert_allclose(step_parameters(pairs).values, values, atol=1e-11)
    alone = pairs_from_steps(values[..., 3], Frames(first.origin[:, 3], FIRST.axes))
    np.testing.assert_allclose(pairs.origin[..., 3], alone.origin, atol=1e-12)


def test_a_straight_stack() -> None:
    pairs = pairs_from_steps(np.tile([[0.0], [0], [3.4], [0], [0], [36]], 10))
    np.testing.assert_allclose(pairs.origin[:, 10], [0, 0, 34], atol=1e-13)
    # Ten times 36 degrees: the eleventh pair stands above the first.
    np.testing.assert_allclose(pairs.axes[..., 10], np.eye(3), atol=1e-14)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.zeros((5, 3)), r"shape \(5, 3\); allowed: \(6, steps\)"),
        (np.zeros(6), r"shape \(6,\); allowed: \(6, steps\)"),
        (np.full((6, 2), np.nan), "bend up to nan"),
        (np.array([[0.0, 0, 0, 150, 150, 0]]).T, "bend up to 212.1"),
        (np.array([[0.0, 0, 0, 0, 0, 200]]).T, "turn up to 200"),
    ],
)
def test_refuses_what_no_frames_have(values: np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        pairs_from_steps(values)


def test_refuses_parameters_of_other_pairs() -> None:
    with pytest.raises(InputError, match=r"shape \(6, 4\); allowed: \(6, 3\)"):
        bases_from_pairs(np.zeros((6, 4)), pairs_from_steps(np.zeros((6, 2))))
