"""Which base pairs of a scene are held and which are excited, as indices from 0."""

from __future__ import annotations

from dnawaves.scene.excitations import Kick, Periodic, Pulse
from dnawaves.scene.models import Ends


def held_counts(ends: Ends) -> tuple[int, int]:
    """Return how many base pairs do not move at the first and at the last end."""
    first, last = (ends.pairs if end == "held" else 0 for end in (ends.first, ends.last))
    return first, last


def held_pairs(ends: Ends, pairs: int) -> list[int]:
    """Return the base pairs that do not move."""
    first, last = held_counts(ends)
    return [*range(first), *range(pairs - last, pairs)]


def excited_pairs(excitation: Kick | Pulse | Periodic, ends: Ends) -> list[int]:
    """Return the free base pairs next to the first end that are excited."""
    start = ends.pairs if ends.first == "held" else 0
    return list(range(start, start + excitation.pairs))


def span(ends: Ends, pairs: int) -> tuple[int, int]:
    """Return the first and last base pair that a wave reaches: the innermost held, or the ends."""
    first = ends.pairs - 1 if ends.first == "held" else 0
    outer = ends.pairs - 1 if ends.last == "held" else 0
    return first, pairs - 1 - outer
