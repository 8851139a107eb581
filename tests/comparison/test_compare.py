"""Verdicts on tables made by hand, of which the answers are known."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from dnawaves.comparison.compare import ADDED, ONE, compare
from dnawaves.errors import InputError
from dnawaves.scene.models import SceneSpec
from dnawaves.waves.table import COLUMNS, Estimate, read_table, spread, write_table

MakeScene = Callable[..., SceneSpec]
B_DNA = {"d-e": "B-DNA"}


def table(tmp_path: Path, *estimates: Estimate) -> pd.DataFrame:
    path = tmp_path / "speeds.csv"
    write_table(path, estimates)
    return read_table(path)


def estimate(scene: str, estimator: str, **values: object) -> Estimate:
    return Estimate(scene, "extension", estimator, **{"system": "d-e", **values})  # type: ignore[arg-type]


def rod(constants_table: Callable[..., pd.DataFrame], speed_A_per_ps: object) -> pd.DataFrame:
    return constants_table(
        {
            "topology": {"spacing_A": 3.3},
            "hessian, segments of 16 steps": {"speed_extension_A_per_ps": speed_A_per_ps},
        }
    )


@pytest.mark.parametrize(
    ("speeds", "verdict"),
    [
        ([16.4, 15.0, 17.0], "2.00 times the paper's: disagree"),
        ([8.3, 8.0, 8.6], "1.01 times the paper's: agree"),
    ],
)
def test_the_paper_agrees_where_its_value_lies_in_the_interval(
    tmp_path: Path, scene: MakeScene, speeds: list[float], verdict: str
) -> None:
    row = spread(estimate("a", "standing wave", misfit=0.02), speeds, 8.19)
    compared = compare([table(tmp_path, row)], {"a": scene("a")}, B_DNA, {})
    assert compared.loc[0, "verdict"] == verdict
    # Without constants of the molecule there is nothing else to be held against.
    assert (compared.loc[0, "verdict_rod"], compared.loc[0, "verdict_lattice"]) == ("", "")
    assert compared.loc[0, "ratio_to_paper_low"] == pytest.approx(min(speeds) / 8.19)
    assert compared.loc[0, "ratio_to_paper_high"] == pytest.approx(max(speeds) / 8.19)


@pytest.mark.parametrize(
    ("own", "word"),
    [
        (16.0, "agree"),
        (14.0, "disagree"),
        ((14.0, 12.0, 16.0), "agree"),
        ((14.0, 8.0, 20.0), "undecided"),
    ],
)
def test_the_molecules_own_rod_has_an_interval_too(
    tmp_path: Path,
    scene: MakeScene,
    constants_table: Callable[..., pd.DataFrame],
    own: object,
    word: str,
) -> None:
    row = spread(estimate("a", "standing wave"), [15.8, 15.5, 16.3], 8.19)
    constants = {"d-e": rod(constants_table, own)}
    compared = compare([table(tmp_path, row)], {"a": scene("a")}, B_DNA, constants)
    assert compared.loc[0, "verdict_rod"] == word
    assert compared.loc[0, "verdict_lattice"] == word
    assert compared.loc[0, "verdict_paper"] == "disagree"


def test_a_fit_of_the_wrong_class_decides_nothing(tmp_path: Path, scene: MakeScene) -> None:
    row = spread(estimate("a", "waveform", misfit=0.7), [16.0, 15.9, 16.1], 8.19)
    rows = table(tmp_path, row)
    rows["model_class"] = "rejected: memory is left"
    compared = compare([rows], {"a": scene("a")}, B_DNA, {})
    assert compared.loc[0, "verdict_paper"] == "undecided"
    assert compared.loc[0, "why"] == "model rejected: memory is left"


def test_a_scene_that_left_b_form_says_so(tmp_path: Path, scene: MakeScene) -> None:
    row = spread(estimate("a", "standing wave"), [8.2], 8.19)
    left = {"d-e": "not B-DNA: interior rise 3.93 Å"}
    compared = compare([table(tmp_path, row)], {"a": scene("a")}, left, {})
    assert "not B-DNA: interior rise 3.93 Å" in compared.loc[0, "verdict"]


def test_a_null_has_no_speed_no_verdict_and_a_reason(tmp_path: Path, scene: MakeScene) -> None:
    rows = table(tmp_path, estimate("n", "none", reason="no wave: nothing was put in"))
    compared = compare([rows], {"n": scene("n", "none")}, B_DNA, {})
    assert compared.loc[0, "verdict"] == "no wave"
    assert compared.loc[0, "verdict_paper"] == ""
    assert pd.isna(compared.loc[0, "speed_A_per_ps"])
    assert compared.loc[0, "reason"]


@pytest.mark.parametrize(
    ("reason", "verdict"),
    [
        ("a wave: it is there", "false alarm"),
        ("moves by itself: a little", "no wave, but moves by itself"),
        ("too short", "no speed"),
    ],
)
def test_a_wave_in_a_null_is_a_false_alarm(
    tmp_path: Path, scene: MakeScene, reason: str, verdict: str
) -> None:
    rows = table(tmp_path, estimate("n", "none", reason=reason))
    compared = compare([rows], {"n": scene("n", "none")}, B_DNA, {})
    assert compared.loc[0, "verdict"] == verdict


def test_columns_survive_tables_with_empty_ones(tmp_path: Path, scene: MakeScene) -> None:
    first = table(tmp_path, estimate("n", "none", reason="no wave"))
    second = table(tmp_path, spread(estimate("a", "static"), [15.0], 8.19))
    scenes = {"n": scene("n", "none"), "a": scene("a", "static")}
    compared = compare([first, second], scenes, B_DNA, {})
    assert list(compared.columns) == [*COLUMNS, *ADDED]
    assert len(compared) == 2


def test_a_scene_or_a_system_that_is_not_known_is_refused(tmp_path: Path, scene: MakeScene) -> None:
    rows = table(tmp_path, estimate("a", "none"))
    with pytest.raises(InputError, match="scenes: found none for a"):
        compare([rows], {}, B_DNA, {})
    with pytest.raises(InputError, match="structures: found none for d-e"):
        compare([rows], {"a": scene("a")}, {}, {})


def structures(
    tmp_path: Path,
    scene: MakeScene,
    constants_table: Callable[..., pd.DataFrame],
    speeds: list[float],
    kinked: int = 0,
) -> pd.DataFrame:
    """Return the comparison of one scene in several structures, each with a rod of 15 Å/ps."""
    names = [f"m{number}" for number in range(len(speeds))]
    specs = {
        name: scene(name, environment=f"e{number}", seed=number)
        for number, name in enumerate(names)
    }
    tables = [
        table(
            tmp_path,
            spread(estimate(name, "standing wave", system=f"d-e{number}"), [speed], 8.19),
        )
        for number, (name, speed) in enumerate(zip(names, speeds, strict=True))
    ]
    forms = {f"d-e{i}": "kinked" if i < kinked else "B-DNA" for i in range(len(speeds))}
    constants = {system: rod(constants_table, 15.0) for system in forms}
    return compare(tables, specs, forms, constants)


def test_structures_are_judged_by_their_range(
    tmp_path: Path, scene: MakeScene, constants_table: Callable[..., pd.DataFrame]
) -> None:
    found = structures(tmp_path, scene, constants_table, [15.4, 14.5, 15.0, 16.0, 14.8])
    (group,) = (row for _, row in found.iterrows() if row["scope"] != ONE)
    assert group["scope"] == "over 5 inherent structures"
    assert (group["low_A_per_ps"], group["high_A_per_ps"]) == (14.5, 16.0)
    assert group["speed_A_per_ps"] == pytest.approx(15.14)
    assert (group["verdict_paper"], group["verdict_rod"]) == ("disagree", "agree")
    # The lattice's relation turned the frequency into the speed; its rod is the same for k = 0.
    assert group["ratio_to_lattice_low"] == pytest.approx(14.5 / 15)


def test_kinked_structures_are_counted_with_and_without(
    tmp_path: Path, scene: MakeScene, constants_table: Callable[..., pd.DataFrame]
) -> None:
    speeds = [20.0, 14.5, 15.0, 16.0, 14.8, 15.2]
    found = structures(tmp_path, scene, constants_table, speeds, kinked=1)
    every, sound = (row for _, row in found.iterrows() if row["scope"] != ONE)
    assert (every["scope"], every["structure"]) == (
        "over 6 inherent structures",
        "B-DNA in 5 of 6",
    )
    assert every["high_A_per_ps"] == 20.0
    assert sound["scope"] == "over 5 inherent structures of B-DNA"
    assert (sound["high_A_per_ps"], sound["structure"]) == (16.0, "B-DNA")
    # 20/15 alone makes the range too wide to say that the rod is right.
    assert (every["verdict_rod"], sound["verdict_rod"]) == ("undecided", "agree")


def test_too_few_structures_decide_nothing(
    tmp_path: Path, scene: MakeScene, constants_table: Callable[..., pd.DataFrame]
) -> None:
    found = structures(tmp_path, scene, constants_table, [15.4, 14.5, 15.0])
    group = found.iloc[-1]
    assert (group["verdict_rod"], group["why"]) == ("undecided", "only 3 inherent structures")


def test_lengths_are_a_group_of_their_own(tmp_path: Path, scene: MakeScene) -> None:
    specs = {
        "long": scene("long"),
        "short": scene("short", duplex="s", sequence="CGATCAGTCAGC"),
        "other": scene("other", duplex="o", sequence="CGATCAGTCG"),
    }
    rows = [
        spread(estimate(name, "standing wave", system=f"{system}-e"), [speed], 8.19)
        for name, system, speed in (("long", "d", 17.0), ("short", "s", 18.0), ("other", "o", 9.0))
    ]
    forms = {f"{system}-e": "B-DNA" for system in "dso"}
    found = compare([table(tmp_path, *rows)], specs, forms, {})
    (group,) = (row for _, row in found.iterrows() if row["scope"] != ONE)
    # The third is another sequence: with it more than the length would differ.
    assert (group["scope"], group["low_A_per_ps"]) == ("over 2 lengths", 17.0)


def test_many_lengths_are_no_draws_of_one_speed(tmp_path: Path, scene: MakeScene) -> None:
    sequence = "CGATCAGTCAGCTAGCATGCGTAC"
    names = [f"n{pairs}" for pairs in range(12, 23, 2)]
    specs = {name: scene(name, duplex=name, sequence=sequence[: int(name[1:])]) for name in names}
    rows = [
        spread(estimate(name, "standing wave", system=f"{name}-e"), [16.0, 15.9, 16.1], 8.19)
        for name in names
    ]
    found = compare([table(tmp_path, *rows)], specs, {f"{name}-e": "B-DNA" for name in names}, {})
    group = found.iloc[-1]
    assert (group["scope"], group["verdict_paper"]) == ("over 6 lengths", "undecided")
    assert group["why"] == "lengths are no draws of one speed"


@pytest.mark.parametrize(("speed", "word"), [(16.0, "disagree"), (8.0, "agree")])
def test_arrivals_over_several_lengths_give_one_speed_without_their_delay(
    tmp_path: Path, scene: MakeScene, speed: float, word: str
) -> None:
    sequence = "CGATCAGTCAGCTAGCATGCGTAC"
    names = [f"n{pairs}" for pairs in (12, 16, 20, 24)]
    specs = {
        name: scene(name, "kick", duplex=name, sequence=sequence[: int(name[1:])]) for name in names
    }
    rows = []
    for name, scatter_ps in zip(names, (0.01, -0.01, -0.01, 0.01), strict=True):
        length = 3.4 * int(name[1:])
        # A delay of half a picosecond; the paper's rod has one of 0.2.
        time, paper = 0.5 + length / speed + scatter_ps, 0.2 + length / 8.0
        one = estimate(name, "arrival", system=f"{name}-e", arrival_ps=time, paper_arrival_ps=paper)
        rows.append(spread(one, [length / time, 0.99 * length / time], length / paper))
    forms = {f"{name}-e": "B-DNA" for name in names}
    found = compare([table(tmp_path, *rows)], specs, forms, {})
    (flight,) = (row for _, row in found.iterrows() if row["estimator"] == "flight against length")
    assert flight["scope"] == "over 4 lengths"
    # The scatter has no trend with length.
    assert flight["speed_A_per_ps"] == pytest.approx(speed, rel=1e-4)
    assert flight["ratio_to_paper"] == pytest.approx(speed / 8.0, rel=1e-4)
    assert flight["verdict_paper"] == word
    # A pick that is in doubt has no part in it; two lengths and less are no line.
    doubtful = table(tmp_path, *rows).assign(model_class=["", "", "rejected: x", "rejected: x"])
    fewer = compare([doubtful], specs, forms, {})
    assert "flight against length" not in set(fewer["estimator"])


@pytest.mark.parametrize(
    ("low", "high", "interval", "word"),
    [
        # One replica: nothing says how well its speed is known.
        (None, None, "", "undecided"),
        # Of a spectrum the data set one limit only.
        (None, 9.6, "95 %, profile likelihood (Whittle)", "undecided"),
        (8.8, None, "95 %, profile likelihood (Whittle)", "disagree"),
        (None, None, "none: exact linear response", "disagree"),
    ],
)
def test_a_limit_that_the_data_do_not_set_is_far_away(
    tmp_path: Path,
    scene: MakeScene,
    low: float | None,
    high: float | None,
    interval: str,
    word: str,
) -> None:
    row = estimate(
        "a",
        "thermal spectrum",
        speed_A_per_ps=9.0,
        low_A_per_ps=low,
        high_A_per_ps=high,
        interval=interval,
        paper_A_per_ps=8.19,
    )
    compared = compare([table(tmp_path, row)], {"a": scene("a")}, B_DNA, {})
    assert compared.loc[0, "verdict_paper"] == word
    assert compared.loc[0, "ratio_to_paper_low"] >= 0


def test_names_that_pandas_takes_for_missing_values_survive(tmp_path: Path) -> None:
    read = table(tmp_path, *(estimate(name, "none") for name in ("null", "NA", "nan")))
    assert read["scene"].tolist() == ["null", "NA", "nan"]
    assert read["reason"].tolist() == ["", "", ""]
    assert read["speed_A_per_ps"].isna().all()
