"""Dispersion: the standing waves measured, over the branches of the paper's rod."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from numpy.typing import NDArray

from dnawaves.report.style import INK, PAPER_LINE, WAVE_COLOURS, blank_figure, error_bars
from dnawaves.rod.dispersion import bend_shear_branches, lattice_frequency
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS
from dnawaves.waves.record import AXIAL_WAVES

Array = NDArray[np.float64]
MARKERS = {"standing wave": "circle", "resonance": "diamond-open"}
# Beyond this multiple of the largest measured wavenumber there is only theory to see.
ROOM = 1.5


def branch_GHz(speed_A_per_ps: float, wavenumbers_per_A: Array, spacing_A: float) -> Array:
    """Return the frequencies of extension or twist on the base-pair lattice."""
    k = np.asarray(wavenumbers_per_A) * A_PER_NM
    return GHZ_PER_RAD_PER_PS * lattice_frequency(k, speed_A_per_ps, spacing_A / A_PER_NM)


def paper_branches_GHz(wavenumbers_per_A: Array, spacing_A: float) -> dict[str, Array]:
    """Return the branches of the paper's rod as a lattice of this spacing, by wave.

    'bend' is the lower and 'shear' the upper of the two branches in which both are mixed.
    """
    rod = replace(Rod.paper(), spacing_nm=spacing_A / A_PER_NM)
    speeds = short_wave_speeds_A_per_ps(rod)
    axial = {wave: branch_GHz(speeds[wave], wavenumbers_per_A, spacing_A) for wave in AXIAL_WAVES}
    lower, upper = bend_shear_branches(rod, wavenumbers_per_A * A_PER_NM, lattice=True).T
    return {**axial, "bend": GHZ_PER_RAD_PER_PS * lower, "shear": GHZ_PER_RAD_PER_PS * upper}


def standing_points(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that are a point of the dispersion relation."""
    return table[
        table["estimator"].isin(MARKERS)
        & table["frequency_GHz"].notna()
        & table["wavenumber_rad_per_A"].notna()
    ]


def lowest_mode_speeds(table: pd.DataFrame) -> dict[str, float]:
    """Return the speed of the lowest standing wave of extension and of twist."""
    points = standing_points(table)
    points = points[points["estimator"] == "standing wave"].sort_values("frequency_GHz")
    return {
        wave: float(points.loc[points["wave"] == wave, "speed_A_per_ps"].iloc[0])
        for wave in AXIAL_WAVES
        if (points["wave"] == wave).any()
    }


def dispersion_figure(table: pd.DataFrame, spacing_A: float) -> go.Figure:
    """Return frequency against wavenumber for the scenes of one system."""
    points = standing_points(table)
    largest = ROOM * float(points["wavenumber_rad_per_A"].max())
    k = np.linspace(0, min(largest, np.pi / spacing_A), 80)
    figure = blank_figure("wavenumber (rad/Å)", "frequency (GHz)", 480)
    for wave, frequencies in paper_branches_GHz(k, spacing_A).items():
        figure.add_scatter(
            x=k,
            y=frequencies,
            mode="lines",
            line={**PAPER_LINE, "color": WAVE_COLOURS[wave]},
            name=f"{wave}, paper",
            showlegend=False,
            hoverinfo="name",
        )
    for wave, speed in lowest_mode_speeds(table).items():
        figure.add_scatter(
            x=k,
            y=branch_GHz(speed, k, spacing_A),
            mode="lines",
            line={"color": WAVE_COLOURS[wave], "width": 1.5},
            name=f"{wave}, rod at {speed:.1f} Å/ps",
            showlegend=False,
            hoverinfo="name",
        )
    for (name, estimator), rows in points.groupby(["wave", "estimator"], sort=False):
        add_points(figure, str(name), str(estimator), rows)
    _add_legend(figure)
    top = 1.25 * float(points["frequency_GHz"].max())
    figure.update_layout(xaxis_range=[0, k[-1]], yaxis_range=[0, top])
    return figure


def _add_legend(figure: go.Figure) -> None:
    """Name the colours and the styles, each once, instead of every pair of the two."""
    styles: Mapping[str, Mapping[str, object]] = {
        **{
            wave: {"mode": "lines", "line": {"color": colour, "width": 6}}
            for wave, colour in WAVE_COLOURS.items()
        },
        "paper's rod": {"mode": "lines", "line": {**PAPER_LINE, "color": INK}},
        "measured rod": {"mode": "lines", "line": {"color": INK, "width": 1.5}},
        **{
            name: {"mode": "markers", "marker": {"color": INK, "symbol": symbol, "size": 10}}
            for name, symbol in MARKERS.items()
        },
    }
    for name, style in styles.items():
        figure.add_scatter(x=[None], y=[None], name=name, **style)


def add_points(figure: go.Figure, wave: str, estimator: str, rows: pd.DataFrame) -> None:
    """Add the standing waves of one wave and estimator, with their intervals."""
    # All speeds of a row are its frequencies over one wavenumber: the interval carries over.
    per_speed = rows["frequency_GHz"] / rows["speed_A_per_ps"]
    low, high = (per_speed * rows[f"{end}_A_per_ps"] for end in ("low", "high"))
    figure.add_scatter(
        x=rows["wavenumber_rad_per_A"],
        y=rows["frequency_GHz"],
        error_y=error_bars(rows["frequency_GHz"], low, high),
        mode="markers",
        marker={"color": WAVE_COLOURS[wave], "symbol": MARKERS[estimator], "size": 10},
        showlegend=False,
        text=rows["scene"],
        hovertemplate="%{text}: %{y:.0f} GHz at %{x:.3f} rad/Å<extra></extra>",
    )
