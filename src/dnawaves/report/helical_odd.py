"""The wave as the helical parameters see it: their odd part over time."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
import xarray as xr

from dnawaves.report.kymograph import saturation
from dnawaves.report.style import DIVERGING, at_most, heatmap, map_figure, readable_unit

# The step parameters that belong to a wave; of several the one that moves most is shown.
PARAMETERS = {
    "extension": ("rise",),
    "twist": ("twist",),
    "bend": ("roll",),
    "shear": ("slide", "shift"),
}


def parameter_of(odd: xr.Dataset, wave: str) -> str:
    """Return the step parameter that shows a wave."""
    return max(PARAMETERS[wave], key=lambda name: float(np.nanstd(odd[name].values)))


def helical_figure(odd: xr.Dataset, name: str) -> go.Figure:
    """Return the odd part of one step parameter (time, step), steps against time."""
    values = at_most(odd[name].dropna("step", how="all"), "time")
    limit = saturation(values.fillna(0))
    unit = readable_unit(str(odd[name].attrs["units"]))
    figure = map_figure("time (ps)", "step")
    figure.add_trace(
        heatmap(
            values["time"].values,
            np.arange(1, values.sizes["step"] + 1),
            values.transpose("step", "time").values,
            f"odd part of {name} ({unit})",
            colorscale=DIVERGING,
            zmin=-limit,
            zmax=limit,
            hovertemplate="%{x:.2f} ps, step %{y}: %{z:.3g}<extra></extra>",
        )
    )
    return figure
