"""Stiffness of segments against chains whose stiffness is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from dnawaves.files import write_netcdf
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.segments import segment_table, segments_step

PAIRS = 16
SPACING_A = 3.3
MASS_DA = 610.0
INERTIA_DA_A2 = 30_000.0
COORDINATES = ["extension", "twist", "bend", "bend_across"]
# Of one step: extension and twist coupled, two unequal bends; kJ/mol per Å², Å rad and rad².
STEP = np.array(
    [
        [60.0, -40.0, 0.0, 0.0],
        [-40.0, 220.0, 0.0, 0.0],
        [0.0, 0.0, 100.0, 0.0],
        [0.0, 0.0, 0.0, 300.0],
    ]
)


def modes_of(covariance: np.ndarray) -> xr.Dataset:
    """Return what the modes' file holds, from the covariance per kBT (pair, 4, pair, 4)."""
    return xr.Dataset(
        {
            "axis_compliance": (
                ("pair", "coordinate", "other_pair", "other_coordinate"),
                covariance,
            ),
            "mass": ("pair", np.full(PAIRS, MASS_DA)),
            "axial_inertia": ("pair", np.full(PAIRS, INERTIA_DA_A2)),
        },
        coords={
            "coordinate": COORDINATES,
            "other_coordinate": COORDINATES,
            "height": ("pair", SPACING_A * np.arange(PAIRS)),
        },
    )


def uniform_chain() -> xr.Dataset:
    """Steps that fluctuate independently of each other: pair n has moved by n of them."""
    counts = np.minimum.outer(np.arange(PAIRS), np.arange(PAIRS)).astype(float)
    return modes_of(np.einsum("pq,cd->pcqd", counts, np.linalg.inv(STEP)))


def test_segments_of_a_uniform_chain_are_all_alike() -> None:
    table = segment_table(uniform_chain())
    schur = STEP[0, 0] - STEP[0, 1] ** 2 / STEP[1, 1]
    # kJ/mol/Å² times Å is 10 kJ/mol/nm.
    extension_pN = schur * SPACING_A * 10 / KJ_PER_MOL_PER_PN_NM
    # Round-off of sums of some ten numbers.
    np.testing.assert_allclose(table["extension_pN"], extension_pN, rtol=1e-12)
    coupling = STEP[0, 1] * SPACING_A / KJ_PER_MOL_PER_PN_NM
    np.testing.assert_allclose(table["coupling_pN_nm"], coupling, rtol=1e-12)
    # Long bends load both axes alike: 2/(1/100 + 1/300) = 150.
    bend = 150 * SPACING_A / 10 / KJ_PER_MOL_PER_PN_NM
    np.testing.assert_allclose(table["bend_pN_nm2"], bend, rtol=1e-12)


def test_speeds_are_those_of_the_coupled_chains_long_waves() -> None:
    speeds = segment_table(uniform_chain())[["extension_A_per_ps", "twist_A_per_ps"]].iloc[0]
    stiffness, mass = STEP[:2, :2], np.diag([MASS_DA, INERTIA_DA_A2])
    # 1 kJ/mol = 100 Da Å²/ps²; omega = k a sqrt(K/M) in long waves.
    squared = np.linalg.eigvals(np.linalg.solve(mass, 100 * stiffness)) * SPACING_A**2
    np.testing.assert_allclose(np.sort(speeds), np.sort(np.sqrt(squared)), rtol=1e-12)


def test_steps_that_act_against_each_other_make_long_segments_stiffer() -> None:
    """Steps with a correlation of -0.3 to the next: 1 - 2 x 0.3 (n - 1)/n of the compliance."""
    correlation = np.eye(PAIRS - 1) - 0.3 * (np.eye(PAIRS - 1, k=1) + np.eye(PAIRS - 1, k=-1))
    place = np.tril(np.ones((PAIRS, PAIRS - 1)), -1)
    counts = place @ correlation @ place.T
    table = segment_table(modes_of(np.einsum("pq,cd->pcqd", counts, np.linalg.inv(STEP))))
    ratio = table["extension_pN"] / table["extension_pN"].iloc[0]
    steps = table["steps"].to_numpy()
    np.testing.assert_allclose(1 / ratio, 1 - 0.6 * (steps - 1) / steps, rtol=1e-12)


@pytest.mark.parametrize("pairs", [4, 6, 9])
def test_short_duplexes_have_segments_too(pairs: int) -> None:
    """The shortest allowed duplex has 4 base pairs."""
    short = uniform_chain().isel(pair=slice(pairs), other_pair=slice(pairs))
    table = segment_table(short)
    assert len(table) >= 1
    assert np.isfinite(table.to_numpy(dtype=float)).all()


def test_the_table_is_written(tmp_path: Path) -> None:
    modes, output = tmp_path / "modes.nc", tmp_path / "segments.csv"
    write_netcdf(modes, uniform_chain())
    segments_step(modes, output)
    assert list(pd.read_csv(output)["steps"]) == list(segment_table(uniform_chain())["steps"])
