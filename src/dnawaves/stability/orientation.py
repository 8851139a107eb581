"""Frames where formulas divide by zero: twist 180°, bend 0 and 180°, no rotation at all."""

from __future__ import annotations

import numpy as np

from dnawaves.frames.fit import Frames
from dnawaves.frames.helix import helix_of_steps, screw_parameters
from dnawaves.frames.inverse import pairs_from_steps
from dnawaves.frames.parameters import rigid_body_parameters, step_parameters
from dnawaves.frames.rotation import rotation_matrix, rotation_vector
from dnawaves.stability.case import Found

PLACE_A = (0.5, -1.0, 3.4)


def step(tilt_deg: float, roll_deg: float, twist_deg: float) -> Found:
    """Return the largest error (Å, degrees) of step parameters made into frames and back.

    A twist of 180° may come back as -180°: the same rotation.
    """
    given = np.array([*PLACE_A, tilt_deg, roll_deg, twist_deg])
    found = step_parameters(pairs_from_steps(given[:, None]))
    error = found.values[:, 0] - given
    turn = abs((error[5] + 180) % 360 - 180)
    if abs(twist_deg) == 180 and found.values[5, 0] * twist_deg < 0:
        # The mid-frame's x and y are reversed with the twist's sign.
        error = found.values[:, 0] * [-1, -1, 1, -1, -1, 1] - given
    worst = float(max(np.abs(error[:5]).max(), turn))
    listed = ", ".join(f"{v:.6g}" for v in found.values[:, 0])
    return Found("holds", worst, f"shift to twist: {listed}")


def opposed() -> Found:
    """Return how many of mark, parameters and frame say that a bend of 180° has no mid-frame."""
    upright = Frames(np.zeros((3, 1)), np.eye(3)[:, :, None])
    over = Frames(np.array(PLACE_A)[:, None], np.diag([1.0, -1.0, -1.0])[:, :, None])
    found = rigid_body_parameters(upright, over)
    # Shift to rise, tilt to twist and the mid-frame are all without a number.
    told = (bool(found.opposed[0]), bool(np.isnan(found.values).all()))
    nan = bool(np.isnan(found.middle.axes).all())
    return Found("flagged", float(sum([*told, nan])), "marked as opposed, and not a number")


def unrotated() -> Found:
    """Return how many of mark and parameters say that without a turn there is no helix axis."""
    upright = Frames(np.zeros((3, 1)), np.eye(3)[:, :, None])
    raised = Frames(np.array(PLACE_A)[:, None], np.eye(3)[:, :, None])
    found = screw_parameters(upright, raised)
    of_steps, marked = helix_of_steps(np.array([*PLACE_A, 0.0, 0.0, 0.0])[:, None])
    told = [found.unrotated[0], marked[0], np.isnan(found.values[0, 0]), np.isnan(of_steps[0, 0])]
    return Found("flagged", float(sum(map(bool, told))), "marked, and not a number")


def half_turn(below_pi: float) -> Found:
    """Return the largest error (rad) of rotation vectors so close below pi, in 200 directions."""
    generator = np.random.default_rng(3)
    axes = generator.normal(size=(3, 200))
    # The three axes themselves too.
    axes[:, :3] = np.eye(3)
    axes /= np.linalg.norm(axes, axis=0)
    given = (np.pi - below_pi) * axes
    found = rotation_vector(rotation_matrix(given))
    # At pi either sign is right.
    error = np.minimum(*(np.abs(found - sign * given).max(axis=0) for sign in (1, -1)))
    reversed_ = int(np.sum(np.sum(found * given, axis=0) < 0))
    return Found("holds", float(error.max()), f"{reversed_} of 200 with the other sign")
