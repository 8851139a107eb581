"""A duplex that a user gives as a structure file: its two strands, checked before anything runs."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import dist, isfinite
from pathlib import Path
from typing import Any, NoReturn

from dnawaves.errors import InputError
from dnawaves.files import digest
from dnawaves.scene.sequence import check_sequence, reverse_complement

Place = tuple[float, float, float]

SUFFIXES = (".pdb", ".ent", ".cif", ".mmcif")
# Longest O3'-P that is a bond (1.6 Å): the limit of 3DNA, Lu & Olson (2008) Nat. Protoc. 3, 1213.
LONGEST_BOND_A = 2.5
# Widest pair, between its C1' atoms: twice the 10.5 Å of Watson-Crick pairs (Saenger, Principles of
# Nucleic Acid Structure, 1984, ch. 6). Beyond, the two strands are not one duplex.
WIDEST_PAIR_A = 21.0
# Names of the Protein Data Bank's chemical components, version 3.
_PHOSPHATE = ("P", "OP1", "OP2")
_SUGAR = ("O5'", "C5'", "C4'", "O4'", "C3'", "O3'", "C2'", "C1'")
_BASE = {
    "A": ("N9", "C8", "N7", "C5", "C6", "N6", "N1", "C2", "N3", "C4"),
    "C": ("N1", "C2", "O2", "N3", "C4", "N4", "C5", "C6"),
    "G": ("N9", "C8", "N7", "C5", "C6", "O6", "N1", "C2", "N2", "N3", "C4"),
    "T": ("N1", "C2", "O2", "N3", "C4", "O4", "C5", "C7", "C6"),
}
_SUGAR_HYDROGENS = ("H1'", "H2'", "H2''", "H3'", "H4'", "H5'", "H5''")
_BASE_HYDROGENS = {
    "A": ("H2", "H61", "H62", "H8"),
    "C": ("H41", "H42", "H5", "H6"),
    "G": ("H1", "H21", "H22", "H8"),
    "T": ("H3", "H6", "H71", "H72", "H73"),
}
_OLD_NAMES = {
    "O1P": "OP1",
    "O2P": "OP2",
    "O3P": "OP3",
    "C5M": "C7",
    "H5T": "HO5'",
    "H3T": "HO3'",
    "H2'1": "H2'",
    "H2'2": "H2''",
    "H5'1": "H5'",
    "H5'2": "H5''",
}


@dataclass(frozen=True)
class FileNucleotide:
    """One nucleotide of a file: its letter, its label there, its atoms' places in Å by name."""

    letter: str
    label: str
    places_A: dict[str, Place]


def sequence_of_file(path: Path) -> str:
    """Return strand I, 5' to 3', of the duplex in a PDB or mmCIF file: its first chain.

    Raises `InputError` as `read_strands` does.
    """
    return "".join(nucleotide.letter for nucleotide in read_strands(path)[0])


def digest_of_file(path: Path) -> str:
    """Return the SHA-256 of a file's content; raises `InputError` where it cannot be read."""
    try:
        return digest(path.read_bytes())
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None


def read_strands(path: Path) -> tuple[list[FileNucleotide], list[FileNucleotide]]:
    """Return the nucleotides of strand I and strand II, each 5' to 3', of a PDB or mmCIF file.

    The first model and the first of alternate locations are taken, water is left out, and so are
    the phosphates of both 5' ends, which a built duplex lacks too. Atoms have today's names.

    Raises
    ------
    InputError
        Names the file and the residue: not two chains of DNA, a residue that is not one of the
        standard four, heavy atoms that are missing, atoms that do not belong there, a broken
        backbone, strands that are not complementary or lie apart, places that are no numbers or
        that two atoms share.
    """
    chains = [
        [_nucleotide(path, chain.name, residue, first=index == 0) for index, residue in residues]
        for chain in _chains(path)
        if (residues := list(enumerate(chain)))
    ]
    if len(chains) != 2:
        _refuse(path, "chains", f"{len(chains)} of nucleotides", "2, the strands of one duplex")
    one, other = chains
    for strand in chains:
        _check_backbone(path, strand)
    first, second = ("".join(each.letter for each in strand) for strand in chains)
    try:
        check_sequence(first)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    if second != reverse_complement(first):
        _refuse(
            path,
            f"strand from {other[0].label}",
            second,
            f"{reverse_complement(first)}, the Watson-Crick complement of {first}",
        )
    _check_pairs(path, one, other)
    return one, other


