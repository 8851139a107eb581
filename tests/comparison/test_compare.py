"""Verdicts and the agreement of estimators, on tables made by hand."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from dnawaves.comparison.steps import agreement, compare
from dnawaves.waves.table import COLUMNS, Estimate, read_table, spread, write_table


def table(tmp_path: Path, *estimates: Estimate) -> pd.DataFrame:
    path = tmp_path / "speeds.csv"
    write_table(path, estimates)
    return read_table(path)


def estimate(scene: str, estimator: str, **values: object) -> Estimate:
    return Estimate(scene, "extension", estimator, system="d-e", **values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("speeds", "verdict"),
    [
        ([16.4, 15.0, 17.0], "2.00 times the paper's: disagrees"),
        ([8.3, 8.0, 8.6], "1.01 times the paper's: agrees"),
    ],
)
def test_the_paper_agrees_where_its_value_lies_in_the_interval(
    tmp_path: Path, speeds: list[float], verdict: str
) -> None:
    row = spread(estimate("a", "standing wave", misfit=0.02), speeds, 8.19)
    compared = compare([table(tmp_path, row)], {"d-e": "B-DNA"})
    assert compared.loc[0, "verdict"] == verdict
    assert compared.loc[0, "low_A_per_ps"] == pytest.approx(min(speeds))
    assert compared.loc[0, "high_A_per_ps"] == pytest.approx(max(speeds))


def test_a_scene_that_left_b_form_says_so(tmp_path: Path) -> None:
    row = spread(estimate("a", "standing wave"), [8.2], 8.19)
    compared = compare([table(tmp_path, row)], {"d-e": "not B-DNA: interior rise 3.93 Å"})
    assert "not B-DNA: interior rise 3.93 Å" in compared.loc[0, "verdict"]


def test_a_null_has_no_speed_and_a_reason(tmp_path: Path) -> None:
    compared = compare(
        [table(tmp_path, estimate("n", "none", reason="no wave: nothing was put in"))],
        {"d-e": "B-DNA"},
    )
    assert compared.loc[0, "verdict"] == "no wave"
    assert pd.isna(compared.loc[0, "speed_A_per_ps"])
    assert compared.loc[0, "reason"]


def test_a_poor_fit_decides_nothing(tmp_path: Path) -> None:
    row = spread(
        estimate("a", "waveform", misfit=0.7, reason="poor fit: too much is left"), [16.0], 8.19
    )
    compared = compare([table(tmp_path, row)], {"d-e": "B-DNA"})
    assert compared.loc[0, "verdict"].endswith("undecided, poor fit")


def test_columns_survive_tables_with_empty_ones(tmp_path: Path) -> None:
    first = table(tmp_path, estimate("n", "none", reason="no wave"))
    second = table(tmp_path, spread(estimate("a", "static"), [15.0], 8.19))
    compared = compare([first, second], {"d-e": "B-DNA"})
    assert list(compared.columns) == [*COLUMNS, "structure", "verdict"]
    assert len(compared) == 2


def test_agreement_names_what_differs_and_why(tmp_path: Path) -> None:
    rows = [
        spread(estimate("m1", "standing wave", frequency_GHz=113.0, misfit=0.03), [16.5], 8.19),
        spread(estimate("k", "waveform", misfit=0.4), [15.9], 8.19),
        spread(estimate("l", "static"), [13.7], 8.19),
        spread(estimate("l", "static, held across"), [17.7], 8.19),
    ]
    sentences = agreement(compare([table(tmp_path, *rows)], {"d-e": "B-DNA"}), "extension")
    assert "m1" in sentences[0] and "16.5" in sentences[0]
    assert sentences[1].startswith("k, waveform: −4%, agrees")
    assert sentences[2].startswith("l, static: −17%, differs") and "17.7" in sentences[2]
    assert len(sentences) == 3


def test_names_that_pandas_takes_for_missing_values_survive(tmp_path: Path) -> None:
    read = table(tmp_path, *(estimate(name, "none") for name in ("null", "NA", "nan")))
    assert read["scene"].tolist() == ["null", "NA", "nan"]
    assert read["reason"].tolist() == ["", "", ""]
    assert read["speed_A_per_ps"].isna().all()
