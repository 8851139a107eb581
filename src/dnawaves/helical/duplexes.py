"""Duplexes from sequence and geometry: which stretches of which strands pair."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from MDAnalysis.lib.distances import capped_distance

from dnawaves.helical.geometry import ORIGINS_A, Bases

Pairing = list[tuple[int, int]]

_COMPLEMENTARY = {("A", "T"), ("T", "A"), ("A", "U"), ("U", "A"), ("C", "G"), ("G", "C")}

# C1'-C1' is 10.4 to 10.8 Å in Watson-Crick pairs, 13 Å between two purines.
SUGARS_A = (8.0, 14.0)
# One pair alone tells neither a register nor a direction.
FEWEST_PAIRS = 2


class _Register(NamedTuple):
    """Strand I, strand II, whether they run alike, and the sum or difference of their places."""

    first: int
    second: int
    parallel: bool
    offset: int

    def partner(self, place: int) -> int:
        return place - self.offset if self.parallel else self.offset - place


def complementary(one: str, other: str) -> bool:
    """Whether two letters make a Watson-Crick pair."""
    return (one, other) in _COMPLEMENTARY


def find_duplexes(bases: Bases, strands: Sequence[Sequence[int]]) -> list[Pairing]:
    """Return the duplexes, each as pairs of base numbers in the order of the strand that is first.

    In each register (two strands and how they are laid side by side, antiparallel or parallel,
    without gaps) the complementary bases that face each other are counted. Registers are taken
    from the largest count down: all between its first and its last such pair belongs to the
    duplex, mismatched and open pairs too, and beyond them what is complementary and no further
    apart than 3DNA lets the bases of a pair be. A base is in one pair at most.
    """
    place_of = {base: (s, p) for s, strand in enumerate(strands) for p, base in enumerate(strand)}
    facing = _facing(bases)
    registers: dict[_Register, Pairing] = defaultdict(list)
    for one, other in facing:
        (s, p), (t, q) = place_of[one], place_of[other]
        registers[_Register(s, t, False, p + q)].append((one, other))
        registers[_Register(s, t, True, p - q)].append((one, other))
    used: set[int] = set()
    duplexes: list[Pairing] = []
    while True:
        for register, pairs in list(registers.items()):
            left = [pair for pair in pairs if used.isdisjoint(pair)]
            registers[register] = left
        best = max(registers, key=lambda r: (len(registers[r]), not r.parallel), default=None)
        if best is None or len(registers[best]) < FEWEST_PAIRS:
            return sorted(duplexes)
        seen = registers.pop(best)
        elsewhere = {
            base
            for pairs in registers.values()
            if len(pairs) >= FEWEST_PAIRS
            for pair in pairs
            for base in pair
        } - {base for pair in seen for base in pair}
        duplex = list(_fill(best, seen, bases, strands, used | elsewhere))
        used |= {base for pair in duplex for base in pair}
        duplexes.append(duplex)


def _facing(bases: Bases) -> Pairing:
    """Return the complementary bases that lie as a pair does, the earlier base first."""
    sugars = bases.sugars()
    known = np.flatnonzero(np.isfinite(sugars).all(axis=1))
    if not len(known):
        return []
    near = capped_distance(
        sugars[known].astype(np.float32),
        sugars[known].astype(np.float32),
        max_cutoff=SUGARS_A[1],
        min_cutoff=SUGARS_A[0],
        box=bases.box,
        return_distances=False,
    )
    letters = [base.letter for base in bases.bases]
    candidates = sorted(
        (one, other)
        for one, other in known[near].tolist()
        if one < other and complementary(letters[one], letters[other])
    )
    if not candidates:
        return []
    ones, others = zip(*candidates, strict=True)
    return [pair for pair, face in zip(candidates, bases.face(ones, others), strict=True) if face]


def _fill(
    register: _Register,
    seen: Pairing,
    bases: Bases,
    strands: Sequence[Sequence[int]],
    taken: set[int],
) -> Iterator[tuple[int, int]]:
    """Yield the pairs of a register between its outermost seen ones, and those beyond that fit."""
    strand_I, strand_II = strands[register.first], strands[register.second]
    places = [p for p, base in enumerate(strand_I) if any(base == one for one, _ in seen)]
    begin, end = places[0], places[-1]

    def pair(place: int) -> tuple[int, int] | None:
        partner = register.partner(place)
        if not (0 <= place < len(strand_I) and 0 <= partner < len(strand_II)):
            return None
        both = strand_I[place], strand_II[partner]
        return both if both[0] != both[1] and taken.isdisjoint(both) else None

    def fits(place: int) -> bool:
        both = pair(place)
        # In the loop of a hairpin neighbours may be complementary.
        if both is None or register.first == register.second:
            return False
        origins = bases.frames.origin.T
        (apart,) = bases.between(origins[[both[0]]], origins[[both[1]]])
        letters = (bases.bases[number].letter for number in both)
        return complementary(*letters) and bool(np.linalg.norm(apart) <= ORIGINS_A)

    while fits(begin - 1):
        begin -= 1
    while fits(end + 1):
        end += 1
    for place in range(begin, end + 1):
        both = pair(place)
        if both is not None:
            yield both
