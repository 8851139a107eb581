"""Published and independently computed tables: 3DNA, cpptraj, the fibre's own screw."""

from __future__ import annotations

import csv
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.analysis import HelicalParameters

pytestmark = [
    pytest.mark.filterwarnings("ignore::UserWarning:MDAnalysis"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:MDAnalysis"),
]

# 3DNA prints 2 decimals, cpptraj 4 (and PDB coordinates have 3, the same for both).
CASES = {
    "dickerson_355d": 0.0051,
    "adna_2d94": 0.0051,
    "tc3_1tc3": 0.0051,
    "fibre_bdna_12": 1e-4,
    "fibre_adna_12": 1e-4,
}


def rows(file: Path) -> list[dict[str, str]]:
    with open(file, encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def dataset(folder: Path, given: bool) -> xr.Dataset:
    universe = MDAnalysis.Universe(folder / "structure.pdb")
    pairs = [
        (f"{row['chain1']}:{row['resid1']}", f"{row['chain2']}:{row['resid2']}")
        for row in rows(folder / "pairs.csv")
    ]
    return HelicalParameters(universe, pairs if given else None).run().results.dataset


@pytest.mark.parametrize("case", CASES)
def test_table(shared: Path, case: str) -> None:
    folder = shared / "reference" / "helical" / case
    found = dataset(folder, given=True)
    for file, names in (("bp", PAIR_PARAMETERS), ("step", STEP_PARAMETERS)):
        expected = rows(folder / f"expected_{file}.csv")
        for name in names:
            wanted = np.array([float(row[name] or "nan") for row in expected])
            off = found[name].values[0] - wanted
            if name in names[3:]:
                off = (off + 180) % 360 - 180
            known = np.isfinite(wanted)
            assert known.any()
            assert np.abs(off[known]).max() <= CASES[case], name


@pytest.mark.parametrize("case", ["dickerson_355d", "adna_2d94", "fibre_bdna_12", "fibre_adna_12"])
def test_pairs_are_found_as_listed(shared: Path, case: str) -> None:
    folder = shared / "reference" / "helical" / case
    xr.testing.assert_identical(dataset(folder, given=False), dataset(folder, given=True))


def test_pairs_in_a_protein_complex(shared: Path) -> None:
    folder = shared / "reference" / "helical" / "tc3_1tc3"
    found, listed = dataset(folder, given=False), dataset(folder, given=True)
    # A:1 and B:120 are complementary, but 19 Å apart in the crystal.
    xr.testing.assert_identical(found, listed)


def test_fibre_screw(shared: Path) -> None:
    found = dataset(shared / "reference" / "helical" / "fibre_polyA_12", given=True)
    pairs = Rotation.from_matrix(found.axes.values[0].swapaxes(-1, -2))
    turn = pairs[1:] * pairs[:-1].inv()
    axis = turn.as_rotvec() / turn.magnitude()[:, None]
    advance_A = (axis * np.diff(found.origin.values[0], axis=0)).sum(axis=1)
    # What coordinates rounded to 0.001 Å allow.
    np.testing.assert_allclose(np.degrees(turn.magnitude()), 36.0, atol=0.02)
    np.testing.assert_allclose(advance_A, 3.375, atol=0.001)
