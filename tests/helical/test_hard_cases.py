"""What real trajectories hold: periodic images, open pairs, Z-DNA, strands that part."""

from __future__ import annotations

from collections.abc import Callable

import MDAnalysis
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from MDAnalysis.coordinates.memory import MemoryReader
from MDAnalysis.lib.mdamath import triclinic_vectors
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.frames.helix import HELIX_PARAMETERS
from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.compute import Duplexes
from dnawaves.helical.dataset import helical_dataset
from dnawaves.helical.flags import NO_FRAME, NO_HELICAL_AXIS, OPEN, Z_FORM
from dnawaves.helical.pairs import find_pairs

Maker = Callable[..., MDAnalysis.Universe]
SEQUENCE = "CGATTAAGCG"
ALL = (*PAIR_PARAMETERS, *STEP_PARAMETERS, *HELIX_PARAMETERS)


@pytest.mark.parametrize(
    "box", [[45, 50, 55, 90, 90, 90], [60, 60, 60, 60, 60, 90], [55, 52, 58, 80, 75, 70]]
)
def test_a_wrapped_trajectory_is_made_whole(make_universe: Maker, box: list[float]) -> None:
    universe = make_universe(SEQUENCE)
    rng = np.random.default_rng(4)
    still = universe.atoms.positions.astype(np.float64)
    vectors = triclinic_vectors(box).astype(np.float64)
    moved = np.array(
        [
            turn.apply(still) + rng.uniform(-1, 1, 3) @ vectors
            for turn in Rotation.random(12, rng=rng)
        ]
    )
    moved += rng.normal(scale=0.05, size=moved.shape)
    # Every atom into the box by itself: strands apart, bases torn.
    wrapped = moved - np.floor(moved @ np.linalg.inv(vectors)) @ vectors
    expected = helical_dataset(moved, find_pairs(universe))
    universe.load_new(wrapped.astype(np.float32), format=MemoryReader, dimensions=np.array(box))
    found = HelicalParameters(universe).run().results.dataset
    for name in ALL:
        # Coordinates of 60 Å in float32 are off by 4e-6 Å, angles by 2e-4 deg; x-displacement
        # and helical rise magnify that where the helical axis leans.
        np.testing.assert_allclose(found[name], expected[name], atol=5e-3, err_msg=name)
    np.testing.assert_array_equal(found.pair_flag, expected.pair_flag)


