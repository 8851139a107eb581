"""What a DNA sequence may be, and its complementary strand."""

from __future__ import annotations

from dnawaves.errors import InputError

SHORTEST_DUPLEX = 4
_COMPLEMENT = {"A": "T", "C": "G", "G": "C", "T": "A"}


def check_sequence(sequence: str) -> None:
    """Raise `InputError` unless the sequence has at least 4 letters, each of A, C, G, T."""
    for position, letter in enumerate(sequence, start=1):
        if letter not in _COMPLEMENT:
            raise InputError(
                f"sequence: found {letter!r} at position {position} of {sequence!r}; "
                "allowed: the capital letters A, C, G and T"
            )
    if len(sequence) < SHORTEST_DUPLEX:
        raise InputError(
            f"sequence: found {len(sequence)} base pairs in {sequence!r}; "
            f"allowed: {SHORTEST_DUPLEX} or more"
        )


def complement(sequence: str) -> str:
    """Return the Watson-Crick partner of each base, in the order given."""
    return "".join(_COMPLEMENT[base] for base in sequence)


def reverse_complement(sequence: str) -> str:
    """Return the partner strand read 5' to 3'."""
    return complement(sequence)[::-1]
