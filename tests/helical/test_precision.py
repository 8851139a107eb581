"""What rounded coordinates cost, as the note says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest

from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.dataset import helical_dataset
from dnawaves.helical.pairs import find_pairs
from dnawaves.helical.precision import coordinate_precision

Maker = Callable[[str], MDAnalysis.Universe]


@pytest.mark.parametrize(("last_place_A", "largest_deg"), [(0.001, 0.03), (0.01, 0.3)])
def test_angles_of_rounded_coordinates(
    make_universe: Maker, last_place_A: float, largest_deg: float
) -> None:
    universe = make_universe("CGATTAAGCGCGTAATGGCA")
    exact = universe.atoms.positions.astype(np.float64)
    # Many ways to lie on the grid.
    exact = exact + np.random.default_rng(0).uniform(0, 1, (100, 1, 3))
    rounded = last_place_A * np.round(exact / last_place_A)
    pairs = find_pairs(universe)
    one, other = (helical_dataset(positions, pairs) for positions in (exact, rounded))
    worst = max(
        float(np.abs(one[name] - other[name]).max())
        for name in (*PAIR_PARAMETERS[3:], *STEP_PARAMETERS[3:])
    )
    # The largest of 12,000 errors, whose tail is thin; the note rounds to one digit.
    assert 0.5 * largest_deg < worst < largest_deg


def test_xtc_tells_its_own_precision(tmp_path: Path) -> None:
    # Up to nine atoms are not rounded in this format.
    universe = MDAnalysis.Universe.empty(12, trajectory=True)
    universe.atoms.positions = np.random.default_rng(0).normal(size=(12, 3))
    for precision, place in ((3, "0.01 Å"), (5, "0.0001 Å")):
        file = tmp_path / f"{precision}.xtc"
        with MDAnalysis.Writer(str(file), 12, precision=precision) as writer:
            writer.write(universe.atoms)
        reader = MDAnalysis.Universe.empty(12, trajectory=True).load_new(str(file)).trajectory
        assert place in coordinate_precision(reader)["coordinate_precision"]


def test_binary_coordinates_are_not_rounded(make_dcd: Callable[..., Path], tmp_path: Path) -> None:
    file = make_dcd(tmp_path / "a.dcd", np.zeros((2, 3, 3)))
    reader = MDAnalysis.Universe.empty(3, trajectory=True).load_new(str(file)).trajectory
    assert coordinate_precision(reader) == {}