def test_a_strand_in_another_image_without_a_box_is_refused(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    still = universe.atoms.positions.copy()
    jumped = still.copy()
    jumped[universe.select_atoms("segid B").indices] += [50, 0, 0]
    universe.load_new(np.array([still, still, jumped]), format=MemoryReader)
    assert HelicalParameters(universe).run(stop=2).results.dataset.sizes["time"] == 2
    with pytest.raises(InputError, match="frame 2: the strands do not lie side by side"):
        HelicalParameters(universe).run()


def test_a_flipped_out_base_keeps_its_geometry_and_is_flagged(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    closed = universe.atoms.positions.copy()
    opened = closed.copy()
    base = universe.select_atoms("segid B and resid 4 and not name *' P OP1 OP2 O5'")
    sugar = universe.select_atoms("segid B and resid 4 and name C1'").positions[0]
    # In its plane, about C1', by 70 degrees into the groove.
    turn = Rotation.from_euler("z", 70, degrees=True)
    opened[base.indices] = turn.apply(closed[base.indices] - sugar) + sugar
    universe.load_new(np.array([closed, opened]), format=MemoryReader)
    found = HelicalParameters(universe).run().results.dataset
    assert not found.pair_flag[0].any()
    expected = np.zeros(10)
    expected[6] = OPEN
    np.testing.assert_array_equal(found.pair_flag[1], expected)
    np.testing.assert_array_equal(found.step_flag[1] & OPEN, [0] * 5 + [OPEN] * 2 + [0] * 2)
    assert np.isfinite(found.opening).all()
    # Turned about the helix axis, from which a propeller of -15 deg leans the base by half of that.
    np.testing.assert_allclose(np.abs(found.opening[1, 6]), 70, atol=4)


def test_pairs_open_at_first_close_later(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    closed = universe.atoms.positions.copy()
    frayed = closed.copy()
    frayed[universe.select_atoms("segid B and resid 1 10 and not backbone").indices] += [6, 2, 1]
    universe.load_new(np.array([frayed, closed]), format=MemoryReader)
    found = HelicalParameters(universe).run().results.dataset
    assert found.sizes["pair"] == 10
    np.testing.assert_array_equal(found.pair_flag[0] & OPEN, [OPEN] + 8 * [0] + [OPEN])
    assert not found.pair_flag[1].any()


def z_dna(pairs: int) -> tuple[Rotation, np.ndarray]:
    """Return frames with Z-DNA's two kinds of step: -9 and -51 degrees, 3.7 Å.

    Wang et al. (1979) Nature 282, 680: twelve base pairs a turn of 44.6 Å, left-handed.
    """
    twists = np.cumsum([0, *np.resize([-9.0, -51.0], pairs - 1)])
    return (
        Rotation.from_euler("z", twists[:, None], degrees=True),
        np.outer(np.arange(pairs), [0, 0, 3.7]),
    )


PARTNER = Rotation.from_euler("x", 180, degrees=True)
TURNED_OVER = Rotation.from_euler("y", 180, degrees=True)


def test_z_dna_is_turned_over_as_3dna_does(make_ideal: Maker) -> None:
    pairs, origins_A = z_dna(8)
    universe = make_ideal("CGCGCGCG", "GCGCGCGC", pairs * TURNED_OVER, origins_A, PARTNER)
    found = HelicalParameters(universe).run().results.dataset
    np.testing.assert_array_equal(found.pair_flag, np.full((1, 8), Z_FORM))
    # float32 coordinates of 30 Å over a ring of 1.4 Å.
    np.testing.assert_allclose(found.twist[0], np.resize([-9, -51], 7), atol=1e-3)
    np.testing.assert_allclose(found.rise, 3.7, atol=1e-5)
    np.testing.assert_allclose(found.helical_twist, found.twist, atol=1e-3)
    np.testing.assert_allclose(found.axes[0, :, 2], np.tile([0, 0, 1], (8, 1)), atol=1e-5)


def test_a_b_z_junction_turns_over_only_its_z_part(make_ideal: Maker) -> None:
    found = HelicalParameters(junction(make_ideal)).run().results.dataset
    assert (found.pair_flag[0] == [0] * 4 + [Z_FORM] * 4).all()
    np.testing.assert_allclose(found.twist[0], [36, 36, 36, -9, -51, -9, -51], atol=1e-3)


def test_the_z_form_is_decided_once(make_ideal: Maker) -> None:
    pairs, origins_A = z_dna(6)
    z_form = make_ideal("CGCGCG", "GCGCGC", pairs * TURNED_OVER, origins_A, PARTNER)
    b_form = make_ideal("CGCGCG", "GCGCGC", pairs, origins_A, PARTNER)
    frames = np.array([z_form.atoms.positions, b_form.atoms.positions])
    z_form.load_new(frames, format=MemoryReader)
    found = HelicalParameters(z_form).run().results.dataset
    assert (found.pair_flag == Z_FORM).all()
    z_form.trajectory[1]
    assert not HelicalParameters(z_form).run().results.dataset.pair_flag.any()


def junction(make_ideal: Maker) -> MDAnalysis.Universe:
    """Return eight pairs, four of the B form and four of the Z form."""
    turns = np.cumsum([0, 36, 36, 36, -9, -51, -9, -51])
    over = Rotation.concatenate([Rotation.identity(4), *[TURNED_OVER] * 4])
    pairs = Rotation.from_euler("z", turns[:, None], degrees=True) * over
    return make_ideal("CGATCGCG", "GCTAGCGC", pairs, np.outer(np.arange(8), [0, 0, 3.5]), PARTNER)


@pytest.mark.parametrize("strand", ["A", "B"])
@pytest.mark.parametrize("pair", [1, 2, 4, 5, 6, 8])
def test_a_pair_open_at_first_has_the_form_of_its_neighbours(
    make_ideal: Maker, pair: int, strand: str
) -> None:
    universe = junction(make_ideal)
    expected = HelicalParameters(universe).run().results.dataset
    closed = universe.atoms.positions.copy()
    opened = closed.copy()
    resid = pair if strand == "A" else 9 - pair
    base = universe.select_atoms(f"segid {strand} and resid {resid}")
    # Flipped out: turned over beside its place. Its own z tells nothing.
    flip = Rotation.from_euler("xyz", [80, 60, 20], degrees=True)
    centre = base.center_of_geometry()
    opened[base.indices] = flip.apply(closed[base.indices] - centre) + centre + np.array([7, 7, 9])
    universe.load_new(np.array([opened, closed]), format=MemoryReader)
    listed = [(f"A:{n}", f"B:{9 - n}") for n in range(1, 9)]
    found = HelicalParameters(universe, listed).run().results.dataset
    assert found.pair_flag[0, pair - 1] & OPEN
    # At the junction the pairs on both sides are as near: the one before decides.
    forms = np.array([0] * 4 + [Z_FORM] * 4)
    forms[pair - 1] = forms[max(0, pair - 2)] if pair > 1 else 0
    np.testing.assert_array_equal(found.pair_flag[1], forms)
    if pair != 5:
        for name in ALL:
            # Sums over one and over two frames differ by round-off: 1e-15 Å over 1.4 Å, in degrees.
            np.testing.assert_allclose(found[name][1], expected[name][0], atol=1e-9, err_msg=name)


@pytest.mark.parametrize("box", [None, [60, 60, 60, 90, 90, 90], [70, 70, 70, 80, 75, 70]])
@pytest.mark.parametrize("missing", [1, 4, 8])
def test_a_base_without_a_frame_leaves_its_neighbours_their_form(
    make_ideal: Maker, missing: int, box: list[float] | None
) -> None:
    pairs, origins_A = z_dna(8)
    universe = make_ideal("CGCGCGCG", "GCGCGCGC", pairs * TURNED_OVER, origins_A, PARTNER)
    universe.dimensions = box
    universe.select_atoms(f"segid A and resid {missing} and not name C1' C2 N3").names = "X"
    listed = [(f"A:{n}", f"B:{9 - n}") for n in range(1, 9)]
    with pytest.warns(UserWarning, match="its frame is undefined"):
        found = HelicalParameters(universe, listed).run().results.dataset
    assert (found.pair_flag[0] & Z_FORM).all()
    known = [n for n in range(7) if n + 1 != missing and n + 2 != missing]
    # float32 coordinates of 30 Å over a ring of 1.4 Å.
    np.testing.assert_allclose(found.twist[0, known], np.resize([-9, -51], 7)[known], atol=1e-3)


@pytest.mark.parametrize("lost", [[1], [4, 5], [10]])
@pytest.mark.parametrize("strand", ["A", "B"])
def test_a_base_at_nan_loses_its_own_pair_only(
    make_universe: Maker, lost: list[int], strand: str
) -> None:
    universe = make_universe(SEQUENCE)
    still = universe.atoms.positions.copy()
    expected = HelicalParameters(universe).run().results.dataset
    box = np.array([40.0, 42.0, 44.0, 90.0, 90.0, 90.0])
    wrapped = np.mod(still + np.array([7, 11, 13]), box[:3]).astype(np.float32)
    gap = wrapped.copy()
    resids = [n if strand == "A" else 11 - n for n in lost]
    gap[universe.select_atoms(f"segid {strand} and resid {' '.join(map(str, resids))}").indices] = (
        np.nan
    )
    universe.load_new(np.array([wrapped, gap]), format=MemoryReader, dimensions=box)
    found = HelicalParameters(universe).run().results.dataset
    kept = [n for n in range(10) if n + 1 not in lost]
    steps = [n for n in range(9) if n + 1 not in lost and n + 2 not in lost]
    np.testing.assert_array_equal(np.isnan(found.shear[1]), [n + 1 in lost for n in range(10)])
    np.testing.assert_array_equal(
        (found.pair_flag[1] & NO_FRAME) > 0, [n + 1 in lost for n in range(10)]
    )
    for names, places, axis in ((PAIR_PARAMETERS, kept, "pair"), (STEP_PARAMETERS, steps, "step")):
        for name in names:
            # Coordinates of 40 Å in float32 are off by 4e-6 Å, angles by 2e-4 deg.
            np.testing.assert_allclose(
                found[name][1].isel({axis: places}),
                expected[name][0].isel({axis: places}),
                atol=1e-3,
                err_msg=name,
            )


def test_half_a_strand_in_another_image_in_a_later_frame_is_refused(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    still = universe.atoms.positions.copy()
    jumped = still.copy()
    jumped[universe.select_atoms("segid B and resid 1:3").indices] += [50, 0, 0]
    universe.load_new(np.array([still, jumped]), format=MemoryReader)
    with pytest.raises(InputError, match="frame 1: the strands do not lie side by side"):
        HelicalParameters(universe).run()


def test_an_end_that_melts_stays_in_the_analysis(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    still = universe.atoms.positions.copy()
    melted = still.copy()
    # 16 Å a nucleotide, less than a jump: the chain's last three are 16, 32 and 48 Å away.
    for number in (1, 2, 3):
        part = universe.select_atoms(f"segid B and resid {number}")
        melted[part.indices] += [16 * (4 - number), 0, 0]
    universe.load_new(np.array([still, melted]), format=MemoryReader)
    found = HelicalParameters(universe).run().results.dataset
    np.testing.assert_array_equal(found.pair_flag[1] & OPEN, [0] * 7 + [OPEN] * 3)
    assert np.isfinite(found.shear).all()


def test_no_turn_has_no_helical_axis(make_ideal: Maker) -> None:
    origins_A = np.outer(np.arange(3), [0, 0, 3.4])
    universe = make_ideal("GGG", "CCC", Rotation.identity(3), origins_A, PARTNER)
    pairs = find_pairs(universe)
    positions = universe.atoms.positions.astype(np.float64)
    # In float64, so that pairs are turned against each other by round-off only.
    for strand in ("first", "second"):
        rings = [getattr(pair, strand).indices for pair in pairs]
        for number in (1, 2):
            positions[rings[number]] = positions[rings[0]] + [0, 0, 3.4 * number]
    found = helical_dataset(positions[None], pairs)
    assert (found.step_flag == NO_HELICAL_AXIS).all()
    assert np.isnan(found.helical_twist).all() and np.isnan(found.tip).all()
    # 1e-14 Å over a ring of 1.4 Å, in degrees, times a hundred for the Newton step of G.
    np.testing.assert_allclose(found.twist, 0, atol=1e-10)
    np.testing.assert_allclose(found.rise, 3.4, atol=1e-10)


numbers = st.floats(-1, 1)


@settings(max_examples=25, deadline=None)
@given(st.tuples(numbers, numbers, numbers, numbers), st.tuples(numbers, numbers, numbers))
def test_rigid_motions_change_nothing(
    make_universe: Maker,
    quaternion: tuple[float, float, float, float],
    shift: tuple[float, float, float],
) -> None:
    universe = make_universe(SEQUENCE)
    noise = np.random.default_rng(2).normal(scale=0.1, size=universe.atoms.positions.shape)
    still = universe.atoms.positions + noise
    # The last part away from 0: a quaternion of length 0 is no rotation.
    turn = Rotation.from_quat([*quaternion[:3], quaternion[3] + 1.5])
    moved = turn.apply(still) + 100 * np.array(shift)
    pairs = find_pairs(universe)
    one, other = (helical_dataset(positions[None], pairs) for positions in (still, moved))
    for name in ALL:
        # Round-off of coordinates of 100 Å, 1e-14, over a ring of 1.4 Å, in degrees: 1e-12.
        np.testing.assert_allclose(other[name], one[name], atol=1e-9, err_msg=name)


def test_float32_coordinates_are_worked_on_in_float64(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    positions = universe.atoms.positions[None] + np.float32(100)
    assert positions.dtype == np.float32
    pairs = find_pairs(universe)
    one, other = (helical_dataset(p, pairs) for p in (positions, positions.astype(np.float64)))
    for name in ALL:
        np.testing.assert_array_equal(one[name], other[name])


def test_without_frames_the_numbers_are_the_same(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    full, lean = (
        HelicalParameters(universe, keep_frames=keep).run().results.dataset
        for keep in (True, False)
    )
    assert set(full) - set(lean) == {
        f"{of}{what}" for of in ("base_", "", "step_") for what in ("origin", "axes")
    }
    assert full[list(lean)].equals(lean)
    pairs = find_pairs(universe)
    sizes = [Duplexes(pairs, keep).bytes_per_time() for keep in (True, False)]
    assert sizes[0] > 3.5 * sizes[1]


def test_frames_of_bases_pairs_and_steps_hang_together(make_universe: Maker) -> None:
    found = HelicalParameters(make_universe(SEQUENCE)).run().results.dataset.isel(time=0)
    for name in ("base_axes", "axes", "step_axes"):
        axes = found[name].values
        identity = np.broadcast_to(np.eye(3), axes.shape)
        np.testing.assert_allclose(axes @ axes.swapaxes(-1, -2), identity, atol=1e-12)
    middle = found.base_origin.mean("strand")
    np.testing.assert_allclose(middle.transpose(*found.origin.dims), found.origin, atol=1e-12)
    # The pair's z is half way between those of its bases, strand II's reversed.
    z = found.base_axes.sel(axis="z")
    both = z.sel(strand="I") - z.sel(strand="II")
    both = both / np.sqrt((both**2).sum("component"))
    np.testing.assert_allclose(both, found.axes.sel(axis="z"), atol=1e-12)
    # Shift, slide and rise are the way from pair to pair along the mid-step axes.
    way = np.diff(found.origin.values, axis=0)
    along = np.einsum("sac,sc->as", found.step_axes.values, way)
    for name, values in zip(("shift", "slide", "rise"), along, strict=True):
        np.testing.assert_allclose(found[name], values, atol=1e-12)
