"""Step and pair parameters: known rigid motions, and the places where formulas break."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from dnawaves.frames.fit import Frames
from dnawaves.frames.parameters import (
    RigidBodyParameters,
    pair_parameters,
    rigid_body_parameters,
    step_parameters,
)

RNG = np.random.default_rng(5)
Frame = tuple[np.ndarray, Rotation]
START: Frame = (np.array([3.0, -40.0, 7.0]), Rotation.from_rotvec([0.4, -1.1, 0.7]))


def next_frame(frame: Frame, values: np.ndarray) -> Frame:
    """Carry a frame by CEHS parameters: Rz(W/2 - p) Ry(G) Rz(W/2 + p).

    El Hassan & Calladine (1995), eqs 1 to 7: bend G² = roll² + tilt², p its direction from y.
    """
    shift, (tilt, roll, twist) = values[:3], np.radians(values[3:])
    bend, direction = np.hypot(roll, tilt), np.arctan2(tilt, roll)
    before = Rotation.from_euler("z", twist / 2 - direction)
    after = Rotation.from_euler("z", twist / 2 + direction)
    origin, axes = frame
    middle = (
        axes * before * Rotation.from_euler("y", bend / 2) * Rotation.from_euler("z", direction)
    )
    return origin + middle.apply(shift), axes * before * Rotation.from_euler("y", bend) * after


def frames(*listed: Frame) -> Frames:
    """Return frames over (listed,)."""
    return Frames(
        np.array([origin for origin, _ in listed]).T,
        np.array([axes.as_matrix().T for _, axes in listed]).transpose(1, 2, 0),
    )


def between(first: Frame, second: Frame) -> RigidBodyParameters:
    return rigid_body_parameters(frames(first), frames(second))


def turned(values: np.ndarray) -> np.ndarray:
    """Wrap the last three of six parameters to +-180 degrees."""
    wrapped = np.array(values, dtype=float)
    wrapped[3:] = (wrapped[3:] + 180) % 360 - 180
    return wrapped


lengths = st.floats(-10, 10)
angles = st.floats(-110, 110)


@settings(max_examples=200, deadline=None)
@given(st.tuples(lengths, lengths, lengths, angles, angles, st.floats(-179.9, 179.9)))
def test_known_steps_come_back(values: tuple[float, ...]) -> None:
    given_values = np.array(values)
    found = between(START, next_frame(START, given_values)).values[:, 0]
    # The condition grows as bend/sin(bend), here up to 6; coordinates of 40 Å round at 7e-15.
    np.testing.assert_allclose(found, given_values, atol=1e-9)


def test_successive_steps_and_mid_frames() -> None:
    values = RNG.normal([0, 0, 3.4, 0, 2, 35], [0.5, 0.5, 0.3, 5, 5, 5], size=(9, 6))
    chain = [START]
    for row in values:
        chain.append(next_frame(chain[-1], row))
    found = step_parameters(frames(*chain))
    np.testing.assert_allclose(found.values.T, values, atol=1e-11)
    assert not found.opposed.any()
    np.testing.assert_allclose(
        found.middle.origin.T, [(a[0] + b[0]) / 2 for a, b in pairwise(chain)]
    )
    # Half way: the mid-frame is as far from one frame as from the other.
    for n, (here, there) in enumerate(pairwise(chain)):
        middle = Rotation.from_matrix(found.middle.axes[:, :, n].T)
        first, second = (middle.inv() * axes for axes in (here[1], there[1]))
        assert first.magnitude() == pytest.approx(second.magnitude(), abs=1e-12)


@pytest.mark.parametrize("twist_deg", [0.0, 36.0, -150.0])
def test_no_bend_at_all(twist_deg: float) -> None:
    origin, axes = np.zeros(3), Rotation.identity()
    there = (np.array([0.1, 0.2, 3.4]), Rotation.from_euler("z", twist_deg, degrees=True))
    found = between((origin, axes), there).values[:, 0]
    # z1 and z2 are equal bit by bit, so tilt and roll must be 0, not 0/0.
    np.testing.assert_allclose(found[3:], [0, 0, twist_deg], atol=1e-14)


@pytest.mark.parametrize("exponent", [-4, -6, -8, -10, -12, -16])
def test_the_smallest_bends(exponent: int) -> None:
    values = np.array([0, 0, 3.4, 3 * 10.0**exponent, 4 * 10.0**exponent, 36])
    origin_frame = (np.zeros(3), Rotation.identity())
    found = between(origin_frame, next_frame(origin_frame, values)).values[:, 0]
    # Round-off of a rotation matrix, 1e-16 rad or 1e-14 deg, times a few operations.
    np.testing.assert_allclose(found[3:5], values[3:5], atol=5e-14)


@pytest.mark.parametrize("twist_deg", [180.0, -180.0, 179.999999, -179.999999])
@pytest.mark.parametrize("bend_deg", [0.0, 30.0, 90.0, 170.0])
def test_half_a_turn_and_large_bends(twist_deg: float, bend_deg: float) -> None:
    values = np.array([0.5, -1.0, 3.4, 0.6 * bend_deg, 0.8 * bend_deg, twist_deg])
    result = between(START, next_frame(START, values))
    found, expected = turned(result.values[:, 0]), turned(values)
    if abs(twist_deg) == 180:
        # +180 and -180 are one rotation, with two mid-frames half a turn apart about z.
        assert abs(result.values[5, 0]) == pytest.approx(180, abs=1e-9)
        if np.sign(result.values[5, 0]) != np.sign(twist_deg):
            expected[[0, 1, 3, 4]] *= -1
        found[5] = expected[5] = 0
    np.testing.assert_allclose(found, expected, atol=1e-9)
    axes = result.middle.axes[:, :, 0]
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)


def test_a_bend_of_180_degrees_is_undefined_and_said_so() -> None:
    upside_down = (np.zeros(3), Rotation.from_matrix(np.diag([1.0, -1.0, -1.0])))
    upright = (np.zeros(3), Rotation.identity())
    found = rigid_body_parameters(frames(upright, upright), frames(upside_down, upright))
    np.testing.assert_array_equal(found.opposed, [True, False])
    assert np.isnan(found.values[:, 0]).all() and np.isnan(found.middle.axes[..., 0]).all()
    np.testing.assert_array_equal(found.values[:, 1], np.zeros(6))


def test_no_warnings_from_any_special_case() -> None:
    flipped = (np.zeros(3), Rotation.from_matrix(np.diag([1.0, -1.0, -1.0])))
    with np.errstate(all="raise"):
        between(flipped, flipped)
        between(flipped, (np.zeros(3), Rotation.identity()))


def test_read_from_the_other_strand_shift_and_tilt_change_sign() -> None:
    """Dickerson et al. (1989), EMBO J. 8, 1: the symmetry of the parameters of a step."""
    values = np.array([0.4, -0.6, 3.3, 2.5, -4.0, 33.0])
    here, there = START, next_frame(START, values)
    flip = Rotation.from_euler("x", 180, degrees=True)
    backwards = between((there[0], there[1] * flip), (here[0], here[1] * flip)).values[:, 0]
    np.testing.assert_allclose(backwards, values * [-1, 1, 1, -1, 1, 1], atol=1e-11)


def test_pair_parameters_are_those_from_strand_2_to_strand_1() -> None:
    values = np.array([0.3, -0.2, 0.1, 5.0, -12.0, 1.5])  # shear to opening
    second = START
    first = next_frame(second, values)
    flip = Rotation.from_euler("x", 180, degrees=True)
    found = pair_parameters(frames(first), frames((second[0], second[1] * flip)))
    np.testing.assert_allclose(found.values[:, 0], values, atol=1e-11)
    # The pair's z runs with strand I: within half the buckle and propeller of its base's.
    assert np.dot(found.middle.axes[2, :, 0], first[1].as_matrix()[:, 2]) > np.cos(np.radians(7))
