"""The base frame fit against the singular value decomposition, and its special cases."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dnawaves.frames.fit import fit_frames
from dnawaves.frames.standard import standard_ring
from dnawaves.helical.bases import Base
from dnawaves.helical.frames import base_frames

LETTERS = "ACGTU"
RNG = np.random.default_rng(20)


def places(letter: str) -> np.ndarray:
    return np.array(list(standard_ring(letter).values()))


def angle_deg(axes: np.ndarray, rotation: Rotation) -> float:
    """Return the angle between fitted axes (axis, component) and a rotation."""
    return float(np.degrees((Rotation.from_matrix(axes.T) * rotation.inv()).magnitude()))


@pytest.mark.parametrize("letter", LETTERS)
def test_a_moved_standard_base_gives_the_motion_back(letter: str) -> None:
    turns = Rotation.random(50, rng=RNG)
    shifts = RNG.uniform(-100, 100, (50, 3))
    moved = np.array(
        [turn.apply(places(letter)) + s for turn, s in zip(turns, shifts, strict=True)]
    )
    frames = fit_frames(places(letter), moved.T)  # (component, atoms, 50)
    for n in range(50):
        # Rounding of coordinates near 100 Å (1e-14) over a ring of 1.4 Å, and acos-free angles.
        assert angle_deg(frames.axes[:, :, n], turns[n]) < 1e-10
    np.testing.assert_allclose(frames.origin.T, shifts, atol=1e-12)


@pytest.mark.parametrize("noise_A", [0.02, 0.1, 0.3])
@pytest.mark.parametrize("letter", LETTERS)
def test_noisy_bases_agree_with_svd(letter: str, noise_A: float) -> None:
    standard = places(letter)
    turns = Rotation.random(100, rng=RNG)
    noisy = np.array([turn.apply(standard) for turn in turns])
    noisy += RNG.normal(scale=noise_A, size=noisy.shape)
    frames = fit_frames(standard, noisy.T)
    centred = standard - standard.mean(0)
    for n, observed in enumerate(noisy):
        best, _ = Rotation.align_vectors(observed - observed.mean(0), centred)
        # One Newton step leaves 5e-9 deg on crystals; here noise is up to ten times that of MD.
        assert angle_deg(frames.axes[:, :, n], best) < 1e-6
        origin = observed.mean(0) - best.apply(standard.mean(0))
        np.testing.assert_allclose(frames.origin[:, n], origin, atol=1e-7)


def test_axes_are_orthonormal_and_right_handed() -> None:
    noisy = places("G")[:, :, None] + RNG.normal(scale=0.3, size=(9, 3, 40))
    axes = fit_frames(places("G"), noisy.swapaxes(0, 1)).axes
    for n in range(40):
        np.testing.assert_allclose(axes[:, :, n] @ axes[:, :, n].T, np.eye(3), atol=1e-13)
        assert np.linalg.det(axes[:, :, n]) > 0


def test_base_frames_keep_the_order_of_bases_and_times() -> None:
    letters = "GATTC"
    bases, blocks, start = [], [], 0
    for letter in letters:
        ring = standard_ring(letter)
        bases.append(Base(letter, "A:1", tuple(ring), np.arange(start, start + len(ring))))
        blocks.append(places(letter))
        start += len(ring)
    turns = Rotation.random(3, rng=RNG)
    shifts = 10.0 * np.arange(len(letters))
    positions = np.array(
        [
            np.concatenate(
                [turn.apply(b + np.array([0, 0, s])) for b, s in zip(blocks, shifts, strict=True)]
            )
            for turn in turns
        ]
    )
    frames = base_frames(positions, bases)
    for time, turn in enumerate(turns):
        for base, shift in enumerate(shifts):
            assert angle_deg(frames.axes[:, :, base, time], turn) < 1e-10
            # 1e-10 deg at the ring's 5 Å from the origin is 1e-11 Å.
            np.testing.assert_allclose(
                frames.origin[:, base, time], turn.apply([0, 0, shift]), atol=1e-11
            )


@pytest.mark.parametrize("kept", [("C2", "N3", "C4"), ("N9", "C8", "N7", "C5")])
def test_missing_ring_atoms_three_are_enough(kept: tuple[str, ...]) -> None:
    turn = Rotation.random(rng=RNG)
    ring = standard_ring("G")
    base = Base("G", "A:1", kept, np.arange(len(kept)))
    frames = base_frames(turn.apply([ring[name] for name in kept])[None], [base])
    # With three atoms the 0.001 Å of G N3 tips the ring by 0.05 deg; a Newton step squares that.
    assert angle_deg(frames.axes[:, :, 0, 0], turn) < 1e-6


def test_fewer_than_three_ring_atoms_give_nan_for_that_base_only() -> None:
    whole = Base("T", "A:2", tuple(standard_ring("T")), np.arange(6))
    part = Base("T", "A:1", ("N1", "C2"), np.arange(2))
    frames = base_frames(places("T")[None], [part, whole])
    assert np.isnan(frames.axes[:, :, 0]).all()
    np.testing.assert_allclose(frames.axes[:, :, 1, 0], np.eye(3), atol=1e-12)


def test_atoms_on_a_line_have_no_frame() -> None:
    line = np.array([[0.0, 1.0, 2.0]] + 2 * [[0.0, 0.0, 0.0]])
    assert np.isnan(fit_frames(places("C")[:3], line[..., None]).axes).all()
