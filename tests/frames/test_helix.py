"""Local helical parameters: regular helices, 3DNA's own numbers, and the places without an axis."""

from __future__ import annotations

import csv
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from dnawaves.frames.fit import Frames, fit_frames
from dnawaves.frames.helix import helix_parameters, screw_parameters
from dnawaves.frames.parameters import pair_parameters
from dnawaves.frames.standard import standard_ring

# Printed by 3DNA v2.1 for its own examples, PDB entries 355D and 2D94 (Lu & Olson 2003, 2008):
# x-displacement, y-displacement, helical rise, inclination, tip, helical twist.
PRINTED_BY_3DNA = {
    "dickerson_355d": [
        [-1.27, -0.65, 3.09, 14.77, 5.57, 33.94],
        [1.79, -0.36, 3.52, -11.95, -3.76, 44.84],
        [-1.40, 0.52, 2.98, 24.46, -2.09, 27.52],
        [-0.40, 0.49, 3.40, 2.13, 2.46, 37.56],
        [-0.57, -0.31, 3.29, 0.71, 0.51, 37.52],
        [-0.61, -0.03, 3.26, -4.78, 0.56, 32.51],
        [-0.53, 0.41, 3.22, -1.68, -2.89, 33.80],
        [-0.13, 0.45, 3.47, -2.34, -0.95, 42.17],
        [0.66, -2.36, 3.03, 8.97, 7.84, 27.14],
        [1.47, 1.50, 3.30, -12.97, 3.95, 42.69],
        [-0.69, 0.42, 3.16, 11.53, 1.17, 33.96],
    ],
    "adna_2d94": [
        [-3.76, -0.21, 2.85, 16.48, -5.03, 35.01],
        [-4.41, -0.71, 2.92, 12.75, 3.44, 30.78],
        [-2.49, -0.37, 3.29, 2.70, -0.44, 37.81],
        [-7.17, 0.00, 2.37, 10.26, 0.00, 21.14],
        [-2.49, 0.37, 3.29, 2.70, 0.44, 37.81],
        [-4.41, 0.71, 2.92, 12.75, -3.44, 30.78],
        [-3.76, 0.21, 2.85, 16.48, 5.03, 35.01],
    ],
}
PLACE = np.array([3.0, -40.0, 7.0])
TURN = Rotation.from_rotvec([0.4, -1.1, 0.7])


def frames(origins: np.ndarray, rotations: Rotation) -> Frames:
    """Return frames over (pairs,) from origins (pairs, 3)."""
    return Frames(origins.T, rotations.as_matrix().transpose(2, 1, 0))


def about(axis: list[int], angles_deg: np.ndarray | list[float]) -> Rotation:
    return Rotation.from_rotvec(np.outer(angles_deg, axis), degrees=True)


def regular_helix(values: np.ndarray, pairs: int) -> Frames:
    """Return the pairs of a regular helix about z, then moved to some place as a whole.

    Each pair stands at (x, y) from the axis and leans by the rotation vector (inclination, tip, 0),
    both in the axes that turn with the helix.
    """
    turns = about([0, 0, 1], np.arange(pairs) * values[5])
    heights = np.outer(np.arange(pairs), [0, 0, values[2]])
    lean = Rotation.from_rotvec([values[3], values[4], 0], degrees=True)
    origins = turns.apply([values[0], values[1], 0]) + heights
    return frames(PLACE + TURN.apply(origins), TURN * turns * lean)


def paired_frames(folder: Path) -> Frames:
    """Return the frames of the pairs of a structure in the folder of reference tables."""
    universe = MDAnalysis.Universe(folder / "structure.pdb")
    with open(folder / "pairs.csv", encoding="utf-8") as file:
        pairs = list(csv.DictReader(file))
    strands = []
    for strand in "12":
        fitted = []
        for pair in pairs:
            ring = standard_ring(pair[f"base{strand}"])
            residue = universe.select_atoms(
                f"chainID {pair[f'chain{strand}']} and resid {pair[f'resid{strand}']}"
            )
            places = dict(zip(residue.names, residue.positions.astype(np.float64), strict=True))
            positions = np.array([places[name] for name in ring]).T
            fitted.append(fit_frames(np.array(list(ring.values())), positions))
        origins, axes = zip(*fitted, strict=True)
        strands.append(Frames(np.stack(origins, -1), np.stack(axes, -1)))
    return pair_parameters(*strands).middle


leaning = st.floats(-60, 60)
lengths = st.floats(-10, 10)


@settings(max_examples=200, deadline=None)
@given(
    st.tuples(lengths, lengths, lengths, leaning, leaning, st.floats(1, 179.9)),
    st.sampled_from([1, -1]),
)
def test_a_regular_helix_gives_back_what_it_was_built_from(
    values: tuple[float, ...], handedness: int
) -> None:
    # Two leans of 60 degrees make 85 together: short of 90, where the axis would point back.
    given_values = np.array(values) * [1, 1, 1, 1, 1, handedness]
    found = helix_parameters(regular_helix(given_values, pairs=4))
    expected = np.repeat(given_values[:, np.newaxis], 3, axis=1)
    # Round-off of coordinates of 40 Å, 7e-15, over the smallest twist squared, (0.017)^2.
    np.testing.assert_allclose(found.values, expected, atol=1e-9)
    assert not found.unrotated.any()


@pytest.mark.parametrize("case", ["dickerson_355d", "adna_2d94"])
def test_as_3dna(shared: Path, case: str) -> None:
    found = helix_parameters(paired_frames(shared / "reference" / "helical" / case))
    # 3DNA prints two decimals.
    np.testing.assert_allclose(found.values.T, PRINTED_BY_3DNA[case], atol=0.0051)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6))
