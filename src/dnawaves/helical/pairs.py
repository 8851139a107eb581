"""The base pairs of one antiparallel duplex: by sequence and strands, checked by geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from MDAnalysis import Universe
from MDAnalysis.core.groups import AtomGroup, Residue

from dnawaves.errors import InputError
from dnawaves.helical.bases import Base, chain_name, find_bases, sugar_index

_COMPLEMENTARY = {("A", "T"), ("T", "A"), ("A", "U"), ("U", "A"), ("C", "G"), ("G", "C")}

# C1'-C1' is 10.4 to 10.8 Å in Watson-Crick pairs; a flipped-out base reaches 20 Å.
_USUAL_DISTANCE_A = (8.0, 14.0)
_ABSURD_DISTANCE_A = 30.0

Nucleotide = tuple[Residue, Base]


@dataclass(frozen=True, eq=False)
class BasePair:
    """Two paired bases, of strand I and strand II."""

    first: Base
    second: Base

    @property
    def label(self) -> str:
        """The pair as "A:1-B:24"."""
        return f"{self.first.label}-{self.second.label}"

    @property
    def sequence(self) -> str:
        """The pair's letters as "C-G"."""
        return f"{self.first.letter}-{self.second.letter}"


def find_pairs(
    atoms: AtomGroup | Universe, pairs: Sequence[tuple[str, str]] | None = None
) -> tuple[BasePair, ...]:
    """Return the base pairs in the order of strand I, 5' to 3'.

    Found from the two strands, aligned antiparallel without gaps where most bases are
    complementary; every pair of the overlap counts, also a mismatched or open one. Or given:
    `pairs` lists ("A:1", "B:24"), ..., as chain (or segment) and residue number.
    Raises `InputError` if there are not two strands, if they are not complementary, if a named
    base is not there, or if C1'-C1' distances say that the bases do not pair (a strand in
    another periodic image).
    """
    group = atoms.atoms
    nucleotides = find_bases(group)
    if pairs is None:
        strand_I, strand_II = _two_strands(nucleotides)
        chosen = _align(strand_I, strand_II)
    else:
        chosen = _named_pairs(nucleotides, pairs)
    _check_distances(group, chosen)
    return tuple(BasePair(first[1], second[1]) for first, second in chosen)


def _two_strands(nucleotides: list[Nucleotide]) -> list[list[Nucleotide]]:
    strands = _split(nucleotides, by_ends=False)
    if len(strands) == 1:
        strands = _split(nucleotides, by_ends=True)
    if len(strands) != 2:
        found = ", ".join(f"{s[0][1].label} to {s[-1][1].label}" for s in strands) or "none"
        raise InputError(
            f"a duplex has two strands, but found here: {found};"
            " select one duplex, or give the list of base pairs"
        )
    return strands


def _split(nucleotides: list[Nucleotide], by_ends: bool) -> list[list[Nucleotide]]:
    """Split where the chain changes or the numbers fall; `by_ends`, at 5' ends as well."""
    strands: list[list[Nucleotide]] = []
    before: Residue | None = None
    for residue, base in nucleotides:
        if (
            before is None
            or residue.segindex != before.segindex
            or chain_name(residue) != chain_name(before)
            or residue.resid < before.resid
            or (by_ends and "P" not in residue.atoms.names)
        ):
            strands.append([])
        strands[-1].append((residue, base))
        before = residue
    return strands


def _align(
    strand_I: list[Nucleotide], strand_II: list[Nucleotide]
) -> list[tuple[Nucleotide, Nucleotide]]:
    """Return the antiparallel overlap that has the most complementary pairs."""
    best: list[tuple[Nucleotide, Nucleotide]] = []
    best_matches = 0
    for sum_of_indices in range(len(strand_I) + len(strand_II) - 1):
        overlap = [
            (strand_I[i], strand_II[sum_of_indices - i])
            for i in range(len(strand_I))
            if 0 <= sum_of_indices - i < len(strand_II)
        ]
        matches = sum((a[1].letter, b[1].letter) in _COMPLEMENTARY for a, b in overlap)
        if matches > best_matches:
            best, best_matches = overlap, matches
    if 2 * best_matches <= min(len(strand_I), len(strand_II)):
        raise InputError(
            f"the strands {_spell(strand_I)} and {_spell(strand_II)} (both 5' to 3') are not"
            " complementary; give the list of base pairs"
        )
    return best


def _spell(strand: list[Nucleotide]) -> str:
    return "".join(base.letter for _, base in strand)


def _named_pairs(
    nucleotides: list[Nucleotide], pairs: Sequence[tuple[str, str]]
) -> list[tuple[Nucleotide, Nucleotide]]:
    def named(label: str) -> Nucleotide:
        found = [nucleotide for nucleotide in nucleotides if nucleotide[1].label == label]
        if len(found) != 1:
            raise InputError(
                f"base pairs: {len(found)} nucleotides are called {label!r};"
                ' one is needed, as chain and residue number such as "A:1"'
            )
        return found[0]

    return [(named(first), named(second)) for first, second in pairs]


def _check_distances(group: AtomGroup, chosen: list[tuple[Nucleotide, Nucleotide]]) -> None:
    if not chosen:
        raise InputError("base pairs: the list is empty")
    places = group.universe.atoms.positions
    distances_A = np.array(
        [
            np.linalg.norm(places[sugar_index(first[0])] - places[sugar_index(second[0])])
            for first, second in chosen
        ]
    )
    worst = int(np.argmax(distances_A))
    median_A = float(np.median(distances_A))
    low, high = _USUAL_DISTANCE_A
    if distances_A[worst] > _ABSURD_DISTANCE_A or not low < median_A < high:
        first, second = chosen[worst]
        raise InputError(
            f"the strands do not lie side by side: C1'-C1' is {distances_A[worst]:.1f} Å in pair"
            f" {first[1].label}-{second[1].label}, {median_A:.1f} Å in the median (10.5 Å in"
            " Watson-Crick pairs); make the molecules whole in one periodic image, or correct"
            " the list of base pairs"
        )
