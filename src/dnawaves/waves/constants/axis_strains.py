"""Strains of base-pair steps, seen along the helix axis: small screws that add up over a segment.

A step's strain is a small screw in its mid-frame (see `rod.measured.mid_frame_jacobian`). Referred
to the helix axis at the step's height it is one of extension, twist, two bends and two shears of a
straight rod, in directions that do not turn with the step; and the screws of the steps between two
base pairs add up to the motion of one against the other, exactly to first order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames
from dnawaves.frames.rotation import rotation_matrix
from dnawaves.frames.standard import standard_place
from dnawaves.frames.strain import step_strains
from dnawaves.rod.measured import mid_frame_jacobian
from dnawaves.rod.rod import cross_matrix
from dnawaves.system.geometry import HelixFrame, helix_frame
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AxisStrains:
    """What strains are along the axis of a structure.

    `operator` (step, 6, 6) maps changes of a step's displacement (Å) and rotation vector (rad) to
    two shears, extension (Å), two bends and twist (rad) of that step, in the order of
    `structure_factor.COORDINATES`; `heights_A` (pair,) along the axis.
    """

    operator: Array
    heights_A: Array

    @classmethod
    def of_structure(cls, pairs: Frames, axis: HelixFrame | None = None) -> AxisStrains:
        """Return those of a structure of base-pair frames (pairs,) in Å.

        `axis` is that of the cylinder through C1' atoms placed on the frames if not given.
        """
        frame = axis or axis_of_frames(pairs)
        origin_A = A_PER_NM * frame.origin_nm
        poses = _poses(pairs)
        strains = step_strains(pairs).values
        operator = []
        for pose, after, step in zip(poses[:-1], poses[1:], strains.T, strict=True):
            half = scipy.linalg.expm(scipy.linalg.logm(np.linalg.solve(pose, after)) / 2).real
            middle = pose @ half
            turn = frame.directions @ middle[:3, :3]
            arm = frame.directions @ (middle[:3, 3] - origin_A)
            arm[2] = 0.0
            screw = np.block([[turn, cross_matrix(arm) @ turn], [np.zeros((3, 3)), turn]])
            operator.append(screw @ np.linalg.inv(mid_frame_jacobian(step)))
        anchors = np.mean(_anchors(pairs), axis=0)
        return cls(np.array(operator), (anchors - origin_A) @ frame.axis)

    def __call__(self, changes: Array) -> Array:
        """Return strains along the axis (..., step, 6) of changes of steps (..., step, 6)."""
        return np.asarray(np.einsum("sij,...sj->...si", self.operator, changes))

    def covariance(self, compliance: Array) -> Array:
        """Return covariances along the axis of covariances of steps, both (step, 6, step, 6)."""
        return np.asarray(np.einsum("sij,sjtk,tlk->sitl", self.operator, compliance, self.operator))


def mean_structure(steps: Array) -> Frames:
    """Return the frames (pairs,) that successive steps (6, step) make: Å and rotation vectors."""
    pose = np.eye(4)
    poses = [pose]
    for step in steps.T:
        change = np.eye(4)
        # axes are rows (axis, component), a pose's columns
        change[:3, :3] = rotation_matrix(step[3:])
        change[:3, 3] = rotation_matrix(step[3:] / 2) @ step[:3]
        pose = pose @ change
        poses.append(pose)
    listed = np.array(poses)
    return Frames(listed[:, :3, 3].T, listed[:, :3, :3].transpose(2, 1, 0))


def axis_of_frames(pairs: Frames) -> HelixFrame:
    """Return the helix axis of base-pair frames (pairs,) in Å."""
    return helix_frame(_anchors(pairs) / A_PER_NM)


def _anchors(pairs: Frames) -> Array:
    """Return where the C1' of both strands lie in pairs of ideal bases, (2, pairs, 3) in Å."""
    x, y, _ = standard_place("A", "C1'")
    return np.stack(
        [(pairs.origin + x * pairs.axes[0] + side * y * pairs.axes[1]).T for side in (1, -1)]
    )


def _poses(pairs: Frames) -> Array:
    count = pairs.origin.shape[1]
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = pairs.axes.transpose(2, 1, 0)
    poses[:, :3, 3] = pairs.origin.T
    return poses
