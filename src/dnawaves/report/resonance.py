"""Resonance: how strongly the lowest standing wave answers drives of several frequencies."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from dnawaves.report.style import (
    INK,
    MEASURED_COLOUR,
    MEASURED_LINE,
    PAPER_LINE,
    blank_figure,
    readable_unit,
)
from dnawaves.rod.modal import sine_drive_response
from dnawaves.units import GHZ_PER_RAD_PER_PS

Array = NDArray[np.float64]


def driven_peak(
    times_ps: Array,
    frequency_GHz: float,
    friction_per_ps: float,
    drives_GHz: Array,
    ramp_periods: float = 0.0,
) -> Array:
    """Return the largest speed in the record of an oscillator driven from rest, per drive.

    Each drive rises over `ramp_periods` of its own periods.
    """
    return np.array(
        [
            np.abs(
                sine_drive_response(
                    times_ps,
                    [frequency_GHz / GHZ_PER_RAD_PER_PS],
                    friction_per_ps,
                    drive / GHZ_PER_RAD_PER_PS,
                    ramp_periods * 1e3 / drive,
                )[1]
            ).max()
            for drive in drives_GHz
        ]
    )


def resonance_figure(
    drives_GHz: Array,
    response: Array,
    units: str,
    times_ps: Array,
    fitted: tuple[float, float],
    paper_f1_GHz: float,
    ramp_periods: float = 0.0,
) -> go.Figure:
    """Return the response (drive,) with the fitted oscillator and the paper's lowest mode.

    `fitted` is its frequency in GHz and friction per ps. Its force over mass is chosen to meet
    the points, and the paper's mode is driven by the same.
    """
    frequency_GHz, friction = fitted
    every = np.array([*drives_GHz, frequency_GHz, paper_f1_GHz])
    grid = np.linspace(0.85 * every.min(), 1.15 * every.max(), 80)
    at_drives = driven_peak(times_ps, frequency_GHz, friction, drives_GHz, ramp_periods)
    gain = float(at_drives @ response / (at_drives @ at_drives))
    curve = gain * driven_peak(times_ps, frequency_GHz, friction, grid, ramp_periods)
    paper = gain * driven_peak(times_ps, paper_f1_GHz, 0.0, grid, ramp_periods)
    figure = blank_figure("drive (GHz)", f"velocity of the mode ({readable_unit(units)})")
    figure.add_scatter(
        x=drives_GHz,
        y=response,
        mode="markers",
        marker={"color": INK, "size": 10},
        name="simulation",
    )
    figure.add_scatter(x=grid, y=curve, mode="lines", line=MEASURED_LINE, name="fitted mode")
    figure.add_scatter(x=grid, y=paper, mode="lines", line=PAPER_LINE, name="paper's mode")
    top = 1.15 * max(curve.max(), paper.max(), float(np.max(response)))
    for name, at_GHz, line in (
        (f"fitted f₁ {frequency_GHz:.0f} GHz", frequency_GHz, {"color": MEASURED_COLOUR}),
        (f"paper's f₁ {paper_f1_GHz:.0f} GHz", paper_f1_GHz, {"color": PAPER_LINE["color"]}),
    ):
        figure.add_scatter(
            x=[at_GHz, at_GHz],
            y=[0, top],
            mode="lines",
            line={**line, "width": 1, "dash": "dot"},
            name=name,
            hoverinfo="name",
        )
    figure.update_layout(yaxis_range=[0, top])
    return figure
