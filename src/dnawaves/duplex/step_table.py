"""Step and pair parameters from the CSV tables that `dnawaves helical --output` writes."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from dnawaves.errors import InputError
from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.frames.vectors import Array


def read_step_table(path: Path, frame: int | None = None) -> Array:
    """Return shift, slide, rise (Å), tilt, roll, twist (degrees) (6, steps), rows as they come.

    Needs the columns shift_A to twist_deg; `frame` picks one from a table with a column `frame`
    and several in it. Raises `InputError` for a missing column, frame or number.
    """
    return _read(path, STEP_PARAMETERS, frame)


def read_pair_table(path: Path, frame: int | None = None) -> Array:
    """Return shear to opening (6, pairs) from shear_A to opening_deg, as `read_step_table`."""
    return _read(path, PAIR_PARAMETERS, frame)


def _read(path: Path, names: tuple[str, ...], frame: int | None) -> Array:
    columns = [f"{name}_A" for name in names[:3]] + [f"{name}_deg" for name in names[3:]]
    try:
        with open(path, encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            found = list(reader.fieldnames or [])
            rows = [(reader.line_num, row) for row in reader]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as a CSV table: {error}") from None
    missing = [column for column in columns if column not in found]
    if missing:
        raise InputError(
            f"{path}: found the columns {', '.join(found) or 'none'}; missing: {', '.join(missing)}"
        )
    frames = list(dict.fromkeys(row["frame"] for _, row in rows)) if "frame" in found else [None]
    if frame is None and len(frames) > 1:
        raise InputError(f"{path}: holds {len(frames)} frames; say which one")
    if frame is not None:
        rows = [(line, row) for line, row in rows if row.get("frame") == str(frame)]
    if not rows:
        raise InputError(f"{path}: found no rows" + ("" if frame is None else f" of frame {frame}"))
    return np.array(
        [[_number(path, line, row, column) for column in columns] for line, row in rows]
    ).T


def _number(path: Path, line: int, row: dict[str, str], column: str) -> float:
    try:
        value = float(row[column])
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"{path}: line {line}: {column} is {row[column]!r}; allowed: a number"
            " (nothing can be built from an undefined parameter)"
        )
    return value
