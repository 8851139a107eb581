"""All speeds at a glance: every estimate with its interval beside the paper's value."""

from __future__ import annotations

import pandas as pd
import plotly.graph_objects as go

from dnawaves.report.style import PAPER_LINE, WAVE_COLOURS, blank_figure, error_bars
from dnawaves.waves.record import AXIAL_WAVES

ROW_PX = 24


def speeds_figure(table: pd.DataFrame) -> go.Figure:
    """Return one line for each row that holds a speed, grouped by wave.

    Standing bends and shears are left out: frequency over wavenumber is another speed for each,
    and they are points of the dispersion figure.
    """
    dispersive = ~table["wave"].isin(AXIAL_WAVES) & (table["estimator"] == "standing wave")
    known = table[table["speed_A_per_ps"].notna() & ~dispersive]
    rows = pd.concat([known[known["wave"] == wave] for wave in WAVE_COLOURS])
    labels = (rows["scene"] + " · " + rows["estimator"]).astype(str)
    figure = blank_figure("speed (Å/ps)", "", 90 + ROW_PX * len(rows))
    for wave, group in rows.groupby("wave", sort=False):
        speed = group["speed_A_per_ps"]
        # A row without an interval has an exact number: no bar.
        low, high = (group[f"{end}_A_per_ps"].fillna(speed) for end in ("low", "high"))
        figure.add_scatter(
            x=speed,
            y=labels[group.index],
            error_x={**error_bars(speed, low, high, 2), "width": 4},
            mode="markers",
            marker={"color": WAVE_COLOURS[str(wave)], "size": 9},
            name=str(wave),
            hovertemplate="%{y}: %{x:.3g} Å/ps<extra></extra>",
        )
    figure.add_scatter(
        x=rows["paper_A_per_ps"],
        y=labels,
        mode="markers",
        marker={
            "symbol": "line-ns",
            "size": 13,
            "line": {"color": PAPER_LINE["color"], "width": 2},
        },
        name="paper",
        hovertemplate="%{y}, paper: %{x:.3g} Å/ps<extra></extra>",
    )
    figure.update_layout(
        xaxis_rangemode="tozero",
        yaxis={
            "categoryorder": "array",
            "categoryarray": list(labels[::-1]),
            "tickfont": {"size": 11},
        },
    )
    return figure
