"""The analysis of a trajectory and the data set it gives."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import MDAnalysis
import numpy as np
import pytest
import xarray as xr
from MDAnalysis.coordinates.memory import MemoryReader
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.helix import HELIX_PARAMETERS, helix_parameters
from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.dataset import helical_dataset, pair_frames
from dnawaves.helical.flags import ATOMS_MISSING, NO_FRAME, OPPOSED
from dnawaves.helical.form import BasePair
from dnawaves.helical.pairs import find_pairs

Maker = Callable[[str], MDAnalysis.Universe]
SEQUENCE = "CGATTAAGCG"


def analysed(universe: MDAnalysis.Universe, **run: int) -> xr.Dataset:
    return HelicalParameters(universe).run(**run).results.dataset


def screw(dataset: xr.Dataset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return axis (steps, 3), turn in degrees and advance in Å from one base pair to the next."""
    pairs = Rotation.from_matrix(dataset.axes.values[0].swapaxes(-1, -2))
    turn = pairs[1:] * pairs[:-1].inv()
    axis = turn.as_rotvec() / turn.magnitude()[:, None]
    moved = np.diff(dataset.origin.values[0], axis=0)
    return axis, np.degrees(turn.magnitude()), (axis * moved).sum(axis=1)


def test_fibre_a_tract_is_the_screw(make_universe: Maker) -> None:
    axis, turn_deg, advance_A = screw(analysed(make_universe("AAAAAAAA")))
    # Coordinates are kept in float32: 2e-6 Å at 30 Å, so 1e-4 deg over a ring of 1.4 Å.
    np.testing.assert_allclose(turn_deg, 36.0, atol=5e-4)
    np.testing.assert_allclose(advance_A, 3.375, atol=2e-5)
    np.testing.assert_allclose(axis, np.tile([0, 0, 1], (7, 1)), atol=1e-5)


def test_labels_dimensions_units(make_universe: Maker) -> None:
    dataset = analysed(make_universe(SEQUENCE))
    sizes = {"time": 1, "pair": 10, "step": 9, "strand": 2, "axis": 3, "component": 3}
    assert dict(dataset.sizes) == sizes
    assert dataset.step.values[0] == "A:1-B:10/A:2-B:9"
    assert dataset.step_sequence.values.tolist()[:3] == ["CG/CG", "GA/TC", "AT/AT"]
    assert dataset.pair_sequence.values.tolist()[:2] == ["C-G", "G-C"]
    for names in (PAIR_PARAMETERS, STEP_PARAMETERS, HELIX_PARAMETERS):
        assert [dataset[n].units for n in names] == ["angstrom"] * 3 + ["degree"] * 3
    assert dataset.time.units == "ps"
    assert dataset.origin.dims == ("time", "pair", "component")
    assert dataset.axes.dims == ("time", "pair", "axis", "component")


