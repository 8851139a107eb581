"""`dnawaves theory`: the paper's numbers in the tables, and files that hold the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml

from dnawaves.errors import InputError
from dnawaves.rod.constants import rod_from_constants
from dnawaves.rod.dispersion import lattice_frequency
from dnawaves.rod.finite_rod import FiniteRod
from dnawaves.rod.rod import Rod
from dnawaves.rod.steps import theory_step
from dnawaves.rod.summary import (
    Duplex,
    constants_table,
    modes_table,
    speeds_table,
    standing_table,
    travel_table,
)

HELD = Duplex(24, ("held", "held"))


def test_speeds_of_the_papers_rod() -> None:
    speeds = speeds_table(Rod.paper(twisted=True)).set_index("wave")["short_wave_A_per_ps"]
    # As the constants give them; the paper prints 8.2, 5.0, 8.2 and 5.03.
    expected = {"extension": 8.190, "twist": 5.056, "bend 1": 8.185, "shear 2": 5.034}
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


@pytest.mark.parametrize(("ends", "cells"), [(("free", "free"), 24), (("held", "free"), 23.5)])
def test_a_free_end_is_half_a_spacing_beyond_its_base_pair(ends: tuple, cells: float) -> None:
    duplex = Duplex(24, ends)
    assert duplex.cells == cells
    standing = standing_table(Rod.paper(), duplex, 1).set_index("wave")["frequency_GHz"]
    modes = modes_table(Rod.paper(), duplex, 12)
    for wave, motion in (("extension", "along"), ("twist", "about")):
        first = modes.loc[modes[motion] > 0.99, "frequency_GHz"].iloc[0]
        # the lattice is slower by (ka)^2/24 = 7e-4 at most; a spacing more or less is 2 % or more
        assert standing[wave] == pytest.approx(first, rel=1e-3)
    bend = modes.loc[modes["across"] > 0.9, "frequency_GHz"].iloc[0]
    # the same of 1.5 half-waves, and of shear: (1.5 pi/24)^2/12
    assert standing["bend 1"] == pytest.approx(bend, rel=4e-3)


def test_an_untwisted_anisotropic_rod_bends_in_two_planes() -> None:
    rod = Rod(
        1850.0,
        np.diag([95.0, 1050.0, 1080.0]),
        0.602214 * np.diag([350.0, 570, 1100, 290, 155, 230]),
        0.34,
    )
    table = standing_table(rod, HELD, 3)
    found = np.sort(table["frequency_GHz"].to_numpy()) / 1e3 * 2 * np.pi
    exact = FiniteRod(rod, 23 * 0.34, ("held", "held")).frequencies_rad_per_ps(12)
    # bisection to the last digits; the lowest six are among the three of each kind
    assert found[:6] == pytest.approx(exact[:6], rel=1e-9)
    assert set(table["wave"]) == {"extension", "twist", "bend 1", "bend 2"}


def test_lengths_of_a_bent_rod_are_told_along_its_axis_and_along_itself() -> None:
    rod = replace(Rod.paper(), omega0_rad_per_nm=np.array([0.0, 0.5, 1.7]))
    travel = travel_table(rod, 24)
    # the cosine of the angle between d3 and the axis of the helix
    assert (travel["length_A"] / travel["arc_length_A"]).to_numpy() == pytest.approx(
        1.7 / np.hypot(0.5, 1.7)
    )
    speeds = speeds_table(rod).set_index("wave")["long_wave_A_per_ps"]
    assert travel["travel_ps"].to_numpy() == pytest.approx(
        23 * 3.4 / speeds[travel["wave"]].to_numpy()
    )


def test_two_held_base_pairs_have_speeds_and_no_modes() -> None:
    text = theory_step(None, Duplex(2, ("held", "held")), 3, False, None, None)
    assert "8.19" in text and "--first free" in text


def test_couplings_and_offsets_are_among_the_constants() -> None:
    stiffness = Rod.paper().stiffness.copy()
    stiffness[2, 5] = stiffness[5, 2] = -90 * 0.602214
    rod = replace(
        Rod.paper(twisted=True),
        stiffness=stiffness,
        gamma0=np.array([0.0, -0.3, 0.97]),
        centre_nm=np.array([-0.118, 0.0, 0.0]),
    )
    values = constants_table(rod).set_index("constant")["value"]
    # pN nm, to the digits of the unit above
    assert values["coupling extension-twist"] == pytest.approx(-90, rel=1e-6)
    assert values["Gamma0 2"] == -0.3
    assert values["centre of mass 1"] == pytest.approx(-1.18)
    assert values["Omega0 3"] == pytest.approx(1.76)
    assert "coupling shear 1-twist" not in values


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
    # k, and k -+ the paper's twist of 0.176 rad/A
    turn = rows["laboratory_wavenumber_plus_rad_per_A"] - rows["wavenumber_rad_per_A"]
    np.testing.assert_allclose(turn, 0.176, rtol=1e-6)
    assert set(rows["frame_of_wavenumber"]) == {"cross-section"}
    assert len(pd.read_csv(modes)) == 4
    theory_step(None, HELD, 4, True, None, None, tmp_path / "tables")
    assert (tmp_path / "tables" / "modes.csv").read_text() == modes.read_text()
    assert len(list((tmp_path / "tables").iterdir())) == 5


def test_the_rod_of_the_documentation() -> None:
    page = (Path(__file__).parents[2] / "docs" / "theory.md").read_text(encoding="utf-8")
    rod = rod_from_constants(yaml.safe_load(page.split("```yaml")[1].split("```")[0]))
    # principal moments of the base pairs of crystal 355D, 1.02, 12.9 and 13.6e-34 kg m, the least
    # about axis 2, along the base pair; the page rounds to three digits
    expected = np.array([12.9, 1.02, 13.6]) / 1.66053906660e-2
    assert np.diag(rod.inertia_Da_nm) == pytest.approx(expected, rel=5e-3)


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
        ("bend_pN_nm2: [1, 2, 3]\n", "bend_pN_nm2: .*one number or two, 83 to 828 pN nm"),
        ("extension_pN: .nan\n", "extension_pN: found nan; allowed: one number, 300 to 9000 pN"),
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
