"""The bases of a structure: which atoms make them, and which letter they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from MDAnalysis.core.groups import AtomGroup, Residue
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.standard import standard_ring

_PYRIMIDINE = frozenset(standard_ring("T"))
_PURINE_ONLY = frozenset(standard_ring("A")) - _PYRIMIDINE
_RESIDUE_NAMES = {"ADE": "A", "CYT": "C", "GUA": "G", "THY": "T", "URA": "U"}


@dataclass(frozen=True, eq=False)
class Base:
    """One base: its letter, its label "chain:resid", its ring atoms and their indices."""

    letter: str
    label: str
    atoms: tuple[str, ...]
    indices: NDArray[np.int64]


def find_bases(atoms: AtomGroup) -> list[tuple[Residue, Base]]:
    """Return the nucleotides among the residues, in order, with their bases.

    A nucleotide has a sugar (C1') and either three pyrimidine ring atoms or a base's name
    (A, DA, DA5, RA3, ADE, ...). Atom names of old and new PDB files are understood.
    """
    found = []
    for residue in atoms.select_atoms("name C1' C1*").residues:
        named = _named_atoms(residue)
        if len(_PYRIMIDINE & set(named)) >= 3 or _letter_of_name(residue):
            found.append((residue, _base(residue, named)))
    return found


def sugar_index(residue: Residue) -> int:
    """Return the index of the nucleotide's C1' atom."""
    return _named_atoms(residue)["C1'"]


def chain_name(residue: Residue) -> str:
    """Return the chain's letter, or the segment's name where the file has no chains."""
    atom = residue.atoms[0]
    return str(getattr(atom, "chainID", "") or residue.segid)


def _base(residue: Residue, named: dict[str, int]) -> Base:
    label = f"{chain_name(residue)}:{residue.resid}"
    letter = _letter_of_atoms(set(named)) or _letter_of_name(residue)
    if letter is None:
        raise InputError(
            f"{residue.resname} {label}: its atoms do not tell which base it is"
            " (N6, O6, N4 or O4), and its name is none of A, C, G, T, U"
        )
    present = tuple(atom for atom in standard_ring(letter) if atom in named)
    indices = np.array([named[atom] for atom in present], dtype=np.int64)
    return Base(letter, label, present, indices)


def _named_atoms(residue: Residue) -> dict[str, int]:
    """Return atom name in today's spelling -> index; the first of alternate locations."""
    named: dict[str, int] = {}
    for atom in residue.atoms:
        name = "C7" if atom.name == "C5M" else atom.name.replace("*", "'")
        named.setdefault(name, int(atom.ix))
    return named


def _letter_of_atoms(names: set[str]) -> str | None:
    """Return the letter by the group at C6 of a purine, at C4 and C5 of a pyrimidine."""
    if names & _PURINE_ONLY:
        return "A" if "N6" in names else "G" if "O6" in names else None
    if "N4" in names:
        return "C"
    if "O4" in names:
        return "T" if "C7" in names else "U"
    return None


def _letter_of_name(residue: Residue) -> str | None:
    name = residue.resname.upper()
    if name in _RESIDUE_NAMES:
        return _RESIDUE_NAMES[name]
    core = name.rstrip("35N").removeprefix("D").removeprefix("R")
    return core if core in _RESIDUE_NAMES.values() else None
