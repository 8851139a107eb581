"""Error against cost, drawn into a blank figure with the caller's style."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from dnawaves.accuracy.table import succeeded

# Okabe and Ito's colours, then darker ones of the same kinds.
COLOURS = (
    *("#0072b2", "#d55e00", "#009e73", "#b0568f", "#e69f00", "#56b4e9"),
    *("#6b7785", "#8a6d3b", "#004a73", "#7a3600", "#005c43", "#63304f"),
)
SYMBOLS = ("circle", "square", "triangle-up", "cross")
INK = "#1f2933"
FRONT = {"color": "#111111", "width": 1, "dash": "dot"}
GUIDE = {"color": "#6b7785", "width": 1.5, "dash": "dash"}
# Error as a power of cost: as timestep², or as one over the root of the replicas.
SLOPES = {
    "timestep": (-2.0, "error ∝ timestep²"),
    "replicas": (-0.5, "error ∝ 1/√replicas"),
}
GUIDE_FACTOR = 3.0
TICKS = [digit * 10.0**power for power in range(-2, 5) for digit in (1, 2, 5)]


def marks(table: pd.DataFrame) -> dict[str, dict[str, str]]:
    """Return colour and symbol of each line of a study, by its title, alike in all figures."""
    count = len(COLOURS)
    return {
        str(title): {
            "color": COLOURS[index % count],
            "symbol": SYMBOLS[index // count % len(SYMBOLS)],
        }
        for index, title in enumerate(table["title"].unique())
    }


def work_precision(
    figure: go.Figure,
    table: pd.DataFrame,
    column: str,
    looks: dict[str, dict[str, str]],
    front: str | None = None,
) -> go.Figure:
    """Draw error against relative cost, both logarithmic: one line for each line of the study.

    `looks` is what `marks` returns; `front` names the column of those on the Pareto front, which
    are joined. Without a front the expected slopes are drawn, through the default setting, of
    replicas through the first one.
    """
    shown = drawn(table, column)
    for title in map(str, shown["title"].unique()):
        ordered = shown[shown["title"] == title].sort_values("relative_cost")
        figure.add_scatter(
            x=ordered["relative_cost"],
            y=100 * ordered[column],
            mode="lines+markers",
            name=title,
            line={"color": looks[title]["color"], "width": 1.5},
            marker={**looks[title], "size": 7},
            text=ordered["label"],
            hovertemplate="%{text}: error %{y:.3g} %, cost %{x:.3g}<extra>"
            + str(title)
            + "</extra>",
        )
    if front is None:
        for slope in SLOPES:
            _guide(figure, shown[shown["slope"] == slope], column, slope)
    else:
        _front(figure, shown[shown[front].astype(bool)], column)
    figure.update_xaxes(type="log", tickvals=TICKS, ticktext=[f"{tick:g}" for tick in TICKS])
    figure.update_yaxes(type="log", dtick=1, minor={"ticks": "outside"})
    return figure


def mark(figure: go.Figure, table: pd.DataFrame, column: str, names: Sequence[str]) -> go.Figure:
    """Mark settings by name: those of shipped scenes, and the default that they share."""
    shown = drawn(table, column)
    shown = shown[shown["setting"].isin(names)]
    figure.add_scatter(
        x=shown["relative_cost"],
        y=100 * shown[column],
        mode="markers",
        name="shipped, or the default of the study",
        marker={
            "symbol": "diamond-open",
            "size": 13,
            "color": INK,
            "line": {"width": 2, "color": INK},
        },
        hoverinfo="skip",
    )
    return figure


def drawn(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the rows that have an error and a cost that a logarithm can show."""
    rows = succeeded(table)
    return rows[(rows[column] > 0) & (rows["relative_cost"] > 0)]


def _guide(figure: go.Figure, rows: pd.DataFrame, column: str, slope: str) -> None:
    if rows.empty:
        return
    power, name = SLOPES[slope]
    defaults = rows[rows["is_default"].astype(bool)]
    anchor = (defaults if len(defaults) else rows).iloc[0]
    costs = float(anchor["relative_cost"]) * np.array([1 / GUIDE_FACTOR, GUIDE_FACTOR])
    if slope == "replicas":
        costs = np.array([rows["relative_cost"].min(), rows["relative_cost"].max()])
    errors = float(anchor[column]) * (costs / float(anchor["relative_cost"])) ** power
    figure.add_scatter(
        x=costs, y=100 * errors, mode="lines", name=name, line=GUIDE, hoverinfo="skip"
    )


def _front(figure: go.Figure, rows: pd.DataFrame, column: str) -> None:
    ordered = rows.sort_values("relative_cost")
    figure.add_scatter(
        x=ordered["relative_cost"],
        y=100 * ordered[column],
        mode="lines",
        name="Pareto front",
        line=FRONT,
        hoverinfo="skip",
    )
