"""The step that puts all scenes' estimates into one table with verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, whole_file
from dnawaves.waves.table import CSV_FORMAT, TEXT_COLUMNS, read_table

# Estimators of one wave that differ by more than this are said to disagree.
AGREEMENT = 0.10


def compare_step(speeds: Sequence[Path], structures: Sequence[Path], output: Path) -> None:
    """Write the comparison of all scenes with the paper's rod.

    `speeds` are the scenes' tables, `structures` the inspections of their systems.
    """
    verdicts = {}
    for path in structures:
        attributes = read_netcdf(path).attrs
        verdicts[str(attributes["system"])] = str(attributes["verdict"])
    table = compare([read_table(path) for path in speeds], verdicts)
    with whole_file(output) as temporary:
        table.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def compare(tables: Sequence[pd.DataFrame], b_form: Mapping[str, str]) -> pd.DataFrame:
    """Return one table with a verdict on every estimate and on the structure it was made in."""
    table = pd.concat(
        [table.dropna(axis="columns", how="all") for table in tables], ignore_index=True
    ).reindex(columns=tables[0].columns)
    text = list(TEXT_COLUMNS)
    table[text] = table[text].astype(object).fillna("")
    unknown = sorted(set(table["system"]) - set(b_form))
    if unknown:
        raise InputError(
            f"structures: found none for {', '.join(unknown)}; allowed: one for each system"
        )
    table["structure"] = [b_form[str(system)] for system in table["system"]]
    table["verdict"] = [_verdict(row) for _, row in table.iterrows()]
    return table


def _verdict(row: pd.Series) -> str:
    structure = "" if row["structure"] == "B-DNA" else f"; structure is {row['structure']}"
    return _verdict_on_speed(row) + structure


def _verdict_on_speed(row: pd.Series) -> str:
    if pd.isna(row["speed_A_per_ps"]):
        return "no wave" if row["reason"].startswith("no wave") else "no speed"
    ratio = f"{row['ratio_to_paper']:.2f} times the paper's"
    if "poor fit" in row["reason"]:
        return f"{ratio}: undecided, poor fit"
    low, high = row["low_A_per_ps"], row["high_A_per_ps"]
    if not pd.isna(low) and low <= row["paper_A_per_ps"] <= high:
        return f"{ratio}: agrees"
    return f"{ratio}: disagrees"


def agreement(table: pd.DataFrame, wave: str) -> list[str]:
    """Return sentences on how the estimators of one wave in one system agree with each other.

    The lowest standing wave is the yardstick; where an estimator is further from it than 10 %,
    the sentence says what is known about why.
    """
    return [
        sentence
        for _, group in table[table["wave"] == wave].groupby("system", sort=False)
        for sentence in _agreement_in_system(group)
    ]


def lowest_first(rows: pd.DataFrame) -> pd.DataFrame:
    """Return estimates by frequency, those of simulated scenes before the harmonic ones."""
    return rows.assign(exact=rows["method"] != "simulated").sort_values(["exact", "frequency_GHz"])


def _agreement_in_system(group: pd.DataFrame) -> list[str]:
    known = group[group["speed_A_per_ps"].notna()]
    standing = lowest_first(known[known["estimator"] == "standing wave"])
    if standing.empty:
        return []
    yardstick = standing.iloc[0]
    speed = float(yardstick["speed_A_per_ps"])
    sentences = [
        f"Yardstick: the lowest standing wave ({yardstick['scene']}), {speed:.1f} Å/ps at "
        f"{yardstick['frequency_GHz']:.0f} GHz."
    ]
    for _, row in known.iterrows():
        if row["scene"] == yardstick["scene"] or "held" in row["estimator"]:
            continue
        change = float(row["speed_A_per_ps"]) / speed - 1
        words = "agrees" if abs(change) <= AGREEMENT else "differs"
        if words == "agrees" and "poor fit" in row["reason"]:
            words = "agrees, but by a poor fit"
        # Adding zero turns a negative one into a positive one.
        percent = f"{round(change, 2) + 0.0:+.0%}".replace("-", "−")
        sentence = f"{row['scene']}, {row['estimator']}: {percent}, {words}"
        why = f" ({_why(row, known, speed)})" if words == "differs" else ""
        sentences.append(f"{sentence}{why}.")
    return sentences


def _why(row: pd.Series, group: pd.DataFrame, yardstick_A_per_ps: float) -> str:
    estimator = row["estimator"]
    if estimator.startswith("static"):
        held = group.loc[group["estimator"] == "static, held across", "speed_A_per_ps"]
        if len(held) and row["speed_A_per_ps"] < yardstick_A_per_ps < held.iloc[0]:
            return (
                "at rest the base pairs follow the load across the axis as well; with that held "
                f"it gives {held.iloc[0]:.1f}, and the wave lies between"
            )
        return "no reason found"
    if estimator == "standing wave":
        return (
            f"a shorter wave, {row['frequency_GHz']:.0f} GHz, in which other branches mix: "
            f"misfit {row['misfit']:.2f}"
        )
    if estimator == "arrival":
        return (
            "the pick is biased by the kick's width and the end; the paper's rod has the same bias "
            f"and arrives {row['ratio_to_paper']:.2f} times later"
        )
    if estimator == "resonance":
        return (
            "a force on a few base pairs drives more than the lowest mode: "
            f"misfit {row['misfit']:.2f}"
        )
    return f"the uniform chain is the wrong model for this record: misfit {row['misfit']:.2f}"
