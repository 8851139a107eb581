"""All estimates side by side, each held against three rods; and what several scenes say together.

The three rods: (a) the paper's; (b) the continuous rod with constants measured in the same
molecule without any wave; (c) the lattice of rigid base pairs with the same constants.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from math import inf, isnan, nan

import pandas as pd

from dnawaves.comparison.groups import LENGTHS, Group, groups
from dnawaves.comparison.judge import Band, Judgement, judge, judge_structures, range_of
from dnawaves.comparison.predictions import NOTHING, Prediction, predict
from dnawaves.errors import InputError
from dnawaves.scene.models import SceneSpec
from dnawaves.waves.flights import FEWEST_LENGTHS, flight_row
from dnawaves.waves.table import TEXT_COLUMNS

ONE = "one structure"
RODS = ("paper", "rod", "lattice")
PREDICTED = tuple(
    f"{rod}_{end}A_per_ps" for rod in ("rod", "lattice") for end in ("", "low_", "high_")
)
RATIOS = tuple(
    f"ratio_to_{rod}{end}"
    for rod in RODS
    for end in ("", "_low", "_high")
    if (rod, end) != ("paper", "")
)
ADDED_TEXT = ("scope", "structure", *(f"verdict_{rod}" for rod in RODS), "why", "verdict")
ADDED = (*PREDICTED, *RATIOS, *ADDED_TEXT)
B_DNA = "B-DNA"
# How the reason of a null begins, and what that means where nothing was put in.
NULL_WORDS = {
    "no wave": "no wave",
    "moves by itself": "no wave, but moves by itself",
    "a wave": "false alarm",
}


def compare(
    tables: Sequence[pd.DataFrame],
    scenes: Mapping[str, SceneSpec],
    b_form: Mapping[str, str],
    constants: Mapping[str, pd.DataFrame],
) -> pd.DataFrame:
    """Return one table with three verdicts on every estimate, and on those of groups of scenes.

    `scenes` are the specifications by name; `b_form` says of each system whether it is B-DNA,
    `constants` are its rod's by route (see `waves.constants.gather`). The rows of groups, `scope`
    other than 'one structure', come last.
    """
    table = pd.concat(
        [table.dropna(axis="columns", how="all") for table in tables], ignore_index=True
    ).reindex(columns=tables[0].columns)
    text = [name for name in TEXT_COLUMNS if name in table]
    table[text] = table[text].astype(object).fillna("")
    _require("scenes", table["scene"], scenes)
    _require("structures", table["system"], b_form)
    table["structure"] = [b_form[str(system)] for system in table["system"]]
    table["scope"] = ONE
    judged = [
        _judged(row, scenes[str(row["scene"])], constants.get(str(row["system"])))
        for _, row in table.iterrows()
    ]
    table = pd.concat([table, pd.DataFrame(judged, index=table.index)], axis="columns").reindex(
        columns=[*tables[0].columns, *ADDED]
    )
    together = [
        row
        for group in groups(scenes.values())
        for row in _of_group(group, table[table["scene"].isin(group.scenes)])
    ]
    if together:
        table = pd.concat([table, pd.DataFrame(together)], ignore_index=True)
    table[list(ADDED_TEXT)] = table[list(ADDED_TEXT)].astype(object).fillna("")
    return table


def _require(what: str, names: Iterable[str], known: Mapping[str, object]) -> None:
    unknown = sorted(set(names) - set(known))
    if unknown:
        raise InputError(f"{what}: found none for {', '.join(unknown)}; allowed: one for each")


def doubt(row: pd.Series) -> str:
    """Return why an estimate decides nothing; empty where it may."""
    model_class = str(row.get("model_class", ""))
    return f"model {model_class}" if model_class.startswith("rejected") else ""


def sound(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the estimates without a doubt, all of them where each has one."""
    sure = [not doubt(row) for _, row in rows.iterrows()]
    return rows[sure] if any(sure) else rows


def _judged(row: pd.Series, scene: SceneSpec, constants: pd.DataFrame | None) -> dict[str, object]:
    """Return the predictions, the three words, why they are so, and all of it as a sentence."""
    if pd.isna(row["speed_A_per_ps"]):
        seen = str(row["reason"]).partition(":")[0]
        said = NULL_WORDS.get(seen, "no speed")
        return {"verdict": said + _structure(row), **{f"verdict_{rod}": "" for rod in RODS}}
    found = NOTHING if constants is None else predict(row, scene, constants)
    measured = speed_of(row)
    predicted = {
        "paper": Band.of(float(row["paper_A_per_ps"])) if pd.notna(row["paper_A_per_ps"]) else None,
        "rod": found.rod,
        "lattice": found.lattice,
    }
    judgements = {
        rod: (
            ratio := measured.over(band),
            judge(ratio, doubt(row) or ("" if rod == "paper" else found.doubt)),
        )
        for rod, band in predicted.items()
        if band is not None
    }
    return {**_numbers(found), **_words(row, judgements)}


def speed_of(row: pd.Series) -> Band:
    """Return an estimate's speed; a limit that its data do not set is zero or infinite.

    Only of an exact speed, whose `interval` says "none", a missing limit is the speed itself.
    """
    value, low, high = (float(row[f"{end}_A_per_ps"]) for end in ("speed", "low", "high"))
    if str(row["interval"]).startswith("none"):
        return Band.of(value, low, high)
    return Band(value, 0.0 if isnan(low) else low, inf if isnan(high) else high)


