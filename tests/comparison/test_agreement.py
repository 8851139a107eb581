"""Whether the routes to one wave agree, on tables made by hand, of which the answers are known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd
import pytest

from dnawaves.comparison.agreement import Agreement, agreement
from dnawaves.comparison.compare import compare
from dnawaves.scene.models import SceneSpec
from dnawaves.waves.table import Estimate, read_table, spread, write_table

MakeScene = Callable[..., SceneSpec]


def estimate(scene: str, estimator: str, **values: object) -> Estimate:
    return Estimate(scene, "extension", estimator, **{"system": "d-e", **values})  # type: ignore[arg-type]


def agreed(
    tmp_path: Path,
    scene: MakeScene,
    rows: Sequence[Estimate],
    wave: str,
    segments: pd.DataFrame | None = None,
) -> Agreement:
    """Return the agreement of estimates that were written to a table and compared."""
    write_table(tmp_path / "speeds.csv", rows)
    specs = {row.scene: scene(row.scene) for row in rows}
    table = compare([read_table(tmp_path / "speeds.csv")], specs, {"d-e": "B-DNA"}, {})
    found = agreement(table, wave, segments)
    assert found is not None
    return found


def test_agreement_names_what_differs_and_why(tmp_path: Path, scene: MakeScene) -> None:
    rows = [
        spread(
            estimate("m1", "standing wave", frequency_GHz=113.0, misfit=0.03),
            [16.5, 16.0, 17.0],
            8.19,
        ),
        spread(estimate("k", "waveform", misfit=0.4), [15.9, 15.0, 16.4], 8.19),
        spread(estimate("p", "waveform", misfit=0.6), [16.5], 8.19),
        spread(estimate("l", "static"), [13.7, 13.6, 13.9], 8.19),
        spread(estimate("l", "static, held across"), [17.7], 8.19),
        # Its own bias is that of the paper's rod, which is 10 % too fast by the same pick.
        spread(estimate("a", "arrival"), [18.2, 17.5, 19.0], 1.1 * 8.19),
    ]
    segments = pd.DataFrame({"steps": [1, 16], "extension_A_per_ps": [11.5, 15.5]})
    found = agreed(tmp_path, scene, rows, "extension", segments)
    assert "m1" in found.yardstick and "16.5" in found.yardstick
    by_name = {route.sentence.split(":")[0]: route for route in found.routes}
    assert {name: route.word for name, route in by_name.items()} == {
        "k, waveform": "agree",
        "p, waveform": "undecided",
        "l, static": "disagree",
        "a, arrival": "agree",
    }
    said = by_name["l, static"].sentence
    assert said.startswith("l, static: −17%, differs") and "17.7" in said
    assert "11.5 Å/ps over 1 step and 15.5 over 16" in said
    assert "2 agree with it within both intervals, 1 differ and 1 decide nothing" in found.sentence


@pytest.mark.parametrize(("static", "said"), [(6.0, "at fixed length"), (4.0, "no reason found")])
def test_a_static_twist_is_stiffer_by_its_fixed_length(
    tmp_path: Path, scene: MakeScene, static: float, said: str
) -> None:
    rows = [
        spread(
            Estimate("m", "twist", "standing wave", system="d-e", frequency_GHz=60.0),
            [5.0, 4.9, 5.1],
            5.06,
        ),
        spread(
            Estimate("l", "twist", "static", system="d-e"), [static, static, static + 0.1], 5.06
        ),
    ]
    found = agreed(tmp_path, scene, rows, "twist")
    assert found.routes[0].word == "disagree"
    assert said in found.routes[0].sentence


@pytest.mark.parametrize(
    ("second", "yardstick", "word"),
    # The lowest standing wave is no yardstick where its fit is of the wrong class, if another is.
    [("", "m2", "agree"), ("rejected: too", "m1", "undecided")],
)
def test_the_yardstick_is_a_fit_that_is_sound(
    tmp_path: Path, scene: MakeScene, second: str, yardstick: str, word: str
) -> None:
    rows = [
        spread(
            estimate(name, "standing wave", frequency_GHz=frequency, model_class=model_class),
            [speed, speed - 0.1, speed + 0.1],
            8.19,
        )
        for name, frequency, model_class, speed in (
            ("m1", 100.0, "rejected: leaves a half", 25.0),
            ("m2", 200.0, second, 16.5),
        )
    ]
    rows.append(spread(estimate("k", "waveform"), [16.5, 16.3, 16.6], 8.19))
    found = agreed(tmp_path, scene, rows, "extension")
    assert f"({yardstick})" in found.yardstick
    assert found.routes[-1].word == word


@pytest.mark.parametrize(("wavenumber", "said"), [(0.04, "the same"), (0.08, "another")])
def test_standing_waves_differ_by_wavelength_only_where_it_is_another(
    tmp_path: Path, scene: MakeScene, wavenumber: float, said: str
) -> None:
    shared = {"misfit": 0.1, "frequency_GHz": 113.0}
    rows = [
        spread(
            estimate("m", "standing wave", wavenumber_rad_per_A=0.04, **shared),
            [16.5, 16.4, 16.6],
            8.19,
        ),
        spread(
            estimate("h", "standing wave", wavenumber_rad_per_A=wavenumber, **shared),
            [14.0, 13.9, 14.1],
            8.19,
        ),
    ]
    found = agreed(tmp_path, scene, rows, "extension")
    assert f"({said} wavelength, " in found.routes[0].sentence
