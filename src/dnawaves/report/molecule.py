"""The harmonic reference: the rod's constants in the same molecule, and S(q, f) of its pairs."""

from __future__ import annotations

import numpy as np
import pandas as pd
import plotly.graph_objects as go
import xarray as xr

from dnawaves.report.dispersion import branch_GHz, standing_points
from dnawaves.report.gather import Results, SceneResults
from dnawaves.report.numbers import digits, percent
from dnawaves.report.style import (
    INK,
    PAPER_LINE,
    SEQUENTIAL,
    WAVE_COLOURS,
    Illustration,
    blank_figure,
    error_bars,
    heatmap,
    map_figure,
)
from dnawaves.report.tables import Table
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.excitations import Static
from dnawaves.waves.record import AXIAL_WAVES

# The edge 2V/a of the fastest branch, that of extension at twice the paper's speed.
TOP_GHZ = 1500.0


def segments_figure(segments: pd.DataFrame, table: pd.DataFrame) -> Illustration:
    """Return the speeds that the segments' stiffness gives, with the standing waves over them."""
    figure = blank_figure("length of segment, or half a wavelength (Å)", "speed (Å/ps)", 420)
    paper = short_wave_speeds_A_per_ps(Rod.paper())
    points = standing_points(table)
    points = points[points["estimator"] == "standing wave"]
    furthest = float(segments["length_A"].max())
    for wave in AXIAL_WAVES:
        colour = WAVE_COLOURS[wave]
        figure.add_scatter(
            x=segments["length_A"],
            y=segments[f"{wave}_A_per_ps"],
            mode="lines+markers",
            line={"color": colour, "width": 1.5},
            marker={"size": 5},
            name=f"{wave}, segments",
        )
        rows = points[points["wave"] == wave]
        if len(rows):
            half_waves = np.pi / rows["wavenumber_rad_per_A"]
            furthest = max(furthest, float(half_waves.max()))
            figure.add_scatter(
                x=half_waves,
                y=rows["speed_A_per_ps"],
                error_y=error_bars(
                    rows["speed_A_per_ps"], rows["low_A_per_ps"], rows["high_A_per_ps"]
                ),
                mode="markers",
                marker={"color": colour, "symbol": "diamond-open", "size": 11},
                name=f"{wave}, standing waves",
                text=rows["scene"],
                hovertemplate="%{text}: %{y:.1f} Å/ps<extra></extra>",
            )
        figure.add_scatter(
            x=[0, 1.05 * furthest],
            y=[paper[wave]] * 2,
            mode="lines",
            line={**PAPER_LINE, "color": colour},
            name=f"{wave}, paper",
        )
    figure.update_layout(xaxis_range=[0, 1.05 * furthest], yaxis_rangemode="tozero")
    return Illustration(
        "Speeds from the duplex's own stiffness, by length",
        figure,
        "Lines: what a rod would carry whose stiffness is that of segments of the free duplex, "
        "from its normal modes without any wave. A uniform rod would give level lines; a rise "
        "with the length says that steps do not give way independently. Diamonds: the standing "
        "waves, at half their wavelength. Dashed: the paper.",
    )


def structure_factor_figure(
    structure_factor: xr.DataArray, wave: str, spacing_A: float
) -> Illustration:
    """Return S(q, f) of one coordinate of the base pairs, with the paper's branch over it."""
    factor = structure_factor.sel(coordinate=wave)
    paper = branch_GHz(
        short_wave_speeds_A_per_ps(Rod.paper())[wave], factor["wavenumber"].values, spacing_A
    )
    # Each wavenumber by its own peak: long waves carry the same energy in fewer modes.
    power = factor / factor.max("frequency")
    top = factor["frequency"].values <= TOP_GHZ
    figure = map_figure("wavenumber (rad/Å)", "frequency (GHz)")
    figure.add_trace(
        heatmap(
            factor["wavenumber"],
            factor["frequency"].values[top],
            power.values[:, top].T,
            "S(q, f), each wavenumber by its peak",
            colorscale=SEQUENTIAL,
        )
    )
    figure.add_trace(
        go.Scatter(
            x=factor["wavenumber"].values,
            y=paper,
            mode="lines",
            line={**PAPER_LINE, "color": INK},
            name="paper's rod",
        )
    )
    return Illustration(
        f"S(q, f) of {wave}",
        figure,
        f"Where the exact normal modes of the free duplex carry the base pairs' motion of {wave}.",
    )


def twins_table(results: Results) -> Table | None:
    """Return how far each simulated scene is from its exact linear answer; None without twins."""
    rows = []
    for exact in results.scenes.values():
        twin = _twin(results, exact)
        if twin is None:
            continue
        wave = exact.spec.excitation.wave  # type: ignore[union-attr]
        first, other = (
            scene.waves[f"{wave}_velocity"].transpose("time", "pair") for scene in (exact, twin)
        )
        frames = min(len(first), int(twin.waves.attrs["usable_frames"]))
        difference = np.abs(first.values[:frames] - other.values[:frames]).max()
        speeds = [_speed(scene.rows) for scene in (twin, exact)]
        rows.append(
            [
                twin.spec.name,
                wave,
                *(digits(speed) for speed in speeds),
                percent(difference / np.abs(first.values).max()),
            ]
        )
    if not rows:
        return None
    return Table(
        [
            "scene",
            "wave",
            "simulated, Å/ps",
            "exact, Å/ps",
            "largest difference, of the peak",
        ],
        rows,
    )


def _twin(results: Results, exact: SceneResults) -> SceneResults | None:
    """Return the simulated scene with the same first run, if there is one."""
    if exact.spec.method != "harmonic" or isinstance(exact.spec.excitation, Static):
        return None
    for scene in results.scenes.values():
        alike = scene.spec.model_copy(update={"name": exact.spec.name, "method": "harmonic"})
        if scene.spec.method == "simulated" and _first_run(alike) == _first_run(exact.spec):
            same_times = scene.waves["time"].equals(exact.waves["time"])
            return scene if same_times else None
    return None


def _first_run(spec: object) -> dict[str, object]:
    """Return what the first run depends on: other kick sizes and helical parameters do not."""
    content: dict[str, object] = spec.model_dump()  # type: ignore[attr-defined]
    excitation, observation = dict(content["excitation"]), dict(content["observation"])  # type: ignore[call-overload]
    excitation["scales"] = excitation.get("scales", (1.0,))[:1]
    observation.pop("helical")
    return {**content, "excitation": excitation, "observation": observation}


def _speed(rows: pd.DataFrame) -> float | None:
    known = rows["speed_A_per_ps"].dropna()
    return None if known.empty else float(known.iloc[0])
