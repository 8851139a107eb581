"""Sequences: which are allowed, and their complements."""

from __future__ import annotations

import pytest

from dnawaves.errors import InputError
from dnawaves.scene.sequence import check_sequence, complement, reverse_complement


def test_complement_is_watson_and_crick() -> None:
    assert complement("AACGT") == "TTGCA"


def test_reverse_complement_is_read_5_to_3() -> None:
    assert reverse_complement("AACGT") == "ACGTT"
    assert reverse_complement("CGCGAATTCGCG") == "CGCGAATTCGCG"  # the palindrome of Dickerson


@pytest.mark.parametrize("sequence", ["ACGT", "AAAA", "CGCGAATTCGCG"])
def test_allowed(sequence: str) -> None:
    check_sequence(sequence)


@pytest.mark.parametrize(
    ("sequence", "said"),
    [
        ("ACGU", "'U' at position 4"),
        ("acgt", "'a' at position 1"),
        ("AC GT", "' ' at position 3"),
        ("ACNGT", "A, C, G and T"),
        ("ACG", "3 base pairs in 'ACG'; allowed: 4 or more"),
        ("", "0 base pairs"),
    ],
)
def test_refusal_says_where_and_what_is_allowed(sequence: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        check_sequence(sequence)
