"""The dispersion relation as a file with units, and the curves of the paper's Figure 1."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dnawaves.files import read_netcdf, write_netcdf
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.dispersion_dataset import dispersion_dataset, figure_1_dataset
from dnawaves.rod.rod import Rod

TWISTED = Rod.paper(twisted=True)
K = np.linspace(0.0, 9.0, 40)


def test_the_table_survives_a_file_and_holds_what_was_computed(tmp_path: Path) -> None:
    table = dispersion_dataset(TWISTED, K, lattice=True)
    write_netcdf(tmp_path / "dispersion.nc", table)
    read = read_netcdf(tmp_path / "dispersion.nc")
    assert all(read[name].attrs["units"] for name in read.data_vars)
    # sorted, the branches are the frequencies of `dispersion`: round-off
    assert np.sort(read["angular_frequency"].values, axis=1) == pytest.approx(
        dispersion(TWISTED, K, lattice=True), abs=1e-13
    )
    # 1/nm is 0.1/A
    assert read["wavenumber"].values == pytest.approx(K / 10)
    phase = read["angular_frequency"] / read["wavenumber"]
    assert read["phase_velocity"][1:].values == pytest.approx(phase[1:].values)
    assert read["laboratory_wavenumber"].sel(circular="plus").values == pytest.approx(
        K / 10 + 0.176
    )
    # v.M.v = 1 in nm, whatever the branch: A and rad in the file
    vectors = (
        read["polarisation"].sel(part="real") + 1j * read["polarisation"].sel(part="imaginary")
    ).values / np.repeat([10, 1], 3)
    energy = np.einsum("kbi,ij,kbj->kb", vectors.conj(), TWISTED.mass, vectors)
    assert energy == pytest.approx(np.ones((40, 6)), abs=1e-12)


@pytest.mark.parametrize(("model", "lattice"), [("continuous rod", False), ("lattice", True)])
def test_figure_1_is_the_dispersion_of_the_papers_rod(model: str, lattice: bool) -> None:
    curves = figure_1_dataset(K).sel(model=model)
    for rod, frames in (
        (Rod.paper(), ["untwisted", "untwisted"]),
        (TWISTED, ["k + twist", "k - twist"]),
    ):
        bends = [curves["bend_shear"].sel(frame=frame).values.T for frame in frames]
        six = np.vstack([curves["extension"], curves["twist"], *bends]).T
        # closed forms against the general problem: round-off
        assert np.sort(six, axis=1) == pytest.approx(dispersion(rod, K, lattice=lattice), abs=1e-13)
