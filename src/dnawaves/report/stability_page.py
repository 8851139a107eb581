"""The page of the stability suite: every hard case, what was expected of it and what was found."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

from dnawaves.files import write_text
from dnawaves.report.numbers import BLANK, counted, digits
from dnawaves.report.template import fill
from dnawaves.stability.judge import Row
from dnawaves.stability.table import read_table

TITLE = "Hard cases: what was expected, what was found"

HEADER = (
    "case",
    "what is done",
    "expected",
    "found",
    "verdict",
    "why that bound, and what else was seen",
    "processor seconds",
)


def stability_page_step(table: Path, output: Path) -> None:
    """Write the page of a table of cases."""
    write_text(output, render(read_table(table)))


def render(rows: Sequence[Row]) -> str:
    """Return the page as HTML that opens without a network."""
    return fill(
        "stability.html.j2",
        title=TITLE,
        summary=summary(rows),
        header=HEADER,
        groups=[(name, list(group)) for name, group in groupby(rows, lambda row: row.group)],
        number=_number,
        bound=_bound,
    )


def summary(rows: Sequence[Row]) -> str:
    """Return how many cases passed, and which failed."""
    failed = [row.case for row in rows if row.verdict == "fail"]
    seconds = sum(row.seconds for row in rows)
    text = f"{counted(len(rows), 'case')}, {len(rows) - len(failed)} as expected"
    text += f"; not so: {', '.join(failed)}" if failed else ""
    return f"{text}. They took {digits(seconds / 60)} minutes, one after the other."


def _number(value: float | None) -> str:
    """Return a count as it is, any other number with three digits."""
    if value is None:
        return BLANK
    return str(int(value)) if value.is_integer() and abs(value) < 1000 else digits(value)


def _bound(row: Row) -> str:
    """Return 'low to high', or the one number that is allowed."""
    low, high = _number(row.low), _number(row.high)
    return low if row.low == row.high else f"{low} to {high}"
