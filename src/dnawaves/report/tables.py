"""Tables of the report as text: what each cell says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from dnawaves.comparison.compare import B_DNA, ONE, RODS
from dnawaves.comparison.judge import Band
from dnawaves.report.numbers import BLANK, band, between, counted, digits, missing, percent
from dnawaves.waves.table import MODEL_SPREAD


@dataclass(frozen=True)
class Table:
    """Header and rows of a table."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Held:
    """An estimate against one rod: the rod's speed, the ratio to it with its interval, a word."""

    speed: str
    ratio: str
    word: str


@dataclass(frozen=True)
class Verdict:
    """One estimate as text, against the three rods: the paper's, the own rod, the own lattice."""

    scene: str
    wave: str
    estimator: str
    scope: str
    speed: str
    interval: str
    kind: str
    paper: Held
    rod: Held
    lattice: Held
    misfit: str
    half_kick_change: str
    remark: str


VERDICT_HEADER = (
    "scene",
    "wave",
    "estimator",
    "speed (Å/ps)",
    "interval (Å/ps) and its kind",
    "(a) the paper's rod",
    "(b) its own rod",
    "(c) its own lattice",
    "misfit",
    "half-kick change",
    "remarks",
)


def verdicts(table: pd.DataFrame) -> list[Verdict]:
    """Return every row of the comparison as text."""
    return [_verdict(row) for _, row in table.iterrows()]


def spreads(table: pd.DataFrame) -> Table | None:
    """Return what groups of structures and lengths say together; None where there are none."""
    groups = table[table["scope"] != ONE]
    if groups.empty:
        return None
    header = ("wave", "estimator", "scope", "mean and range (Å/ps)")
    return Table(
        (*header, *VERDICT_HEADER[5:8], "structures"),
        [
            [
                row["wave"],
                row["estimator"] + (", harmonic" if row["method"] == "harmonic" else ""),
                row["scope"],
                _speed(row),
                *(_in_one(held(row, rod)) for rod in RODS),
                row["structure"],
            ]
            for _, row in groups.iterrows()
        ],
    )


def held(row: pd.Series, rod: str) -> Held:
    """Return how an estimate stands against one of the three rods."""
    ends = (row.get(f"ratio_to_{rod}{end}") for end in ("", "_low", "_high"))
    ratio = [float("nan") if value is None else float(value) for value in ends]
    return Held(
        digits(row.get(f"{rod}_A_per_ps")),
        BLANK if missing(ratio[0]) else band(Band.of(*ratio)),
        str(row.get(f"verdict_{rod}", "")),
    )


def _in_one(one: Held) -> str:
    return BLANK if one.ratio == BLANK else f"{one.ratio} × {one.speed}, {one.word}"


def _speed(row: pd.Series) -> str:
    if missing(row["speed_A_per_ps"]):
        return BLANK
    return band(Band.of(*(float(row[f"{end}_A_per_ps"]) for end in ("speed", "low", "high"))))


def _kind(row: pd.Series) -> str:
    """Return the interval's method; what a model spread is over, the page says once."""
    if str(row["interval"]).startswith(MODEL_SPREAD):
        return f"{MODEL_SPREAD}, {counted(row['variations'], 'fit')}"
    return str(row["interval"])


def _verdict(row: pd.Series) -> Verdict:
    structure = "" if row["structure"] == B_DNA else f"structure is {row['structure']}"
    remarks = (row["why"], row["reason"], structure)
    return Verdict(
        scene=row["scene"],
        wave=row["wave"],
        estimator=row["estimator"],
        scope=row["scope"],
        speed=digits(row["speed_A_per_ps"]),
        interval=between(row["low_A_per_ps"], row["high_A_per_ps"]),
        kind=_kind(row),
        paper=held(row, "paper"),
        rod=held(row, "rod"),
        lattice=held(row, "lattice"),
        misfit=percent(row["misfit"]),
        half_kick_change=percent(row["half_kick_change"]),
        remark="; ".join(dict.fromkeys(filter(None, remarks))),
    )