def test_start_stop_step_and_rigid_motion(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    still = universe.atoms.positions.astype(np.float64)
    rng = np.random.default_rng(3)
    moved = [turn.apply(still) + rng.uniform(-20, 20, 3) for turn in Rotation.random(9, rng=rng)]
    universe.load_new(np.array([still, *moved]), format=MemoryReader, dt=0.5)
    dataset = analysed(universe, start=1, stop=9, step=3)
    np.testing.assert_allclose(dataset.time, [0.5, 2.0, 3.5])
    reference = helical_dataset(still[None], find_pairs(universe))
    for name in (*PAIR_PARAMETERS, *STEP_PARAMETERS):
        # Nothing but float32 rounding of the moved coordinates: 4e-6 Å at 50 Å.
        np.testing.assert_allclose(
            dataset[name], np.tile(reference[name], (3, 1)), atol=2e-3, err_msg=name
        )


def test_many_times_are_worked_on_in_pieces_without_seams(make_universe: Maker) -> None:
    universe = make_universe("ACGT")
    still = universe.atoms.positions.astype(np.float64)
    noisy = still + np.random.default_rng(1).normal(scale=0.1, size=(433, *still.shape))
    pairs = find_pairs(universe)
    together = helical_dataset(noisy, pairs)
    for time in (0, 199, 200, 399, 400, 432):
        alone = helical_dataset(noisy[time : time + 1], pairs)
        # The same operations on the same numbers; only the order of sums may differ.
        xr.testing.assert_allclose(together.isel(time=[time]), alone, rtol=0, atol=1e-10)


def test_the_complementary_strand_read_first_changes_signs(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    rng = np.random.default_rng(8)
    universe.atoms.positions += rng.normal(scale=0.1, size=universe.atoms.positions.shape)
    there = [(f"A:{n}", f"B:{11 - n}") for n in range(1, 11)]
    back = [(second, first) for first, second in reversed(there)]
    one, other = (
        HelicalParameters(universe, pairs).run().results.dataset for pairs in (there, back)
    )
    odd = {"shear", "buckle", "shift", "tilt"}  # Dickerson et al. (1989)
    for name in (*PAIR_PARAMETERS, *STEP_PARAMETERS):
        sign = -1 if name in odd else 1
        # The same frames, mirrored exactly: round-off only.
        np.testing.assert_allclose(other[name].values[:, ::-1], sign * one[name], atol=1e-9)


def test_helical_axis_parameters_are_those_of_the_frames(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    rng = np.random.default_rng(8)
    universe.atoms.positions += rng.normal(scale=0.2, size=universe.atoms.positions.shape)
    dataset = analysed(universe)
    origin, axes = dataset.origin.values[0], dataset.axes.values[0]
    screws = helix_parameters(Frames(origin.T, axes.transpose(1, 2, 0)))
    for name, values in zip(HELIX_PARAMETERS, screws.values, strict=True):
        # Two ways to one number, each in float64; Å and degrees of order ten.
        np.testing.assert_allclose(dataset[name][0], values, atol=1e-11, err_msg=name)


def test_missing_ring_atoms_are_warned_of_and_fitted(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    whole = analysed(universe)
    part = universe.select_atoms("not (segid A and resid 3 and name N7 C8)")
    broken = MDAnalysis.Merge(part)
    with pytest.warns(UserWarning, match="A A:3 lacks C8, N7: its frame is fitted to the rest"):
        found = analysed(broken)
    # The fibre's rings are within 0.01 Å of the standard ones: some 0.5 deg on fewer atoms.
    np.testing.assert_allclose(found.twist, whole.twist, atol=0.5)
    np.testing.assert_array_equal(found.pair_flag.values[0], [0, 0, ATOMS_MISSING] + 7 * [0])


def test_a_base_without_a_ring_is_flagged_not_zero(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    stub = "not (segid A and resid 3 and not name P OP1 OP2 *' N9)"
    with pytest.warns(UserWarning, match="its frame is undefined"):
        found = analysed(MDAnalysis.Merge(universe.select_atoms(stub)))
    undefined = NO_FRAME | ATOMS_MISSING
    np.testing.assert_array_equal(found.pair_flag.values[0], [0, 0, undefined] + 7 * [0])
    np.testing.assert_array_equal(found.step_flag.values[0], [0, undefined, undefined] + 6 * [0])
    np.testing.assert_array_equal(np.isnan(found.twist), found.step_flag != 0)
    np.testing.assert_array_equal(np.isnan(found.helical_rise), found.step_flag != 0)
    np.testing.assert_array_equal(np.isnan(found.opening), found.pair_flag != 0)


def test_a_base_turned_over_exactly_is_flagged(make_universe: Maker) -> None:
    universe = make_universe("ACGT")
    pairs = find_pairs(universe)
    positions = universe.atoms.positions.astype(np.float64)
    # One T laid on another: equal frames, opposed as those of partners (strand II's z is reversed).
    first, second = pairs[0].second, pairs[3].first
    assert first.letter == second.letter == "T"
    positions[first.indices] = positions[second.indices]
    found = helical_dataset(positions[None], [BasePair(second, first), *pairs[1:3]])
    assert (found.pair_flag.values[0] & (NO_FRAME | OPPOSED)).tolist() == [OPPOSED, 0, 0]
    assert (found.step_flag.values[0] & (NO_FRAME | OPPOSED)).tolist() == [NO_FRAME, 0]


def test_strains_from_a_file_as_documented(
    make_universe: Maker, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The example of docs/frames.md, on a duplex of which each pair is lifted by 0.1 Å a frame."""
    text = (Path(__file__).parents[2] / "docs" / "frames.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    universe = make_universe("AAAAAA")
    still = universe.atoms.positions
    resids = universe.atoms.resids
    number = np.where(universe.atoms.segids == "A", resids, 7 - resids)
    lift = np.zeros_like(still)
    lift[:, 2] = 0.1 * number
    universe.load_new(np.array([still + time * lift for time in range(3)]), format=MemoryReader)
    monkeypatch.chdir(tmp_path)
    analysed(universe).to_netcdf("out.nc")
    found: dict[str, Any] = {}
    exec(example, found)
    deviations = found["deviations"]
    assert deviations.shape == (6, 5, 3)
    # The helix of the fibre goes along z, and so does the middle of its steps to some degrees:
    # the lengths of the added displacements are those of the lift. Coordinates are float32.
    lengths_A = np.linalg.norm(deviations[:3], axis=0)
    np.testing.assert_allclose(lengths_A, np.tile([0, 0.1, 0.2], (5, 1)), atol=2e-5)
    np.testing.assert_allclose(deviations[3:], 0, atol=1e-5)


def test_frames_of_each_duplex(make_universe: Maker) -> None:
    one, other = make_universe("ACGT"), make_universe("CGATTA")
    other.segments.segids = ["C", "D"]
    other.atoms.positions += np.float32([60, 0, 0])
    dataset = analysed(MDAnalysis.Merge(one.atoms, other.atoms))
    alone = analysed(other)
    found = pair_frames(dataset, duplex=2)
    assert found.origin.shape == (3, 6, 1) and found.axes.shape == (3, 3, 6, 1)
    np.testing.assert_array_equal(found.origin[..., 0].T, dataset.origin[0, 4:])
    # The same coordinates, in matrix products of another size.
    np.testing.assert_allclose(found.axes[:, :, 3, 0], alone.axes[0, 3], atol=1e-12)
    with pytest.raises(InputError, match="duplex 3: there are 1 to 2"):
        pair_frames(dataset, duplex=3)
    without = HelicalParameters(one, keep_frames=False).run().results.dataset
    with pytest.raises(InputError, match="without frames"):
        pair_frames(without)


@pytest.mark.parametrize("pairs", ["A:1", [("A:1",)], ["AB"], [(1, 24)], [1]])
def test_a_list_that_is_not_of_pairs(make_universe: Maker, pairs: Any) -> None:
    with pytest.raises(InputError, match=r'needed are pairs such as \("A:1", "B:24"\)'):
        HelicalParameters(make_universe("ACGT"), pairs)


def test_positions_of_the_wrong_shape(make_universe: Maker) -> None:
    universe = make_universe("ACGT")
    with pytest.raises(InputError, match="positions are"):
        helical_dataset(universe.atoms.positions, find_pairs(universe))
    with pytest.raises(InputError, match="no base pairs"):
        helical_dataset(universe.atoms.positions[None], [])
