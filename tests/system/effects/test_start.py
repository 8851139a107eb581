"""A start that is bent or overtwisted: the angle that was asked for, in rigid pieces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dnawaves.system.effects.start import turned
from dnawaves.system.rigid_body import RigidBodies

FIRST, LAST = 1, 4


@pytest.fixture(scope="module")
def duplex(bare: Callable[[str], Any]) -> Any:
    return bare("CGATCG")


def axis_points(duplex: Any) -> np.ndarray:
    frame = duplex.frame
    heights = frame.height_nm(duplex.positions_nm)
    means = np.array([heights[duplex.pairs == n].mean() for n in range(6)])
    return frame.origin_nm + means[:, None] * frame.axis


@pytest.mark.parametrize("kind", ["twist", "bend"])
def test_pairs_beyond_are_turned_by_the_whole_angle_pairs_between_by_their_share(
    duplex: Any, kind: str
) -> None:
    axis = duplex.frame.directions[2 if kind == "twist" else 0]
    angle = np.radians(24.0)
    place = turned(
        duplex.positions_nm, duplex.pairs, axis_points(duplex), FIRST, LAST, angle * axis
    )
    bodies = RigidBodies(duplex.positions_nm, duplex.masses_Da, duplex.pairs)
    shares = np.clip((np.arange(6) - FIRST) / (LAST - FIRST), 0, 1)
    # Each base pair is a rigid body: the best fit is exact.
    np.testing.assert_allclose(bodies.pose(place)[1], angle * shares[:, None] * axis, atol=1e-9)
    before, after = bodies.pose(duplex.positions_nm)[0], bodies.pose(place)[0]
    np.testing.assert_allclose(after[: FIRST + 1], before[: FIRST + 1], atol=1e-12)


def test_overtwist_leaves_heights_and_bend_leaves_the_axis_length(duplex: Any) -> None:
    frame, points = duplex.frame, axis_points(duplex)
    over = turned(duplex.positions_nm, duplex.pairs, points, FIRST, LAST, 0.4 * frame.axis)
    np.testing.assert_allclose(
        frame.height_nm(over), frame.height_nm(duplex.positions_nm), atol=1e-12
    )
    bent = turned(
        np.concatenate([duplex.positions_nm, points]),
        np.concatenate([duplex.pairs, np.arange(6)]),
        points,
        FIRST,
        LAST,
        0.4 * frame.directions[0],
    )[-6:]
    steps, straight = (np.linalg.norm(np.diff(p, axis=0), axis=1) for p in (bent, points))
    # Midway between two pairs both halves of a step keep their lengths: it shrinks by cos(angle/2).
    shrunk = np.where((np.arange(5) >= FIRST) & (np.arange(5) < LAST), np.cos(0.4 / 3 / 2), 1)
    np.testing.assert_allclose(steps, straight * shrunk, rtol=1e-9)
    end, begin = bent[-1] - bent[-2], bent[1] - bent[0]
    expected = Rotation.from_rotvec(0.4 * frame.directions[0]).apply(begin)
    np.testing.assert_allclose(
        end / np.linalg.norm(end), expected / np.linalg.norm(expected), atol=1e-9
    )
