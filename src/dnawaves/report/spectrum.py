"""Frequency-wavenumber maps of a recorded field, under the branches of the theory."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
import xarray as xr
from numpy.typing import NDArray

from dnawaves.report.style import SEQUENTIAL, at_most, heatmap, map_figure

# Four decades: what lies below is leakage of the window.
DECADES = 4


def spectrum_figure(
    power: xr.DataArray,
    branches: Mapping[str, tuple[NDArray[np.float64], Mapping[str, object]]],
    top_GHz: float,
) -> go.Figure:
    """Return the map of a power (wavenumber, frequency), largest 1, below `top_GHz`.

    `branches` are frequencies in GHz at the map's wavenumbers with their line style, by name.
    """
    shown = at_most(power.sel(frequency=slice(0, top_GHz)), "frequency")
    wavenumber = shown["wavenumber"].values
    floor = 10.0**-DECADES
    figure = map_figure("wavenumber (rad/Å)", "frequency (GHz)")
    figure.add_trace(
        heatmap(
            wavenumber,
            shown["frequency"].values,
            np.log10(np.maximum(shown.transpose("frequency", "wavenumber").values, floor)),
            "power, log₁₀ of the largest",
            colorscale=SEQUENTIAL,
            zmin=-DECADES,
            zmax=0,
            hovertemplate="%{x:.3f} rad/Å, %{y:.0f} GHz: %{z:.1f}<extra></extra>",
        )
    )
    for name, (frequency_GHz, line) in branches.items():
        figure.add_scatter(
            x=power["wavenumber"].values,
            y=frequency_GHz,
            mode="lines",
            line=dict(line),
            name=name,
            hoverinfo="name",
        )
    top = float(shown["frequency"].values[-1])
    figure.update_layout(yaxis_range=[0, top])
    return figure
