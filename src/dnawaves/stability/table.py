"""The table of all cases: one row each, in the order of their declaration."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from dnawaves.files import read_json, whole_file
from dnawaves.stability.case import cases
from dnawaves.stability.judge import Row

COLUMNS = tuple(Row.model_fields)


def read_rows(paths: Sequence[Path]) -> list[Row]:
    """Return the rows of some files, in the order of their declaration."""
    order = list(cases())
    rows = [Row.model_validate(read_json(path)) for path in paths]
    return sorted(rows, key=lambda row: order.index(row.case))


def write_table(rows: Sequence[Row], output: Path) -> None:
    """Write the rows as CSV."""
    table = pd.DataFrame([row.model_dump() for row in rows], columns=list(COLUMNS))
    with whole_file(output) as temporary:
        table.to_csv(temporary, index=False)


def read_table(path: Path) -> list[Row]:
    """Return the rows that `write_table` wrote."""
    table = pd.read_csv(path, keep_default_na=False, na_values={"value": [""]})
    records = table.astype({"value": object}).where(table.notna(), None).to_dict("records")
    return [Row.model_validate(record) for record in records]
