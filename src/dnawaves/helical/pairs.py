"""The base pairs of a structure: by sequence and strands, checked by geometry; or as listed."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise, product

import numpy as np
from MDAnalysis import Universe
from MDAnalysis.core.groups import AtomGroup

from dnawaves.errors import InputError
from dnawaves.helical.bases import Nucleotide, find_nucleotides
from dnawaves.helical.duplexes import (
    FEWEST_PAIRS,
    SUGARS_A,
    Pairing,
    complementary,
    find_duplexes,
)
from dnawaves.helical.form import BasePair, decide_forms
from dnawaves.helical.geometry import Bases
from dnawaves.helical.pair_list import (
    named_pairs,
    refuse_shuffled,
    split_list,
    uniquely_labelled,
)
from dnawaves.helical.strands import find_strands, spell

# A flipped-out base reaches 20 Å: C1'-C1' beyond this is a strand in another periodic image.
ABSURD_A = 30.0


def find_pairs(
    atoms: AtomGroup | Universe, pairs: Sequence[tuple[str, str]] | None = None
) -> tuple[BasePair, ...]:
    """Return the base pairs of all duplexes, as they are in the universe's present frame of time.

    Each duplex goes along its strand I (the one that comes first) 5' to 3'. Found from sequence,
    strands and geometry, see `find_duplexes`; or given: `pairs` lists ("A:1", "B:24"), ..., as
    chain (or segment) and residue number.
    Raises `InputError` without nucleotides, without a duplex among them, for a list that names
    bases which are not there or goes from 3' to 5', and for bases that do not lie side by side.
    """
    group = atoms.atoms
    nucleotides = find_nucleotides(group)
    positions_A = group.universe.atoms.positions
    box = group.universe.dimensions
    if box is not None and not np.all(box[:3] > 0):
        box = None
    strands, joined = find_strands(nucleotides, positions_A, box)
    bases = Bases(uniquely_labelled([n.base for n in nucleotides]), positions_A, box)
    if pairs is None:
        duplexes = find_duplexes(bases, strands)
        if not duplexes:
            raise InputError(_why_none(bases, nucleotides, strands))
        _refuse_torn(bases, nucleotides, duplexes)
    else:
        strand_of = [number for number, strand in enumerate(strands) for _ in strand]
        duplexes = split_list(named_pairs(bases.bases, pairs), strand_of)
        refuse_shuffled(bases.bases, duplexes, strand_of)
    for duplex in duplexes:
        _refuse_apart(bases, duplex)
    return decide_forms(bases, duplexes, joined)


def _refuse_torn(
    bases: Bases, nucleotides: Sequence[Nucleotide], duplexes: Sequence[Pairing]
) -> None:
    """Refuse a duplex whose strands go on, complementary, but in another periodic image.

    There the chain jumps, which tells it from strands that have melted.
    """
    paired = {number for duplex in duplexes for both in duplex for number in both}
    for duplex, way in product(duplexes, (-1, 1)):
        end = duplex[0 if way < 0 else -1]
        rest = _rest_beyond(
            end, (way, way if duplex[-1][1] > duplex[0][1] else -way), nucleotides, paired
        )
        if not rest:
            continue
        distances_A = _sugar_distances_A(bases, rest)
        jumps_A = [
            _sugar_distances_A(bases, [(here[strand], there[strand])])[0]
            for here, there in pairwise([end, *rest])
            for strand in (0, 1)
        ]
        # NaN, of a base without a frame, is not above anything.
        if max(np.nan_to_num(jumps_A)) > ABSURD_A and (distances_A > ABSURD_A).mean() > 0.5:
            first, last = (
                "-".join(bases.bases[number].label for number in rest[place]) for place in (0, -1)
            )
            raise InputError(
                f"the strands are complementary from {first} to {last} as well, but do not lie"
                f" side by side there: C1'-C1' is up to {np.nanmax(distances_A):.1f} Å, and the"
                f" chain jumps by {np.nanmax(jumps_A):.1f} Å from one nucleotide to the next; make"
                " the molecules whole in one periodic image (or give the file its box), or give"
                " the list of base pairs"
            )


def _rest_beyond(
    end: tuple[int, int],
    ways: tuple[int, int],
    nucleotides: Sequence[Nucleotide],
    paired: set[int],
) -> Pairing:
    """Return what is complementary and free beyond the end of a duplex, wherever it lies."""
    rest: Pairing = []
    one, other = end
    while True:
        here, there = one + ways[0], other + ways[1]
        if (
            here == there
            or not paired.isdisjoint((here, there))
            or not _follows(nucleotides, one, here)
            or not _follows(nucleotides, other, there)
            or not complementary(nucleotides[here].base.letter, nucleotides[there].base.letter)
        ):
            return rest
        one, other = here, there
        rest.append((one, other))


def _follows(nucleotides: Sequence[Nucleotide], here: int, there: int) -> bool:
    """Return whether two that are next to each other in the file are so in a chain."""
    early, late = min(here, there), max(here, there)
    if early < 0 or late >= len(nucleotides):
        return False
    one, other = nucleotides[early], nucleotides[late]
    return one.chain == other.chain and 0 <= other.resid - one.resid <= 1


def _refuse_apart(bases: Bases, duplex: Pairing) -> None:
    distances_A = _sugar_distances_A(bases, duplex)
    known = distances_A[np.isfinite(distances_A)]
    if not len(known):
        return
    worst = int(np.nanargmax(distances_A))
    median_A = float(np.median(known))
    low, high = SUGARS_A
    if distances_A[worst] > ABSURD_A or not low < median_A < high:
        one, other = duplex[worst]
        raise InputError(
            f"the strands do not lie side by side: C1'-C1' is {distances_A[worst]:.1f} Å in pair"
            f" {bases.bases[one].label}-{bases.bases[other].label}, {median_A:.1f} Å in the median;"
            f" allowed are {low:g} to {high:g} Å in the median and {ABSURD_A:g} Å in any pair;"
            " make the molecules whole in one periodic image (or give the file its box), or"
            " correct the list of base pairs"
        )


def _sugar_distances_A(bases: Bases, duplex: Pairing) -> np.ndarray:
    first, second = (list(column) for column in zip(*duplex, strict=True))
    sugars = bases.sugars()
    return np.linalg.norm(bases.between(sugars[first], sugars[second]), axis=1)


def _why_none(
    bases: Bases, nucleotides: Sequence[Nucleotide], strands: Sequence[Sequence[int]]
) -> str:
    """Return what is missing where no duplex was found."""
    found = ", ".join(
        f"{bases.bases[strand[0]].label} to {bases.bases[strand[-1]].label}" for strand in strands
    )
    remedy = "select the duplex, or give the list of base pairs"
    if len(strands) == 1:
        return (
            f"a duplex has two strands, but one strand is here ({found}) and it does not pair"
            f" with itself; {remedy}"
        )
    for one, other in combinations(strands, 2):
        register = _complement(bases, one, other)
        if register:
            both = f"the strands {spell(nucleotides, one)} and {spell(nucleotides, other)} are"
            distances_A = _sugar_distances_A(bases, register)
            known = distances_A[np.isfinite(distances_A)]
            if not len(known):
                return (
                    f"{both} complementary, but no pair of their bases has frames: fewer than three"
                    " ring atoms, or coordinates that are no numbers"
                )
            median_A = float(np.median(known))
            if SUGARS_A[0] < median_A < SUGARS_A[1]:
                return (
                    f"{both} complementary and side by side, but fewer than {FEWEST_PAIRS} of"
                    " their bases face each other as those of a pair do; give the list of base"
                    " pairs"
                )
            return (
                f"{both} complementary, but do not lie side by side: C1'-C1' is {median_A:.1f} Å in"
                f" the median, allowed are {SUGARS_A[0]:g} to {SUGARS_A[1]:g} Å; make the molecules"
                " whole in one periodic image (or give the file its box), or give the list of"
                " base pairs"
            )
    return f"no two of the strands ({found}) are complementary; {remedy}"


def _complement(bases: Bases, one: Sequence[int], other: Sequence[int]) -> Pairing:
    """Return the antiparallel overlap of two strands with the most complementary pairs.

    Empty where these are not more than half of the shorter strand.
    """
    letters = [base.letter for base in bases.bases]
    best: Pairing = []
    most = min(len(one), len(other)) / 2
    for offset in range(len(one) + len(other) - 1):
        places = range(max(0, offset - len(other) + 1), min(len(one), offset + 1))
        overlap = [(one[place], other[offset - place]) for place in places]
        matches = sum(complementary(letters[a], letters[b]) for a, b in overlap)
        if matches > most:
            best, most = overlap, matches
    return best
