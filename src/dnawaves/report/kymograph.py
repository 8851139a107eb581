"""Kymographs: a wave's velocity field, height along the helix against time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import plotly.graph_objects as go
import xarray as xr

from dnawaves.report.style import (
    DIVERGING,
    INK,
    MEASURED_LINE,
    PAPER_LINE,
    at_most,
    compact,
    heatmap,
    map_figure,
    readable_unit,
)

# The strongest part of the field, the source itself, would leave the wave pale.
SATURATION = 0.97
LINES = {
    "paper": PAPER_LINE,
    "measured": MEASURED_LINE,
    "measured otherwise": {**MEASURED_LINE, "dash": "dot"},
}


@dataclass(frozen=True)
class Front:
    """A front that runs up from where it was started, at one speed."""

    name: str
    speed_A_per_ps: float
    line: str


@dataclass(frozen=True)
class Moment:
    """A time that the figure marks."""

    name: str
    time_ps: float
    line: str


@dataclass(frozen=True)
class Marks:
    """What is drawn over a kymograph; heights are counted from the first base pair."""

    fronts: Sequence[Front] = field(default=())
    moments: Sequence[Moment] = field(default=())
    source_A: float = 0.0
    window_ps: float | None = None


def saturation(*fields: xr.DataArray) -> float:
    """Return the velocity at which the colours of several kymographs end."""
    return max(float(np.quantile(np.abs(field.values), SATURATION)) for field in fields)


def kymograph(velocity: xr.DataArray, units: str, limit: float, marks: Marks) -> go.Figure:
    """Return the kymograph of a field (time, pair) that has the coordinates time and height.

    The colours end at ± `limit`. A line per front, its slope the speed; a vertical line per
    moment, and one where the usable window ends.
    """
    velocity = at_most(velocity, "time")
    time = velocity["time"].values
    height = velocity["height"].values - velocity["height"].values[0]
    figure = map_figure("time (ps)", "height along the helix (Å)")
    figure.add_trace(
        heatmap(
            time,
            height,
            velocity.transpose("pair", "time").values,
            f"velocity ({readable_unit(units)})",
            colorscale=DIVERGING,
            zmin=-limit,
            zmax=limit,
            hovertemplate="%{x:.2f} ps, %{y:.0f} Å: %{z:.3g}<extra></extra>",
        )
    )
    for front in marks.fronts:
        way_A = min(height[-1] - marks.source_A, front.speed_A_per_ps * float(time[-1]))
        figure.add_scatter(
            x=[0, way_A / front.speed_A_per_ps],
            y=[marks.source_A, marks.source_A + way_A],
            mode="lines",
            line=LINES[front.line],
            name=front.name,
            hoverinfo="name",
        )
    vertical = [
        (moment.name, moment.time_ps, LINES[moment.line])
        for moment in marks.moments
        if moment.time_ps <= time[-1]
    ]
    if marks.window_ps is not None:
        vertical.append(("end of the usable window", marks.window_ps, {"color": INK, "width": 1}))
    for name, moment_ps, line in vertical:
        figure.add_scatter(
            x=[moment_ps, moment_ps],
            y=compact([0, height[-1]]),
            mode="lines",
            line=line,
            name=name,
            hoverinfo="name",
        )
    figure.update_layout(
        xaxis_range=[0, float(time[-1])],
        yaxis_range=[0, float(height[-1])],
    )
    return figure
