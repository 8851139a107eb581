"""Which base pairs of a scene are held and which are excited, as indices from 0."""

from __future__ import annotations

from dnawaves.scene.excitations import Kick, Periodic, Pulse
from dnawaves.scene.models import Ends


def held_counts(ends: Ends) -> tuple[int, int]:
    """Return how many base pairs do not move at the first and at the last end."""
    first, last = (ends.pairs if end == "held" else 0 for end in (ends.first, ends.last))
    return first, last


def fixed_counts(ends: Ends) -> tuple[int, int]:
    """Return how many base pairs are held or restrained at the first and at the last end."""
    fixed = ("held", "restrained")
    first, last = (ends.pairs if end in fixed else 0 for end in (ends.first, ends.last))
    return first, last


def held_pairs(ends: Ends, pairs: int) -> list[int]:
    """Return the base pairs that do not move."""
    return _outermost(held_counts(ends), pairs)


def fixed_pairs(ends: Ends, pairs: int) -> list[int]:
    """Return the base pairs that are held or restrained: those at which a wave is reflected."""
    return _outermost(fixed_counts(ends), pairs)


def excited_pairs(excitation: Kick | Pulse | Periodic, ends: Ends) -> list[int]:
    """Return the base pairs that are excited: the chosen ones, or the free ones at the first end.

    Next to an end that is restrained they are those beside its springs.
    """
    first, _ = fixed_counts(ends)
    start = first if excitation.first_pair is None else excitation.first_pair - 1
    return list(range(start, start + excitation.pairs))


def span(ends: Ends, pairs: int) -> tuple[int, int]:
    """Return the first and last base pair that a wave reaches: the innermost fixed, or the ends."""
    first, last = fixed_counts(ends)
    return max(first - 1, 0), pairs - 1 - max(last - 1, 0)


def _outermost(counts: tuple[int, int], pairs: int) -> list[int]:
    first, last = counts
    return [*range(first), *range(pairs - last, pairs)]
