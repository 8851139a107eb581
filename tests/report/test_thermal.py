"""Thermal spectra in the report: the fitted line lies on the spectrum that it was made of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from dnawaves.report.gather import Results
from dnawaves.report.thermal import line_shape, thermal_illustrations
from dnawaves.units import GHZ_PER_RAD_PER_PS

FREQUENCIES = np.linspace(0, 600, 601)


def test_a_line_is_as_wide_as_its_friction() -> None:
    friction_per_ps = 0.3
    line = line_shape(FREQUENCIES, 200.0, friction_per_ps)
    above = FREQUENCIES[line >= 0.5]
    # Full width at half maximum of a velocity spectrum: the friction itself, exactly.
    assert above[-1] - above[0] == pytest.approx(friction_per_ps * GHZ_PER_RAD_PER_PS, abs=2)
    assert FREQUENCIES[line.argmax()] == 200.0


def test_the_fitted_lines_lie_on_the_spectra(results: Results, truth) -> None:
    scene = results.scenes["mode1"]
    wavenumbers = np.array([0.05, 0.1, 0.15])
    centres = np.array([100.0, 200.0, 300.0])
    power = xr.DataArray(
        [5 * line_shape(FREQUENCIES, centre, 0.3) for centre in centres],
        dims=("wavenumber", "frequency"),
        coords={"wavenumber": wavenumbers, "frequency": FREQUENCIES},
    )
    bare = scene.waves.drop_dims(["wavenumber", "frequency"])
    rows = scene.rows.iloc[[0, 0]].assign(
        estimator=["thermal mode 1", "thermal mode 2"],
        frequency_GHz=centres[:2],
        friction_per_ps=0.3,
        wavenumber_rad_per_A=wavenumbers[:2],
    )
    shown = thermal_illustrations(
        replace(scene, waves=bare.assign(extension_power=power), rows=rows), None
    )
    assert [one.title for one in shown] == [
        "Thermal spectra of extension",
        "Extension, frequency against wavenumber",
    ]
    figure = shown[0].figure
    for measured, fitted in zip(figure.data[::2], figure.data[1::2], strict=True):
        assert fitted.y == pytest.approx(measured.y)
    assert "the 2 lowest standing waves" in shown[0].caption
