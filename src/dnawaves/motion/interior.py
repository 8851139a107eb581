"""Which steps of a duplex are its interior."""

from __future__ import annotations

# Terminal steps fray; two off each end are left out of a mean.
TERMINAL_STEPS = 2


def interior(steps: int) -> slice:
    """Return the steps that count in a mean, of so many; all of them in the shortest duplexes."""
    margin = TERMINAL_STEPS if steps > 2 * TERMINAL_STEPS else 0
    return slice(margin, steps - margin)