def test_the_screw_about_the_axis_carries_the_first_pair_into_the_second(seed: int) -> None:
    random = np.random.default_rng(seed)
    origins = random.uniform(-10, 10, (2, 3))
    rotations = Rotation.random(2, rng=random)
    pairs = frames(origins, rotations)
    found = helix_parameters(pairs)
    _, _, rise, _, _, twist = found.values[:, 0]
    point, along = found.middle.origin[:, 0], found.middle.axes[2, :, 0]
    screw = Rotation.from_rotvec(twist * along, degrees=True)
    # A twist below 6 degrees, one in 10^4 random rotations, would put the axis 100 Å away.
    np.testing.assert_allclose(
        point + screw.apply(origins[0] - point) + rise * along, origins[1], atol=1e-9
    )
    np.testing.assert_allclose((screw * rotations[0]).as_matrix(), rotations[1].as_matrix())
    # Lu & Olson (2003): the axis along (x2 - x1) x (y2 - y1).
    (x1, y1, _), (x2, y2, _) = pairs.axes.transpose(2, 0, 1)
    theirs = np.cross(x2 - x1, y2 - y1)
    np.testing.assert_allclose(theirs / np.linalg.norm(theirs), along, atol=1e-9)
    axes = found.middle.axes[..., 0]
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)


def test_read_from_the_other_strand_y_displacement_and_tip_change_sign() -> None:
    pairs = regular_helix(np.array([-4.4, 0.7, 2.9, 12.8, -3.4, 30.8]), pairs=2)
    x, y, z = pairs.axes
    reversed_pairs = Frames(pairs.origin[:, ::-1], np.stack([x, -y, -z])[..., ::-1])
    there, back = (helix_parameters(p).values[:, 0] for p in (pairs, reversed_pairs))
    np.testing.assert_allclose(back, there * [1, -1, 1, 1, -1, 1], atol=1e-10)


def test_a_mere_translation_has_no_axis_and_says_so() -> None:
    stacked = frames(np.outer(np.arange(3), [0.2, 0.1, 3.4]), Rotation.concatenate([TURN] * 3))
    turned = regular_helix(np.array([1, 0, 3.4, 0, 0, 36.0]), pairs=3)
    both = Frames(
        np.stack([stacked.origin, turned.origin], -1), np.stack([stacked.axes, turned.axes], -1)
    )
    with np.errstate(all="raise"):
        found = helix_parameters(both)
    np.testing.assert_array_equal(found.unrotated, [[True, False]] * 2)
    assert np.isnan(found.values[..., 0]).all() and np.isnan(found.middle.axes[..., 0]).all()
    assert np.isfinite(found.values[..., 1]).all()


def test_a_frame_that_is_missing_is_no_translation() -> None:
    pairs = regular_helix(np.array([1, 0, 3.4, 0, 0, 36.0]), pairs=3)
    pairs.axes[..., 1] = np.nan
    with np.errstate(all="raise"):
        found = helix_parameters(pairs)
    assert np.isnan(found.values).all() and not found.unrotated.any()


@pytest.mark.parametrize("twist_deg", [1e-1, 1e-2, 1e-3, 1e-4])
def test_small_twists(twist_deg: float) -> None:
    values = np.array([0, 0, 3.4, 0, 0, twist_deg])
    start, end = np.zeros(3), np.array([0, 0.5, 3.4])
    turned = about([0, 0, 1], [0, twist_deg])
    found = helix_parameters(frames(np.array([start, end]), turned)).values[:, 0]
    # A slide of 0.5 Å is the chord of the arc about an axis at slide/(2 tan(twist/2)) along x.
    half = np.radians(twist_deg) / 2
    values[:2] = 0.5 / (2 * np.tan(half)), -0.25
    # The angle itself is known to 1e-16 rad.
    relative = 1e-15 / half
    np.testing.assert_allclose(found, values, rtol=relative, atol=1e-10)


@pytest.mark.parametrize("twist_deg", [180.0, 179.999999, -179.999999, 90.0])
def test_half_a_turn(twist_deg: float) -> None:
    values = np.array([0.5, -1.0, 3.4, 12.0, -8.0, twist_deg])
    found = helix_parameters(regular_helix(values, pairs=2)).values[:, 0]
    # +180 and -180 degrees are one rotation.
    found[5], values[5] = abs(found[5]), abs(twist_deg)
    np.testing.assert_allclose(found, values, atol=1e-9)


def test_no_inclination_at_all() -> None:
    values = np.array([1.0, -2.0, 3.4, 0.0, 0.0, 36.0])
    straight = about([0, 0, 1], [0, 36])
    origins = straight.apply([1, -2, 0]) + np.outer([0, 1], [0, 0, 3.4])
    found = helix_parameters(frames(origins, straight)).values[:, 0]
    # z1 and z2 are equal bit by bit: inclination and tip must be 0, not 0/0.
    np.testing.assert_allclose(found, values, atol=1e-14)


def test_an_axis_in_the_plane_of_the_pair() -> None:
    rolled = about([0, 1, 0], [0, 10])
    found = screw_parameters(
        frames(np.zeros((1, 3)), rolled[:1]), frames(np.array([[0, 2.0, 3.4]]), rolled[1:])
    ).values[:, 0]
    # A roll alone: the axis is y itself, inclined by 90 degrees; slide is the rise along it.
    np.testing.assert_allclose(found[2:], [2.0, 90, 0, 10], atol=1e-12)
