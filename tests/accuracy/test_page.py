"""Figures and page of a table whose errors are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from typer.testing import CliRunner

from dnawaves.accuracy.effects import effects
from dnawaves.accuracy.figures import marks, work_precision
from dnawaves.accuracy.front import order
from dnawaves.accuracy.table import tables, write_csv
from dnawaves.cli import app
from dnawaves.report.accuracy_page import NO_COSTS, fronts_table, illustrations, render
from dnawaves.scene.load import load_scenes

from .conftest import row

CONFIG = Path(__file__).parents[2] / "config"


def slope(trace: go.Scatter) -> float:
    rise, run = (np.log(values[-1] / values[0]) for values in (trace.y, trace.x))
    return float(rise / run)


def test_expected_slopes_are_drawn_through_the_default(settings: pd.DataFrame) -> None:
    figure = work_precision(go.Figure(), settings, "waveform_integration_error", marks(settings))
    points, guide = figure.data
    assert np.isclose(slope(guide), -2)
    # Through the default, cost 1 and 1 %: the middle of the line.
    assert np.isclose(np.sqrt(guide.y[0] * guide.y[-1]), 1.0)
    # The points themselves, made to fall so.
    assert np.isclose(slope(points), -2)
    assert np.isclose(order(settings["timestep_fs"], settings["waveform_integration_error"]), 2)


def test_replicas_have_a_slope_of_their_own() -> None:
    rows = [
        row(
            2.0,
            slope="replicas",
            replicas=count,
            relative_cost=count / 2,
            waveform_error=count**-0.5,
        )
        for count in (1, 16, 256)
    ]
    table = tables(rows)[0]
    figure = work_precision(go.Figure(), table, "waveform_error", marks(table))
    assert np.isclose(slope(figure.data[-1]), -0.5)


def test_the_front_joins_what_nothing_beats(settings: pd.DataFrame) -> None:
    figure = work_precision(
        go.Figure(), settings, "waveform_error", marks(settings), "front_waveform"
    )
    front = figure.data[-1]
    # A tenth of the kick costs nothing: the whole front has it, from 2.5 fs down to 0.5 fs.
    assert np.allclose(front.x, [0.8, 1.0, 2.0, 4.0])
    assert np.all(np.diff(front.y) < 0)


def test_the_page_opens_offline_and_says_who_is_beaten(settings: pd.DataFrame) -> None:
    scenes = load_scenes(CONFIG / "config.yaml")
    shipped = scenes["extension_kick"]
    larger = shipped.excitation.model_copy(update={"velocity_A_per_ps": 0.1})
    scenes["extension_kick"] = shipped.model_copy(update={"excitation": larger})
    models = tables([row(2.0, table="models", rate=5.0, rise_A=3.3, roll_deg=1.0, twist_deg=35.0)])[
        1
    ]
    html = render(settings, models, NO_COSTS, scenes)
    assert html.count("<figure>") == len(illustrations(settings, scenes)) >= 3
    assert 'src="http' not in html
    cells = {line[0]: line for line in fronts_table(settings, scenes).rows}
    # 4 % at 2 fs; a tenth of the kick errs by 1.3 % at the same cost.
    assert cells["extension_kick"][4:6] == ["4.0\u00a0%", "3.1 ×, beaten"]
    assert "thermal" in html or "not among those studied" in html
    # Why a scene has no setting stands where its setting would.
    assert cells["thermal_held"][1] == "it is thermal, and the study's runs start at T = 0"


def test_an_effect_is_joined_with_what_it_costs_per_step(settings: pd.DataFrame) -> None:
    rows = [row(2.0, line="friction", title="Langevin", relative_cost=1.1)]
    costs = pd.DataFrame(
        {
            "system": ["ten"],
            "effect": ["thermostat"],
            "ms_saved": [0.1],
            "ms_per_step_whole": [1.0],
        }
    )
    (one,) = effects(*tables(rows), costs)
    assert one.effect == "thermostat"
    assert one.per_step == "thermostat: 10 % of a step"


def test_advice_from_the_command_line(settings: pd.DataFrame, tmp_path: Path) -> None:
    study = tmp_path / "settings.csv"
    write_csv(study, settings)
    result = CliRunner().invoke(
        app,
        [
            *("advise", str(CONFIG / "smoke.yaml"), "smoke_extension_kick"),
            *("--error", "1.4%", "--study", str(study), "--results", str(tmp_path)),
        ],
    )
    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert lines[0].strip() == "excitation: {velocity_A_per_ps: 0.01}"
    assert lines[1].strip() == "observation: {timestep_fs: 2}"
    assert "error 1.3 %" in lines[2]
