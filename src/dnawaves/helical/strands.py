"""The strands of a structure, and which of its nucleotides are joined by a backbone."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from MDAnalysis.lib.distances import calc_bonds
from numpy.typing import NDArray

from dnawaves.helical.bases import Nucleotide

# Longest O3'-P that is a bond (1.6 Å): the limit of 3DNA, Lu & Olson (2008) Nat. Protoc. 3, 1213.
_BOND_A = 2.5
# O3'-P to the next nucleotide but one is some 7 Å: beyond this the next is of another strand.
_APART_A = 8.0


def find_strands(
    nucleotides: Sequence[Nucleotide],
    positions_A: NDArray[np.floating],
    box: NDArray[np.floating] | None,
) -> tuple[list[list[int]], NDArray[np.bool_]]:
    """Return the strands (numbers of nucleotides, 5' to 3') and which are joined to the next.

    A strand ends where the chain changes, where residue numbers fall, where the next nucleotide
    is a 5' end (O5' but no P, in a chain that has P), and where its P is far away though the
    numbers run on. Joined are O3' and P at bond length; where a file has not both of them,
    successive residue numbers.
    """
    with_phosphorus = {
        nucleotide.chain for nucleotide in nucleotides if nucleotide.phosphorus is not None
    }
    strands: list[list[int]] = [[0]] if nucleotides else []
    joined = np.zeros(len(nucleotides), dtype=bool)
    lengths_A = _backbone_bonds_A(nucleotides, positions_A, box)
    for number, (here, there) in enumerate(pairwise(nucleotides)):
        gap = there.resid - here.resid
        starts = there.five_prime_end and there.chain in with_phosphorus
        ends = here.chain != there.chain or gap < 0 or starts
        if ends or (gap <= 1 and lengths_A[number] > _APART_A):
            strands.append([])
        elif np.isnan(lengths_A[number]):
            joined[number] = gap <= 1
        else:
            joined[number] = lengths_A[number] <= _BOND_A
        strands[-1].append(number + 1)
    return strands, joined


def _backbone_bonds_A(
    nucleotides: Sequence[Nucleotide],
    positions_A: NDArray[np.floating],
    box: NDArray[np.floating] | None,
) -> NDArray[np.float64]:
    """Return O3' to the next P, NaN where one is missing."""
    lengths_A = np.full(len(nucleotides), np.nan)
    known = [
        (number, here.o3, there.phosphorus)
        for number, (here, there) in enumerate(pairwise(nucleotides))
        if here.o3 is not None and there.phosphorus is not None
    ]
    if known:
        numbers, ends, starts = (list(column) for column in zip(*known, strict=True))
        lengths_A[numbers] = calc_bonds(positions_A[ends], positions_A[starts], box=box)
    return lengths_A


def spell(nucleotides: Sequence[Nucleotide], strand: Sequence[int]) -> str:
    """Return a strand's letters, 5' to 3'."""
    return "".join(nucleotides[number].base.letter for number in strand)
