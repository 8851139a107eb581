"""Base pairs in time: frames that move with their bodies, velocities of a duplex that tumbles."""

from __future__ import annotations

import numpy as np
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.frames.fit import Frames
from dnawaves.frames.strain import step_strains
from dnawaves.motion.pair_frames import following_velocities, frames_in_time

Array = NDArray[np.float64]

PAIRS, TIMES = 8, 3
DIMS = ("sign", "time", "pair", "xyz")


def record(tumble: Rotation, shift: Array, seed: int) -> xr.Dataset:
    """Return a record of small random motion, seen from a laboratory that is turned and shifted."""
    rng = np.random.default_rng(seed)
    centre = np.outer(3.4 * np.arange(PAIRS), [0.0, 0.0, 1.0]) + rng.normal(0, 1, (PAIRS, 3))
    moved = centre + rng.normal(0, 0.1, (TIMES, PAIRS, 3))
    turned = Rotation.from_rotvec(rng.normal(0, 0.1, (TIMES * PAIRS, 3)))
    spread = rng.normal(0, 1, (PAIRS, 3, 3))
    second = 100 * np.eye(3) + spread @ spread.transpose(0, 2, 1)
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    velocities = {name: rng.normal(0, 1, (TIMES, PAIRS, 3)) for name in ("linear", "angular")}
    turn = tumble.as_matrix()
    return xr.Dataset(
        {
            "displacement": (DIMS, (moved @ turn.T + shift - centre)[np.newaxis]),
            "rotation": (DIMS, (tumble * turned).as_rotvec().reshape(1, TIMES, PAIRS, 3)),
            "velocity": (DIMS, (velocities["linear"] @ turn.T)[np.newaxis]),
            "angular_velocity": (DIMS, (velocities["angular"] @ turn.T)[np.newaxis]),
            "mass": ("pair", rng.uniform(500, 700, PAIRS)),
            "inertia": (("pair", "xyz", "abc"), inertia),
            "centre": (("pair", "xyz"), centre),
            "pivot": (("pair", "xyz"), centre + rng.normal(0, 1, (PAIRS, 3))),
            "direction": (("axis", "xyz"), np.eye(3)),
        },
        coords={"axis": ["first", "second", "helix"]},
    )


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.tuples(*[st.floats(-1.5, 1.5)] * 3))
def test_velocities_do_not_know_how_the_duplex_lies(seed: int, turn: tuple[float, ...]) -> None:
    straight = following_velocities(record(Rotation.identity(), np.zeros(3), seed))
    tumbled = following_velocities(record(Rotation.from_rotvec(turn), np.array([5.0, -3, 8]), seed))
    for wave, velocity in straight.items():
        # Round-off of rotations of positions of 30 Å.
        np.testing.assert_allclose(tumbled[wave], velocity, atol=1e-9)


def test_strains_do_not_know_how_the_duplex_lies() -> None:
    rng = np.random.default_rng(1)
    axes = Rotation.from_rotvec(rng.normal(0, 0.1, (PAIRS, 3))).as_matrix()
    places = np.outer([0.0, 0.0, 3.4], np.arange(PAIRS))
    reference = Frames(places, axes.transpose(2, 1, 0))
    tumble = Rotation.from_rotvec([0.4, -0.9, 0.3])
    strains = [
        step_strains(frames_in_time(record(turn, shift, 2), reference)).values
        for turn, shift in ((Rotation.identity(), np.zeros(3)), (tumble, np.ones(3)))
    ]
    np.testing.assert_allclose(strains[0], strains[1], atol=1e-9)  # round-off


def test_frames_at_rest_are_the_reference() -> None:
    rng = np.random.default_rng(3)
    still = record(Rotation.identity(), np.zeros(3), 4)
    still["displacement"] = xr.zeros_like(still["displacement"])
    still["rotation"] = xr.zeros_like(still["rotation"])
    axes = Rotation.from_rotvec(rng.normal(0, 1, (PAIRS, 3))).as_matrix().transpose(2, 1, 0)
    reference = Frames(rng.normal(0, 5, (3, PAIRS)), axes)
    frames = frames_in_time(still, reference)
    np.testing.assert_allclose(frames.origin[..., 0], reference.origin, atol=1e-12)
    np.testing.assert_allclose(frames.axes[..., 0], reference.axes, atol=1e-12)