def _chains(path: Path) -> Any:
    """Return the chains of the first model, cut where a PDB file has TER."""
    import gemmi

    if path.suffix.lower() not in SUFFIXES:
        _refuse(path, "file", repr(path.suffix), ", ".join(SUFFIXES))
    try:
        if path.suffix.lower() in (".pdb", ".ent"):
            structure = gemmi.read_pdb(str(path), split_chain_on_ter=True)
        else:
            structure = gemmi.read_structure(str(path))
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a structure: {error}") from None
    if len(structure) == 0:
        _refuse(path, "file", "no atoms", "a duplex of DNA")
    structure.remove_alternative_conformations()
    structure.remove_waters()
    return structure[0]


def _nucleotide(path: Path, chain: str, residue: Any, *, first: bool) -> FileNucleotide:
    label = f"{chain or '?'}:{residue.seqid}"
    where = f"residue {label}"
    # DA; DA5 and DA3 at the ends (Amber's); A, the name until 2007: RNA's O2' is refused below.
    letter = residue.name.upper().rstrip("35").removeprefix("D")
    if letter not in _BASE:
        _refuse(path, where, residue.name, "DA, DC, DG or DT; remove what is not the duplex")
    places = {}
    for atom in residue:
        name = atom.name.replace("*", "'")
        places[_OLD_NAMES.get(name, name)] = (atom.pos.x, atom.pos.y, atom.pos.z)
    if first:
        for name in (*_PHOSPHATE, "OP3", "HOP2", "HOP3"):
            places.pop(name, None)
    needed = (*(() if first else _PHOSPHATE), *_SUGAR, *_BASE[letter])
    known = {*needed, *_SUGAR_HYDROGENS, *_BASE_HYDROGENS[letter], "HO5'", "HO3'"}
    missing = [name for name in needed if name not in places]
    strange = [name for name in places if name not in known]
    if missing:
        _refuse(path, where, f"no {', '.join(missing)}", "every heavy atom must be there")
    if strange:
        _refuse(
            path, where, ", ".join(strange), f"the atoms of D{letter}; hydrogens may be left out"
        )
    if not all(isfinite(x) for place in places.values() for x in place):
        _refuse(path, where, "coordinates that are no numbers", "finite ones")
    if len(set(places.values())) < len(places):
        _refuse(path, where, "several atoms in one place", "atoms that lie apart")
    return FileNucleotide(letter, label, places)


def _check_backbone(path: Path, strand: list[FileNucleotide]) -> None:
    for here, there in pairwise(strand):
        length_A = dist(here.places_A["O3'"], there.places_A["P"])
        if length_A > LONGEST_BOND_A:
            _refuse(
                path,
                f"residues {here.label} and {there.label}",
                f"O3' and P {length_A:.1f} Å apart",
                f"up to {LONGEST_BOND_A} Å: a strand without breaks, 5' to 3'",
            )


def _check_pairs(path: Path, one: list[FileNucleotide], other: list[FileNucleotide]) -> None:
    for here, there in zip(one, reversed(other), strict=True):
        width_A = dist(here.places_A["C1'"], there.places_A["C1'"])
        if width_A > WIDEST_PAIR_A:
            _refuse(
                path,
                f"residues {here.label} and {there.label}",
                f"C1' and C1' {width_A:.1f} Å apart",
                f"up to {WIDEST_PAIR_A:g} Å: partners in a base pair",
            )


def _refuse(path: Path, where: str, found: str, allowed: str) -> NoReturn:
    raise InputError(f"{path}: {where}: found {found}; allowed: {allowed}")
