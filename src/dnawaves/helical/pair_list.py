"""Base pairs that the user lists, as an argument or as a CSV file."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from dnawaves.errors import InputError
from dnawaves.helical.bases import Base

_COLUMNS = ("chain1", "resid1", "chain2", "resid2")


def read_pairs(path: Path) -> list[tuple[str, str]]:
    """Read base pairs as ("A:1", "B:24"), ... from a CSV file.

    Columns chain1, resid1, chain2, resid2; others are ignored. Lines go along strand I, 5' to 3'.
    An empty chain stands for whichever chain has that residue number, or that number among all
    nucleotides: "#13".
    Raises `InputError` where it is no such file.
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = csv.DictReader(file, skipinitialspace=True)
            rows.fieldnames = [name.strip() for name in rows.fieldnames or ()]
            missing = [name for name in _COLUMNS if name not in rows.fieldnames]
            if missing:
                raise InputError(
                    f"{path}: found columns {', '.join(rows.fieldnames) or 'none'};"
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


def uniquely_labelled(bases: Sequence[Base]) -> list[Base]:
    """Return the bases, those that share a label told apart by their number: "SYSTEM:1#13".

    Formats without chains number each strand from 1 (GRO).
    """
    times = Counter(base.label for base in bases)
    return [
        replace(base, label=f"{base.label}#{number}") if times[base.label] > 1 else base
        for number, base in enumerate(bases, start=1)
    ]


def named_pairs(bases: Sequence[Base], pairs: Sequence[tuple[str, str]]) -> list[tuple[int, int]]:
    """Return the numbers of the bases that labels name.

    "A:1", ":1" for that of any chain, "#13" for the thirteenth of all.
    Raises `InputError` for a list that is empty or not of pairs, for a label that names no base or
    several, and for a base that is listed twice.
    """
    if not pairs:
        raise InputError("base pairs: the list is empty")
    labels: dict[str, list[int]] = {}
    for number, base in enumerate(bases):
        labels[f":#{number + 1}"] = [number]
        for name in {base.label, ":" + base.label.rpartition(":")[2]}:
            labels.setdefault(name, []).append(number)
    found = [
        (_named(labels, first), _named(labels, second)) for first, second in map(_two_labels, pairs)
    ]
    seen: set[int] = set()
    for number in (number for pair in found for number in pair):
        if number in seen:
            raise InputError(
                f"base pairs: {bases[number].label} is listed twice; a base has one partner"
            )
        seen.add(number)
    return found


def _two_labels(pair: object) -> tuple[str, str]:
    if isinstance(pair, tuple | list) and len(pair) == 2 and all(isinstance(p, str) for p in pair):
        return pair[0], pair[1]
    raise InputError(f'base pairs: found {pair!r}; needed are pairs such as ("A:1", "B:24")')


def _named(labels: dict[str, list[int]], label: str) -> int:
    numbers = labels.get(":" + label if label.startswith("#") else label, [])
    if len(numbers) != 1:
        known = [name for name in labels if not name.startswith(":")] or list(labels)
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


def refuse_shuffled(
    bases: Sequence[Base],
    duplexes: Sequence[Sequence[tuple[int, int]]],
    strand_of: Sequence[int],
) -> None:
    """Raise `InputError` for duplexes that are not listed in one piece, along both strands.

    Strand I goes from 5' to 3'; strand II one way, against it or along it; where a strand
    changes, as at a nick, it may go on anywhere.
    """

    def label(pair: tuple[int, int]) -> str:
        return "-".join(bases[number].label for number in pair)

    last: dict[tuple[int, int], Sequence[tuple[int, int]]] = {}
    for duplex in duplexes:
        strands = (strand_of[duplex[0][0]], strand_of[duplex[0][1]])
        if len(last.get(strands, ())) == 1:
            raise InputError(
                f"base pairs: the list leaves the strands of {label(last[strands][0])} after that"
                f" pair and comes back to them with {label(duplex[0])}; list one duplex after the"
                " other"
            )
        last[strands] = duplex
        way: int | None = None
        for here, there in pairwise(duplex):
            if strand_of[here[0]] == strand_of[there[0]] and there[0] < here[0]:
                raise InputError(
                    f"base pairs: from {label(here)} to {label(there)} the list goes along strand I"
                    " from 3' to 5'; list it from 5' to 3'"
                )
            if strand_of[here[1]] == strand_of[there[1]]:
                before, way = way, 1 if there[1] > here[1] else -1
                if before not in (None, way):
                    raise InputError(
                        f"base pairs: from {label(here)} to {label(there)} the list turns back"
                        " along strand II; list the pairs in the order of both strands"
                    )
