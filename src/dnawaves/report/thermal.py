"""A duplex in thermal equilibrium: the spectra of its standing waves, with the fitted lines."""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from dnawaves.report.dispersion import branch_GHz, paper_branches_GHz
from dnawaves.report.gather import SceneResults
from dnawaves.report.numbers import digits
from dnawaves.report.own_lattice import own_speed_A_per_ps
from dnawaves.report.spectrum import spectrum_figure
from dnawaves.report.style import (
    INK,
    MEASURED_LINE,
    PAPER_LINE,
    WAVE_COLOURS,
    Illustration,
    blank_figure,
)
from dnawaves.units import GHZ_PER_RAD_PER_PS
from dnawaves.waves.record import AXIAL_WAVES

Array = NDArray[np.float64]

MODE = "thermal mode "
OWN_LINE = {"color": INK, "dash": "dot", "width": 2}


def thermal_illustrations(
    scene: SceneResults, constants: pd.DataFrame | None
) -> list[Illustration]:
    """Return, of extension and of twist, the lines of the lowest modes and the whole map."""
    shown = []
    for wave in AXIAL_WAVES:
        power = scene.waves.get(f"{wave}_power")
        if power is None:
            continue
        rows = scene.rows[scene.rows["wave"] == wave]
        modes = rows[rows["estimator"].str.startswith(MODE) & rows["frequency_GHz"].notna()]
        if len(modes):
            shown.append(_lines(power, modes, wave))
        shown.append(_map(scene, power, rows, wave, constants))
    return shown


def line_shape(frequencies_GHz: Array, centre_GHz: float, friction_per_ps: float) -> Array:
    """Return the velocity spectrum of a damped oscillator in thermal noise, 1 at its centre."""
    width = friction_per_ps * GHZ_PER_RAD_PER_PS
    squared = (width * frequencies_GHz) ** 2
    return np.asarray(squared / ((centre_GHz**2 - frequencies_GHz**2) ** 2 + squared))


def _lines(power: xr.DataArray, modes: pd.DataFrame, wave: str) -> Illustration:
    top = 2 * float(modes["frequency_GHz"].max())
    shown = power.sel(frequency=slice(0, top))
    frequency = shown["frequency"].values
    figure = blank_figure("frequency (GHz)", "power, each mode by its peak", 420)
    for level, (_, row) in enumerate(modes.iterrows()):
        k = float(row["wavenumber_rad_per_A"])
        measured = shown.sel(wavenumber=k, method="nearest").values
        fitted = line_shape(frequency, float(row["frequency_GHz"]), float(row["friction_per_ps"]))
        gain = float(fitted @ measured / (fitted @ fitted))
        peak = float(measured.max())
        figure.add_scatter(
            x=frequency,
            y=level + measured / peak,
            mode="lines",
            line={"color": WAVE_COLOURS[wave], "width": 1},
            name="simulation",
            showlegend=level == 0,
            hovertemplate="%{x:.0f} GHz<extra></extra>",
        )
        figure.add_scatter(
            x=frequency,
            y=level + gain * fitted / peak,
            mode="lines",
            line=MEASURED_LINE,
            name="fitted line",
            showlegend=level == 0,
            hovertemplate=f"{row['estimator']}: {digits(row['frequency_GHz'])} GHz<extra></extra>",
        )
    caption = (
        f"Velocity spectra of the {len(modes)} lowest standing waves of {wave}, the longest below. "
        "The lines are those of damped oscillators with the fitted frequency and friction, fitted "
        "by likelihood and not to this picture; only their heights are."
    )
    return Illustration(f"Thermal spectra of {wave}", figure, caption)


def _map(
    scene: SceneResults,
    power: xr.DataArray,
    rows: pd.DataFrame,
    wave: str,
    constants: pd.DataFrame | None,
) -> Illustration:
    wavenumber = power["wavenumber"].values
    paper = paper_branches_GHz(wavenumber, scene.spacing_A)[wave]
    branches = {"paper": (paper, PAPER_LINE)}
    own = None if constants is None else own_speed_A_per_ps(constants, wave)
    if own is not None:
        branches["its own lattice"] = (branch_GHz(own, wavenumber, scene.spacing_A), OWN_LINE)
    spectrum = rows[rows["estimator"].eq("thermal spectrum") & rows["speed_A_per_ps"].notna()]
    if len(spectrum):
        speed = float(spectrum["speed_A_per_ps"].iloc[0])
        name = f"fitted to all modes, {digits(speed)} Å/ps"
        branches[name] = (branch_GHz(speed, wavenumber, scene.spacing_A), MEASURED_LINE)
    top = 1.2 * max(float(frequency.max()) for frequency, _ in branches.values())
    caption = (
        f"How the thermal energy of {wave} is spread over wavenumber and frequency, the mean of "
        "the runs."
    )
    return Illustration(
        f"{wave.capitalize()}, frequency against wavenumber",
        spectrum_figure(power, branches, top),
        caption,
    )
