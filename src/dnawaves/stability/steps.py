"""The steps of the suite, from a case's name to its row and from rows to the table."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from dnawaves.files import write_json
from dnawaves.stability.case import case_named
from dnawaves.stability.judge import judge
from dnawaves.stability.table import read_rows, write_table


def stability_step(name: str, output: Path) -> None:
    """Run one case and write its row as JSON, whether it passes or fails."""
    row = judge(name, case_named(name))
    number = "no number" if row.value is None else f"{row.value:.3g}"
    print(
        f"{name}: {row.verdict}: expected {row.expected}, {row.low:g} to {row.high:g}; found "
        f"{row.found}, {number} ({row.quantity}) in {row.seconds:.1f} s. {row.remark}",
        file=sys.stderr,
    )
    write_json(output, row.model_dump())


def table_step(rows: Sequence[Path], output: Path) -> None:
    """Write the table of all rows as CSV."""
    write_table(read_rows(rows), output)
