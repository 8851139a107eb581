"""The paper's theory: its figure of the dispersion relation, and what to read with care."""

from __future__ import annotations

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from dnawaves.report.dispersion import add_points, standing_points
from dnawaves.report.style import INK, WAVE_COLOURS, Illustration, blank_figure
from dnawaves.report.tables import Table
from dnawaves.rod.dispersion_dataset import figure_1_dataset
from dnawaves.rod.errata import errata
from dnawaves.rod.rod import Rod
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS

POINTS = 160
STYLES = {"continuous rod": "solid", "lattice": "dot"}
BRANCHES = {"lower": "bend", "upper": "shear"}


def errata_table() -> Table:
    """Return the points of the paper that matter for the comparison."""
    return Table(
        ["the paper", "what holds", "shown by"],
        [[point.paper, point.correct, point.shown_by] for point in errata()],
    )


def paper_dispersion(table: pd.DataFrame) -> list[Illustration]:
    """Return the paper's dispersion relation, with the measured standing waves over it."""
    return [
        Illustration(
            "All four waves, seen from the laboratory",
            _figure(table, ["untwisted"]),
            "Extension and twist, and bend and shear by eq. 48a, to the edge of the zone of base "
            "pairs. Solid: the paper's continuous rod. Dotted: the same rod as a chain of rigid "
            "base pairs. The marks are the standing waves that were measured.",
        ),
        Illustration(
            "Bend and shear, seen from the turning base pairs",
            _figure(table.iloc[:0], ["k + twist", "k - twist"]),
            "The corrected eq. 46: the same branches at k + Ω₀ and k − Ω₀. Intrinsic twist moves "
            "them along the axis of wavenumbers and changes nothing else.",
        ),
    ]


def _figure(table: pd.DataFrame, frames: list[str]) -> go.Figure:
    k = np.linspace(0, np.pi / Rod.paper().spacing_nm, POINTS)
    curves = figure_1_dataset(k)
    figure = blank_figure("wavenumber (rad/Å)", "frequency (GHz)", 480)

    def add(wave: str, model: str, frequency: np.ndarray) -> None:
        figure.add_scatter(
            x=k / A_PER_NM,
            y=frequency * GHZ_PER_RAD_PER_PS,
            mode="lines",
            line={"color": WAVE_COLOURS[wave], "dash": STYLES[model], "width": 1.8},
            name=f"{wave}, {model}",
            showlegend=False,
            hoverinfo="name",
        )

    for model in STYLES:
        if frames == ["untwisted"]:
            for wave in ("extension", "twist"):
                add(wave, model, curves[wave].sel(model=model).values)
        for frame in frames:
            for branch, wave in BRANCHES.items():
                chosen = curves["bend_shear"].sel(model=model, frame=frame, branch=branch)
                add(wave, model, chosen.values)
    points = standing_points(table)
    for (name, estimator), rows in points.groupby(["wave", "estimator"], sort=False):
        add_points(figure, str(name), str(estimator), rows)
    shown = ["bend", "shear"] if frames != ["untwisted"] else list(WAVE_COLOURS)
    for wave in shown:
        line = {"color": WAVE_COLOURS[wave], "width": 6}
        figure.add_scatter(x=[None], y=[None], name=_name(wave), mode="lines", line=line)
    for model, dash in STYLES.items():
        line = {"color": INK, "dash": dash, "width": 1.8}
        figure.add_scatter(x=[None], y=[None], name=model, mode="lines", line=line)
    figure.update_layout(xaxis_range=[0, k[-1] / A_PER_NM], yaxis_rangemode="tozero")
    return figure


def _name(wave: str) -> str:
    return {"bend": "bend (lower branch)", "shear": "shear (upper branch)"}.get(wave, wave)