def _numbers(found: Prediction) -> dict[str, object]:
    numbers: dict[str, object] = {}
    for rod, band in (("rod", found.rod), ("lattice", found.lattice)):
        if band is not None:
            for end, value in (("", band.value), ("low_", band.low), ("high_", band.high)):
                numbers[f"{rod}_{end}A_per_ps"] = value
    return numbers


CALLED = {"paper": "the paper's", "rod": "its own rod's", "lattice": "its own lattice's"}


def _words(row: pd.Series, judgements: Mapping[str, tuple[Band, Judgement]]) -> dict[str, object]:
    whys = dict.fromkeys(judgement.why for _, judgement in judgements.values() if judgement.why)
    sentence = ", ".join(
        f"{ratio.value:.2f} times {CALLED[rod]}: {judgement.word}"
        for rod, (ratio, judgement) in judgements.items()
    )
    ratios = {
        f"ratio_to_{rod}{end}": value
        for rod, (ratio, _) in judgements.items()
        for end, value in (("", ratio.value), ("_low", ratio.low), ("_high", ratio.high))
        # An estimate brings its own ratio to the paper's.
        if (rod, end) != ("paper", "") or row["scope"] != ONE
    }
    return {
        **ratios,
        **{f"verdict_{rod}": judgements[rod][1].word if rod in judgements else "" for rod in RODS},
        "why": "; ".join(whys),
        "verdict": sentence + _structure(row),
    }


def _structure(row: pd.Series) -> str:
    return "" if row["structure"] == B_DNA else f"; structure is {row['structure']}"


def _of_group(group: Group, table: pd.DataFrame) -> list[dict[str, object]]:
    """Return the rows of a group: one for each estimate, with and without what is not B-DNA."""
    rows = []
    for _, members in table.groupby(["wave", "estimator"], sort=False):
        known = members[members["speed_A_per_ps"].notna()]
        if len(known) < 2:
            continue
        rows.append(_together(group, known, f"over {len(known)} {group.kind}"))
        b_dna = known[known["structure"] == B_DNA]
        if 1 < len(b_dna) < len(known):
            rows.append(_together(group, b_dna, f"over {len(b_dna)} {group.kind} of B-DNA"))
    if group.kind == LENGTHS:
        picked = table[(table["estimator"] == "arrival") & table["speed_A_per_ps"].notna()]
        arrivals = picked[[not doubt(row) for _, row in picked.iterrows()]]
        if len(arrivals) >= FEWEST_LENGTHS:
            rows.append(_flight(group, arrivals))
    return rows


def _flight(group: Group, arrivals: pd.DataFrame) -> dict[str, object]:
    """Return the row of the time of flight against length, judged against the paper's rod's."""
    estimate = flight_row(arrivals)
    row: dict[str, object] = {
        **asdict(estimate),
        "scene": group.scenes[0],
        "system": arrivals.iloc[0]["system"],
        "method": arrivals.iloc[0]["method"],
        "scope": f"over {len(arrivals)} {group.kind}",
        "structure": _structures(arrivals),
    }
    found = pd.Series(row).fillna(nan)
    if estimate.speed_A_per_ps is None:
        return {**row, "verdict": "no speed" + _structure(found)}
    ratio = speed_of(found).over(Band.of(float(found["paper_A_per_ps"])))
    return {**row, **_words(found, {"paper": (ratio, judge(ratio))})}


def _together(group: Group, members: pd.DataFrame, scope: str) -> dict[str, object]:
    """Return the mean and range of a group's speeds; it is judged by ratios, each to its own rod.

    Over lengths there is no verdict: the waves differ too.
    """
    first = members.iloc[0]
    speeds = range_of(list(members["speed_A_per_ps"]))
    row: dict[str, object] = {
        **{name: first[name] for name in ("wave", "estimator", "method")},
        "scene": group.scenes[0],
        "system": first["system"],
        "scope": scope,
        "structure": _structures(members),
        "speed_A_per_ps": speeds.value,
        "low_A_per_ps": speeds.low,
        "high_A_per_ps": speeds.high,
        "interval": "range",
        "variations": len(members),
        "reason": f"mean of {', '.join(members['scene'])}",
    }
    doubts = ["lengths are no draws of one speed"] if group.kind == LENGTHS else []
    doubts += [doubt(one) for _, one in members.iterrows()]
    unsure = "; ".join(dict.fromkeys(filter(None, doubts)))
    judgements = {}
    for rod in RODS:
        predicted = members[f"{rod}_A_per_ps"]
        if predicted.isna().any():
            continue
        band = range_of(list(predicted))
        ratios = list(members["speed_A_per_ps"] / predicted)
        row[f"{rod}_A_per_ps"] = band.value
        if rod != "paper":
            row[f"{rod}_low_A_per_ps"], row[f"{rod}_high_A_per_ps"] = band.low, band.high
        judgements[rod] = (range_of(ratios), judge_structures(ratios, unsure, group.kind))
    return {**row, **_words(pd.Series(row), judgements)}


def _structures(members: pd.DataFrame) -> str:
    sound = int((members["structure"] == B_DNA).sum())
    if sound == len(members):
        return B_DNA
    return f"B-DNA in {sound} of {len(members)}"
