"""Tables of the report as text: what each cell says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from dnawaves.report.numbers import between, counted, digits, percent


@dataclass(frozen=True)
class Table:
    """Header and rows of a table."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Verdict:
    """One estimate as text; `mood` is the first word of the verdict, after which it is coloured."""

    scene: str
    wave: str
    estimator: str
    speed: str
    interval: str
    kind: str
    paper: str
    ratio: str
    misfit: str
    half_kick_change: str
    verdict: str
    reason: str

    @property
    def mood(self) -> str:
        """One of agrees, disagrees, undecided, structure and no."""
        return self.verdict.split()[0].rstrip(",;")


VERDICT_HEADER = (
    "scene",
    "wave",
    "estimator",
    "speed (Å/ps)",
    "interval (Å/ps) and its kind",
    "paper (Å/ps)",
    "ratio",
    "misfit",
    "half-kick change",
    "verdict and reason",
)


def verdicts(table: pd.DataFrame) -> list[Verdict]:
    """Return every row of the comparison as text."""
    return [_verdict(row) for _, row in table.iterrows()]


def _verdict(row: pd.Series) -> Verdict:
    spread = f"{row['interval']} of {counted(row['variations'], 'fit')}"
    return Verdict(
        scene=row["scene"],
        wave=row["wave"],
        estimator=row["estimator"],
        speed=digits(row["speed_A_per_ps"]),
        interval=between(row["low_A_per_ps"], row["high_A_per_ps"]),
        kind=spread if row["variations"] else row["interval"],
        paper=digits(row["paper_A_per_ps"]),
        ratio=digits(row["ratio_to_paper"]),
        misfit=percent(row["misfit"]),
        half_kick_change=percent(row["half_kick_change"]),
        verdict=short_verdict(row),
        reason=row["reason"],
    )


def short_verdict(row: pd.Series) -> str:
    """Return the verdict without the ratio, which has a column of its own."""
    _, ratio, rest = str(row["verdict"]).partition(" times the paper's")
    return rest.lstrip(":; ") if ratio else str(row["verdict"])
