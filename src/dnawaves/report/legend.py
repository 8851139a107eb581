"""Legends as text beside a figure: they wrap on a narrow screen, and leave the plot its size."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import plotly.graph_objects as go

DASHES = {"dash": "6 4", "dot": "2 3"}


@dataclass(frozen=True)
class Key:
    """One entry: a name and how its mark looks, a shape of line, dot, diamond, tick or block."""

    name: str
    shape: str
    colour: str
    width: float = 2.0
    dash: str = ""


SHAPES = {"diamond-open": "diamond", "line-ns": "tick"}


def legend(figure: go.Figure) -> list[Key]:
    """Return the entries of a figure's named traces; one that is alone needs no legend."""
    keys = list(_keys(figure))
    return keys if len(keys) > 1 or any(key.dash for key in keys) else []


def _keys(figure: go.Figure) -> Iterator[Key]:
    for trace in figure.data:
        if not trace.name or trace.showlegend is False:
            continue
        if trace.type == "bar":
            yield Key(trace.name, "block", trace.marker.color)
        elif trace.mode == "markers":
            shape = SHAPES.get(trace.marker.symbol, "dot")
            colour = trace.marker.line.color if shape == "tick" else trace.marker.color
            yield Key(trace.name, shape, colour)
        else:
            line = trace.line
            yield Key(trace.name, "line", line.color, line.width or 2, DASHES.get(line.dash, ""))
