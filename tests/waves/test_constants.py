"""The table of rod constants: routes that must agree on the relaxed duplex, the paper's rod."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import scipy.sparse

from dnawaves.errors import InputError
from dnawaves.files import write_netcdf
from dnawaves.rod.limits import long_wave_speeds_A_per_ps
from dnawaves.rod.rod import Rod
from dnawaves.system.modes import normal_modes
from dnawaves.system.modes_file import modes_dataset
from dnawaves.waves.constants.gather import constants_step, paper_constants, static_constants
from dnawaves.waves.constants.rod_mass import RodMass
from dnawaves.waves.constants.segments import segment_table
from dnawaves.waves.constants.table import read_constants, rod_of, write_constants
from dnawaves.waves.table import Estimate, write_table


@pytest.fixture(scope="module")
def table(relaxed: Any, tmp_path_factory: pytest.TempPathFactory) -> pd.DataFrame:
    """Return the constants of the six relaxed base pairs, through the step's files."""
    folder = tmp_path_factory.mktemp("constants")
    duplex = relaxed.duplex
    everything = np.ones(len(duplex.masses_Da), dtype=bool)
    hessian = scipy.sparse.csr_array(relaxed.hessian)
    modes = normal_modes(hessian, duplex.masses_Da, duplex.bodies, everything)
    dataset = modes_dataset(modes, duplex, (0, 0))
    write_netcdf(folder / "modes.nc", dataset)
    name = duplex.spec.name
    rows = [
        Estimate("load", "extension", "static", 12.0, 11.0, 13.0, "spread", system=name),
        Estimate("other", "extension", "static", 5.0, 5.0, 5.0, system="another"),
        Estimate("load", "extension", "static, no load", 9.0, system=name),
    ]
    write_table(folder / "speeds.csv", rows)
    constants_step(
        relaxed.built_file.parent / "system.json",
        relaxed.built_file,
        relaxed.relaxed_file,
        folder / "constants.csv",
        folder / "modes.nc",
        [folder / "speeds.csv"],
    )
    found = read_constants(folder / "constants.csv")
    found.attrs["segments"] = segment_table(dataset)
    return found


def value(table: pd.DataFrame, route: str, quantity: str) -> float:
    rows = table[(table["route"] == route) & (table["quantity"] == quantity)]
    assert len(rows) == 1
    return float(rows["value"].iloc[0])


def test_strains_of_steps_and_motion_of_pairs_say_the_same_of_segments(table: pd.DataFrame) -> None:
    for _, row in table.attrs["segments"].iterrows():
        route = f"hessian, segments of {row['steps']:.0f} steps"
        for name, column in {
            "stretch_modulus_relaxed_pN": "extension_pN",
            "twist_rigidity_relaxed_pN_nm2": "twist_pN_nm2",
            "twist_stretch_coupling_pN_nm": "coupling_pN_nm",
            "bend_rigidity_pN_nm2": "bend_pN_nm2",
            "speed_extension_A_per_ps": "extension_A_per_ps",
            "speed_twist_A_per_ps": "twist_A_per_ps",
        }.items():
            # Two ways to one number; six digits are written, and the Hessian's rigid motions are
            # zero to 1e-6 only.
            assert value(table, route, name) == pytest.approx(row[column], rel=1e-3), name


def test_intervals_hold_their_values(table: pd.DataFrame) -> None:
    bounded = table.dropna(subset=["low", "high"])
    assert len(bounded) > 50
    assert (bounded["low"] <= bounded["value"]).all()
    assert (bounded["value"] <= bounded["high"]).all()
    assert (bounded["interval"] != "").all()


def test_the_topology_weighs_a_base_pair(table: pd.DataFrame) -> None:
    assert value(table, "topology", "mass_Da_per_bp") == pytest.approx(
        616,
        abs=25,  # four of twelve nucleotides end a strand: no phosphate at half of them
    )
    mass = {n: value(table, "topology", f"inertia_{n}_Da_A") for n in (1, 2, 3)}
    # A base pair is long along axis 2 of its frame: ten times as heavy about the two others.
    assert mass[1] / mass[2] > 5
    assert mass[3] / mass[2] > 5


def test_static_loads_give_back_the_modulus(table: pd.DataFrame) -> None:
    density = value(table, "topology", "density_Da_per_A")
    # rho V^2: one Da Å/ps² is 0.166054 pN.
    assert value(table, "static", "stretch_modulus_pN") == pytest.approx(
        density * 12.0**2 * 0.166054, rel=1e-4
    )
    assert value(table, "static", "speed_extension_A_per_ps") == 12.0
    nothing = list(static_constants([], "any", RodMass(190.0, 5000.0, 2500.0)))
    assert nothing == []


def test_the_rod_of_a_route(table: pd.DataFrame) -> None:
    route = "hessian, segments of 2 steps"
    rod = rod_of(table, route)
    speeds = long_wave_speeds_A_per_ps(rod)
    for wave, speed in speeds.items():
        # Six digits are written.
        assert speed == pytest.approx(value(table, route, f"speed_{wave}_A_per_ps"), rel=1e-4)
    mixed = rod_of(table, "static", route)
    assert mixed.stiffness[0, 0] == rod.stiffness[0, 0]
    assert mixed.stiffness[2, 2] != rod.stiffness[2, 2]
    with pytest.raises(InputError, match="found no twist_rigidity_pN_nm2 by the route 'static'"):
        rod_of(table, "static")


def test_the_papers_constants_come_back(tmp_path: Path) -> None:
    file = tmp_path / "constants.csv"
    write_constants(file, paper_constants())
    rod, paper = rod_of(read_constants(file), "paper"), Rod.paper()
    for name in ("stiffness", "inertia_Da_nm", "density_Da_per_nm", "spacing_nm"):
        # Six digits are written.
        np.testing.assert_allclose(getattr(rod, name), getattr(paper, name), rtol=1e-5)
