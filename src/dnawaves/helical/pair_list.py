"""Base pairs that the user lists, as an argument or as a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from dnawaves.errors import InputError
from dnawaves.helical.bases import Base

_COLUMNS = ("chain1", "resid1", "chain2", "resid2")


def read_pairs(path: Path) -> list[tuple[str, str]]:
    """Read base pairs as ("A:1", "B:24"), ... from a CSV file.

    Columns chain1, resid1, chain2, resid2; others are ignored. Lines go along strand I, 5' to 3'.
    An empty chain stands for whichever chain has that residue number.
    Raises `InputError` where it is no such file.
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = csv.DictReader(file)
            missing = [name for name in _COLUMNS if name not in (rows.fieldnames or ())]
            if missing:
                raise InputError(
                    f"{path}: found columns {', '.join(rows.fieldnames or ()) or 'none'};"
                    f" needed are {', '.join(_COLUMNS)}"
                )
            pairs = [_read_row(path, rows.line_num, row) for row in rows]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read as CSV: {error}") from error
    if not pairs:
        raise InputError(f"{path}: lists no base pair; needed is one in each line")
    return pairs


def _read_row(path: Path, line: int, row: dict[str, str]) -> tuple[str, str]:
    chain1, resid1, chain2, resid2 = ((row[name] or "").strip() for name in _COLUMNS)
    if not resid1 or not resid2:
        raise InputError(f"{path}, line {line}: a residue number is missing")
    return f"{chain1}:{resid1}", f"{chain2}:{resid2}"


def named_pairs(bases: Sequence[Base], pairs: Sequence[tuple[str, str]]) -> list[tuple[int, int]]:
    """Return the numbers of the bases that labels name, "A:1" or ":1" for a chain's or any.

    Raises `InputError` for a list that is empty, for a label that names no base or several, and
    for a base that is listed twice.
    """
    if not pairs:
        raise InputError("base pairs: the list is empty")
    labels: dict[str, list[int]] = {}
    for number, base in enumerate(bases):
        labels.setdefault(base.label, []).append(number)
        labels.setdefault(":" + base.label.rpartition(":")[2], []).append(number)
    found = [(_named(labels, first), _named(labels, second)) for first, second in pairs]
    seen: set[int] = set()
    for number in (number for pair in found for number in pair):
        if number in seen:
            raise InputError(
                f"base pairs: {bases[number].label} is listed twice; a base has one partner"
            )
        seen.add(number)
    return found


def _named(labels: dict[str, list[int]], label: str) -> int:
    numbers = labels.get(label, [])
    if len(numbers) != 1:
        known = [name for name in labels if not name.startswith(":")]
        raise InputError(
            f"base pairs: {len(numbers)} nucleotides are called {label!r};"
            ' one is needed, as chain (or segment) and residue number such as "A:1"; there are'
            f" {known[0]} to {known[-1]}"
        )
    return numbers[0]


def split_list(
    pairs: Sequence[tuple[int, int]], strand_of: Sequence[int]
) -> list[list[tuple[int, int]]]:
    """Return a list of pairs split into duplexes: where both strands change."""
    duplexes: list[list[tuple[int, int]]] = []
    for pair in pairs:
        before = duplexes[-1][-1] if duplexes else None
        if before is None or all(
            strand_of[here] != strand_of[there] for here, there in zip(before, pair, strict=True)
        ):
            duplexes.append([])
        duplexes[-1].append(pair)
    return duplexes
