"""The bases of a structure: which atoms make them, and which letter they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from MDAnalysis.core.groups import AtomGroup, Residue
from MDAnalysis.exceptions import NoDataError
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.standard import standard_ring

_PYRIMIDINE = frozenset(standard_ring("T"))
_PURINE_ONLY = frozenset(standard_ring("A")) - _PYRIMIDINE
_RESIDUE_NAMES = {"ADE": "A", "CYT": "C", "GUA": "G", "THY": "T", "URA": "U"}
_FEWEST_OF_A_RING = 3


@dataclass(frozen=True, eq=False)
class Base:
    """One base: its letter, its label "chain:resid", its ring atoms and their indices."""

    letter: str
    label: str
    atoms: tuple[str, ...]
    indices: NDArray[np.int64]

    @property
    def purine(self) -> bool:
        """Whether the base is a purine."""
        return self.letter in "AG"


@dataclass(frozen=True, eq=False)
class Nucleotide:
    """A residue with a base: which chain it is in, its backbone atoms' indices where present."""

    base: Base
    chain: str
    resid: int
    five_prime_end: bool
    phosphorus: int | None
    o3: int | None


def find_nucleotides(atoms: AtomGroup) -> list[Nucleotide]:
    """Return the nucleotides among the residues, in order, with their bases.

    A nucleotide has two of three marks: a sugar (C1'), at least three pyrimidine ring atoms, a
    base's name (A, DA, DA5, RA3, ADE, ...). Old and new atom names are understood.
    Raises `InputError` where the topology has no names, or no residue is a nucleotide.
    """
    try:
        atoms.names, atoms.resnames, atoms.resids  # noqa: B018 - asks whether they are there
    except NoDataError as error:
        raise InputError(
            f"the topology does not tell atom and residue names: {error};"
            " use one that does, such as PDB, mmCIF, PSF, PRMTOP, TPR or GRO"
        ) from None
    # Water and protein are most of a solvated system: only residues with a ring atom are looked at.
    residues = atoms.select_atoms("name C2 C4 C6 C1' C1*").residues
    found = []
    for residue in residues:
        named = _named_atoms(residue)
        ring = len(_PYRIMIDINE & set(named)) >= _FEWEST_OF_A_RING
        if ("C1'" in named) + ring + (_letter_of_name(residue) is not None) >= 2:
            found.append(_nucleotide(residue, named))
    if not found:
        names = sorted({str(name) for name in atoms.residues.resnames})
        shown = ", ".join(names[:10]) + (", ..." if len(names) > 10 else "")
        raise InputError(
            f"no nucleic acid found among {len(atoms.residues)} residues ({shown}); needed are"
            " residues with a sugar (C1') and base ring atoms (N1, C2, N3, C4, C5, C6)"
        )
    return found


def _nucleotide(residue: Residue, named: dict[str, int]) -> Nucleotide:
    chain = str(getattr(residue.atoms[0], "chainID", "") or residue.segid)
    number = f"{residue.resid}{str(getattr(residue, 'icode', '')).strip()}"
    letter = _letter(set(named), _letter_of_name(residue))
    present = tuple(atom for atom in standard_ring(letter) if atom in named)
    indices = np.array([named[atom] for atom in present], dtype=np.int64)
    return Nucleotide(
        Base(letter, f"{chain}:{number}", present, indices),
        chain,
        int(residue.resid),
        "P" not in named and "O5'" in named,
        named.get("P"),
        named.get("O3'"),
    )


def _named_atoms(residue: Residue) -> dict[str, int]:
    """Return atom name in today's spelling -> index; the first of alternate locations."""
    named: dict[str, int] = {}
    for name, index in zip(residue.atoms.names, residue.atoms.indices, strict=True):
        modern = "C7" if name == "C5M" else name.replace("*", "'")
        named.setdefault(modern, int(index))
    return named


def _letter(names: set[str], of_residue: str | None) -> str:
    """Return the letter of the residue's name, unless the atoms that are there contradict it."""
    of_atoms = _letter_of_atoms(names)
    if of_residue is None:
        return of_atoms or _usual_letter(names)
    # A methyl group may be missing in a file: T and U are told by their names.
    if of_atoms is None or {of_atoms, of_residue} == {"T", "U"}:
        contradicted = of_residue not in "AG" and names & _PURINE_ONLY
        return _usual_letter(names) if contradicted else of_residue
    return of_atoms


def _letter_of_atoms(names: set[str]) -> str | None:
    """Return the letter by the group at C6 of a purine, at C4 and C5 of a pyrimidine."""
    if names & _PURINE_ONLY:
        return "A" if "N6" in names else "G" if names & {"O6", "S6"} else None
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


def _usual_letter(names: set[str]) -> str:
    """Return the letter of a base that tells none: frames differ by 0.2 Å and 2 degrees."""
    if names & _PURINE_ONLY:
        return "A"
    return "T" if "C7" in names else "U"
