"""A standing wave in time: its share of the motion, the fitted oscillation, and the paper's."""

from __future__ import annotations

import plotly.graph_objects as go
import xarray as xr

from dnawaves.report.style import INK, MEASURED_LINE, PAPER_LINE, blank_figure
from dnawaves.rod.modal import impulse_response
from dnawaves.units import GHZ_PER_RAD_PER_PS


def projection_figure(
    projection: xr.DataArray,
    window_ps: float,
    frequency_GHz: float,
    friction_per_ps: float,
    paper_frequency_GHz: float,
) -> go.Figure:
    """Return the projection (time,) with the fitted damped oscillation and the paper's rod's.

    The fit's gain is the least-squares one over the window, as in the fit itself.
    """
    time = projection["time"].values
    figure = blank_figure("time (ps)", "share in the kicked shape")
    figure.add_scatter(
        x=time,
        y=projection.values,
        mode="markers",
        marker={"color": INK, "size": 4},
        name="simulation",
    )
    model = impulse_response(time, [frequency_GHz / GHZ_PER_RAD_PER_PS], friction_per_ps)[1][:, 0]
    used = time <= window_ps * (1 + 1e-6)
    gain = float(model[used] @ projection.values[used] / (model[used] @ model[used]))
    figure.add_scatter(
        x=time[used], y=gain * model[used], mode="lines", line=MEASURED_LINE, name="fit"
    )
    paper = impulse_response(time, [paper_frequency_GHz / GHZ_PER_RAD_PER_PS], 0.0)[1][:, 0]
    figure.add_scatter(x=time, y=paper, mode="lines", line=PAPER_LINE, name="paper's rod")
    figure.add_hline(y=0, line={"color": INK, "width": 1})
    return figure
