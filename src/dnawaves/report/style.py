"""How every figure looks: colours, lines, fonts and the size of what is put into the page."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
import plotly.graph_objects as go
import xarray as xr
from numpy.typing import ArrayLike, NDArray

# Okabe and Ito's colours, which colour-blind readers can tell apart.
WAVE_COLOURS = {
    "extension": "#0072b2",
    "twist": "#d55e00",
    "bend": "#009e73",
    "shear": "#b0568f",
}
INK = "#1f2933"
FAINT = "#dde3e9"
BAND = "rgba(0, 114, 178, 0.10)"
PAPER_LINE = {"color": "#111111", "dash": "dash", "width": 2}
MEASURED_COLOUR = "#007a4d"
MEASURED_LINE = {"color": MEASURED_COLOUR, "width": 2.5}
DIVERGING = "RdBu_r"
SEQUENTIAL = "Blues"
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
UNITS = {"angstrom": "Å", "degree": "°", "rad": "rad"}
HEIGHT_PX = 380
LARGEST_SIDE = 400


@dataclass(frozen=True)
class Illustration:
    """A figure with its title and what there is to see in it."""

    title: str
    figure: go.Figure
    caption: str


def blank_figure(x_title: str, y_title: str, height_px: int = HEIGHT_PX) -> go.Figure:
    """Return an empty figure in the report's style."""
    axis = {
        "gridcolor": FAINT,
        "linecolor": INK,
        "ticks": "outside",
        "tickcolor": INK,
        "zeroline": False,
        "automargin": True,
        "exponentformat": "power",
    }
    return go.Figure(
        layout={
            # An empty template: the default one would be repeated in every figure of the page.
            "template": go.layout.Template(),
            "height": height_px,
            "font": {"family": FONT, "size": 13, "color": INK},
            "paper_bgcolor": "rgba(0,0,0,0)",
            "plot_bgcolor": "rgba(0,0,0,0)",
            "margin": {"l": 56, "r": 12, "t": 34, "b": 48},
            "xaxis": {**axis, "title": {"text": x_title, "standoff": 6}},
            "yaxis": {**axis, "title": {"text": y_title}},
            # The page draws the legend: see legend.py.
            "showlegend": False,
            # A finger that scrolls the page must not zoom the figure.
            "dragmode": False,
            "hovermode": "closest",
            "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "#9aa5b1", "activecolor": INK},
        }
    )


def error_bars(
    values: pd.Series, low: pd.Series, high: pd.Series, thickness: float = 1.5
) -> dict[str, object]:
    """Return bars from low to high."""
    return {
        "type": "data",
        "symmetric": False,
        "array": high - values,
        "arrayminus": values - low,
        "thickness": thickness,
    }


def heatmap(x: ArrayLike, y: ArrayLike, z: ArrayLike, unit: str, **options: object) -> go.Heatmap:
    """Return a heat map with its colour bar below the figure, where a narrow screen has room."""
    bar = {
        "orientation": "h",
        "x": 0.5,
        "y": 0.01,
        "yref": "container",
        "yanchor": "bottom",
        "thickness": 10,
        "len": 0.8,
        "exponentformat": "power",
        "nticks": 5,
        "title": {"text": unit, "side": "bottom"},
    }
    return go.Heatmap(x=compact(x), y=compact(y), z=compact(z), colorbar=bar, **options)


def map_figure(x_title: str, y_title: str) -> go.Figure:
    """Return an empty figure with room for a colour bar below."""
    figure = blank_figure(x_title, y_title, 420)
    figure.update_layout(margin_b=112, xaxis_showgrid=False, yaxis_showgrid=False)
    return figure


def compact(values: ArrayLike) -> NDArray[np.float32]:
    """Return numbers in the precision that a screen can show."""
    return np.asarray(values, dtype=np.float32)


def at_most(array: xr.DataArray, dimension: str, size: int = LARGEST_SIDE) -> xr.DataArray:
    """Return the array averaged over blocks so that the dimension is no longer than `size`."""
    factor = -(-array.sizes[dimension] // size)
    return array if factor == 1 else array.coarsen({dimension: factor}, boundary="trim").mean()


def readable_unit(units: str) -> str:
    """Return units as printed: 'angstrom/ps' is 'Å/ps'."""
    head, slash, tail = units.partition("/")
    return UNITS.get(head, head) + slash + tail
