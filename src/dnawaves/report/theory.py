"""The paper's theory: what to read with care."""

from __future__ import annotations

from dnawaves.report.tables import Table
from dnawaves.rod.errata import errata


def errata_table() -> Table:
    """Return the points of the paper that matter for the comparison."""
    return Table(
        ["the paper", "what holds", "shown by"],
        [[point.paper, point.correct, point.shown_by] for point in errata()],
    )
