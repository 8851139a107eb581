"""`dnawaves theory`: the paper's numbers in the tables, and files that hold the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import lattice_frequency
from dnawaves.rod.rod import Rod
from dnawaves.rod.steps import theory_step
from dnawaves.rod.summary import Duplex, modes_table, speeds_table, standing_table, travel_table

HELD = Duplex(24, ("held", "held"))


def test_speeds_of_the_papers_rod() -> None:
    speeds = speeds_table(Rod.paper(twisted=True)).set_index("wave")["short_wave_A_per_ps"]
    # As the constants give them; the paper prints 8.2, 5.0, 8.2 and 5.03.
    expected = {"extension": 8.190, "twist": 5.056, "bend": 8.185, "shear": 5.034}
    for wave, speed in expected.items():
        assert speeds[wave] == pytest.approx(speed, abs=5e-4)


def test_travel_time_is_the_length_between_the_end_pairs_over_the_speed() -> None:
    travel = travel_table(Rod.paper(), 24).set_index("wave")["travel_ps"]
    assert travel["extension"] == pytest.approx(23 * 3.4 / 8.190, rel=1e-4)


def test_the_rule_of_half_waves_holds_for_extension_and_twist_only() -> None:
    ratio = standing_table(Rod.paper(twisted=True), HELD, 3).set_index(["wave", "mode"])["ratio"]
    # Bisection to the last digits.
    np.testing.assert_allclose(ratio[["extension", "twist"]], 1, rtol=1e-12)
    # Timoshenko's clamped rod of 23 steps, lengths of 24 steps give 2.08, 1.38, 1.19.
    np.testing.assert_allclose(ratio["bend"], [2.07, 1.37, 1.18], atol=0.005)


def test_the_lattices_own_modes_of_extension_are_those_of_the_chain() -> None:
    modes = modes_table(Rod.paper(), HELD, 30)
    extension = modes.loc[modes["along"] > 0.99, "frequency_GHz"].to_numpy()
    wavenumbers = np.arange(1, len(extension) + 1) * np.pi / (23 * 0.34)
    chain = lattice_frequency(wavenumbers, 8.190283593, 0.34) * 1e3 / (2 * np.pi)
    np.testing.assert_allclose(extension, chain, rtol=1e-9)  # digits of the speed above
    shares = modes[["along", "across", "about", "tilt"]].sum(axis=1)
    np.testing.assert_allclose(shares, 1, atol=1e-9)  # round-off of normalised shapes


def test_files_hold_the_same_relation(tmp_path: Path) -> None:
    table, dataset, modes = tmp_path / "d.csv", tmp_path / "d.nc", tmp_path / "modes.csv"
    text = theory_step(None, HELD, 4, True, table, modes)
    theory_step(None, HELD, 4, True, dataset, None)
    assert "8.19" in text and "Lowest modes" in text
    rows = pd.read_csv(table)
    with xr.open_dataset(dataset) as relation:
        stored = relation["angular_frequency"].values.ravel()
    # The table has ten digits.
    np.testing.assert_allclose(rows["angular_frequency_rad_per_ps"], stored, rtol=1e-9)
    assert len(pd.read_csv(modes)) == 4


def test_a_rod_of_the_users(tmp_path: Path) -> None:
    rod = tmp_path / "rod.yaml"
    rod.write_text(
        "density_Da_per_nm: 1800\ninertia_Da_nm: [250, 250, 500]\nshear_pN: 800\n"
        "extension_pN: 1100\nbend_pN_nm2: 206\ntwist_pN_nm2: 410\n"
    )
    text = theory_step(rod, Duplex(12, ("free", "pinned")), 3, False, None, None)
    # sqrt(1100 pN / (1800 Da/nm)), 1 pN = 0.60221 Da nm/ps^2
    assert f"{10 * np.sqrt(1100 * 0.602214 / 1800):.3f}" in text


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("density_Da_per_nm: -1\n", "density_Da_per_nm: found -1"),
        ("densty: 3\n", "densty: found no such constant"),
        ("3\n", "found no mapping"),
    ],
)
def test_a_bad_rod_is_refused_by_name(tmp_path: Path, content: str, message: str) -> None:
    rod = tmp_path / "rod.yaml"
    rod.write_text(content)
    with pytest.raises(InputError, match=message):
        theory_step(rod, HELD, 3, False, None, None)


def test_an_unknown_format_is_refused_before_anything_is_computed(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"found '.txt'; allowed: .csv or .nc"):
        theory_step(None, HELD, 3, False, tmp_path / "d.txt", None)
