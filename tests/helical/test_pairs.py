"""Which bases pair: found by sequence and strands, checked by geometry, or given."""

from __future__ import annotations

from collections.abc import Callable

import MDAnalysis
import pytest

from dnawaves.errors import InputError
from dnawaves.helical.pairs import find_pairs

SEQUENCE = "GATTACAC"
Maker = Callable[[str], MDAnalysis.Universe]


def test_pairs_of_a_plain_duplex(make_universe: Maker) -> None:
    pairs = find_pairs(make_universe(SEQUENCE))
    assert [pair.label for pair in pairs] == [f"A:{n}-B:{9 - n}" for n in range(1, 9)]
    assert [pair.sequence for pair in pairs][:3] == ["G-C", "A-T", "T-A"]
    assert {len(base.atoms) for pair in pairs for base in (pair.first, pair.second)} == {6, 9}


@pytest.mark.parametrize(
    "rename",
    [
        lambda name, first, last: f"{name}5" if first else f"{name}3" if last else name,
        lambda name, first, last: name[1],
        lambda name, first, last: {"A": "ADE", "C": "CYT", "G": "GUA", "T": "THY"}[name[1]],
        lambda name, first, last: "XYZ",  # told by the atoms alone
    ],
)
def test_residue_names_of_all_force_fields(
    make_universe: Maker, rename: Callable[[str, bool, bool], str]
) -> None:
    universe = make_universe(SEQUENCE)
    for residue in universe.residues:
        residue.resname = rename(residue.resname, residue.resid == 1, residue.resid == 8)
    assert "".join(pair.first.letter for pair in find_pairs(universe)) == SEQUENCE


def test_old_atom_names(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    for atom in universe.atoms:
        atom.name = {"C7": "C5M", "OP1": "O1P"}.get(atom.name, atom.name.replace("'", "*"))
    assert "".join(pair.first.letter for pair in find_pairs(universe)) == SEQUENCE


def test_strands_in_one_segment_are_split_at_the_5_end(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    for number, residue in enumerate(universe.residues, start=1):
        residue.resid = number
    universe.residues.segments = universe.segments[0]
    assert find_pairs(universe)[0].label == "A:1-A:16"


def test_an_overhang_does_not_pair(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    short = universe.select_atoms("not (segid B and resid 1 2)")
    pairs = find_pairs(short)
    assert [pair.label for pair in pairs] == [f"A:{n}-B:{9 - n}" for n in range(1, 7)]


def test_a_mismatch_is_kept(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    guanine = universe.select_atoms("segid A and resid 1").residues[0]
    guanine.atoms.select_atoms("name O6").names = "N6"  # now an A opposite C
    assert find_pairs(universe)[0].sequence == "A-C"
    assert len(find_pairs(universe)) == 8


def test_given_pairs_override_in_the_given_order(make_universe: Maker) -> None:
    pairs = find_pairs(make_universe(SEQUENCE), [("A:3", "B:6"), ("A:4", "B:5")])
    assert [pair.label for pair in pairs] == ["A:3-B:6", "A:4-B:5"]


def test_a_strand_in_another_periodic_image_is_refused(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    universe.select_atoms("segid B").translate([60, 0, 0])
    with pytest.raises(InputError, match="one periodic image"):
        find_pairs(universe)


def test_bases_that_do_not_face_each_other_are_refused(make_universe: Maker) -> None:
    with pytest.raises(InputError, match="pair A:1-B:1"):
        find_pairs(make_universe(SEQUENCE), [("A:1", "B:1"), ("A:2", "B:2")])


def test_one_strand_is_refused(make_universe: Maker) -> None:
    with pytest.raises(InputError, match="found here: A:1 to A:8;"):
        find_pairs(make_universe(SEQUENCE).select_atoms("segid A"))


def test_strands_that_do_not_match_are_refused(make_universe: Maker) -> None:
    universe = make_universe("AAAAAA")
    for atom in universe.select_atoms("segid B and name O4"):
        atom.name = "N4"
    with pytest.raises(InputError, match=r"AAAAAA and CCCCCC .* not complementary"):
        find_pairs(universe)


@pytest.mark.parametrize("label", ["A:99", "A1", "C:1"])
def test_a_base_that_is_not_there_is_named(make_universe: Maker, label: str) -> None:
    with pytest.raises(InputError, match=f"0 nucleotides are called '{label}'"):
        find_pairs(make_universe(SEQUENCE), [(label, "B:8")])


def test_no_pairs_given(make_universe: Maker) -> None:
    with pytest.raises(InputError, match="list is empty"):
        find_pairs(make_universe(SEQUENCE), [])


def test_a_base_nobody_can_name(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    guanine = universe.select_atoms("segid A and resid 1")
    guanine.residues[0].resname = "XYZ"
    guanine.select_atoms("name O6").names = "S6"
    with pytest.raises(InputError, match="XYZ A:1: its atoms do not tell"):
        find_pairs(universe)
