"""Which bases pair: found by sequence and strands, checked by geometry, or given."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.bases import find_nucleotides
from dnawaves.helical.flags import NOT_CONSECUTIVE, PARALLEL
from dnawaves.helical.pair_list import read_pairs
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
    adenine = universe.select_atoms("segid A and resid 5").residues[0]
    adenine.atoms.select_atoms("name N6").names = "O6"  # now a G opposite T
    assert find_pairs(universe)[4].sequence == "G-T"
    assert len(find_pairs(universe)) == 8


def test_a_mismatch_at_an_end_is_no_pair(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    universe.select_atoms("segid A and resid 1 and name O6").names = "N6"  # now an A opposite C
    assert [pair.label for pair in find_pairs(universe)] == [
        f"A:{n}-B:{9 - n}" for n in range(2, 9)
    ]
    listed = find_pairs(universe, [("A:1", "B:8"), ("A:2", "B:7")])
    assert listed[0].sequence == "A-C"


def test_ends_that_have_melted_are_left_out(make_universe: Maker) -> None:
    universe = make_universe("CCGATCAAGG")
    # A strand is cut at a bond of over 8 Å: here residue numbers alone join it.
    universe.select_atoms("name P O5'").names = "X"
    for number in (1, 2):
        universe.select_atoms(f"segid B and resid {number}").translate([22 * (3 - number), 0, 0])
    assert [pair.label for pair in find_pairs(universe)] == [
        f"A:{n}-B:{11 - n}" for n in range(1, 9)
    ]


@pytest.mark.parametrize("part", ["segid B and resid 1:5", "segid A and resid 1:4"])
def test_half_a_strand_in_another_periodic_image_is_refused(
    make_universe: Maker, part: str
) -> None:
    universe = make_universe("CCGATCAAGG")
    universe.select_atoms(part).translate([0, 50, 0])
    with pytest.raises(InputError, match="the chain jumps by"):
        find_pairs(universe)
    universe.atoms.names = ["X" if name in ("P", "O5'") else name for name in universe.atoms.names]
    with pytest.raises(InputError, match="one periodic image"):
        find_pairs(universe)
    universe.dimensions = [70, 50, 60, 90, 90, 90]
    assert len(find_pairs(universe)) == 10


def test_files_without_phosphorus(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    universe.select_atoms("name P OP1 OP2").names = "X"
    found = HelicalParameters(universe).run().results.dataset
    assert found.sizes["pair"] == 8
    assert not found.step_flag.any()


@pytest.mark.parametrize(
    ("residue", "name", "gone", "letter"),
    [
        ("segid A and resid 3", "DT", {"C7"}, "T"),  # no methyl group in the file
        ("segid A and resid 3", "U", {"X"}, "U"),  # named as RNA, with one
        ("segid A and resid 2", "DG", {"X"}, "A"),  # N6 contradicts the name
        ("segid A and resid 2", "DC", {"N6"}, "A"),  # so does the ring
        ("segid A and resid 1", "DG", {"O6"}, "G"),
        ("segid A and resid 1", "2PR", {"O6"}, "A"),  # 2-aminopurine pairs with T
        ("segid A and resid 1", "DA", {"O6"}, "A"),  # the same, named after what it is like
        ("segid A and resid 6", "CYT", {"N4"}, "C"),
    ],
)
def test_a_residue_name_counts_unless_atoms_contradict_it(
    make_universe: Maker, residue: str, name: str, gone: set[str], letter: str
) -> None:
    universe = make_universe(SEQUENCE)
    changed = universe.select_atoms(residue).residues[0]
    changed.resname = name
    changed.atoms.select_atoms(f"name {' '.join(gone)}").names = "Y"
    bases = [nucleotide.base for nucleotide in find_nucleotides(universe.atoms)]
    assert bases[changed.resid - 1].letter == letter


def test_one_pair_alone_is_refused_as_such(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    ends = universe.select_atoms("(segid A and resid 1) or (segid B and resid 8)")
    with pytest.raises(InputError, match="side by side, but fewer than 2 of their bases face"):
        find_pairs(ends)
    assert len(find_pairs(ends, [("A:1", "B:8")])) == 1


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_coordinates_that_are_no_numbers_are_refused_as_such(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    universe.atoms.positions = np.full_like(universe.atoms.positions, np.nan)
    with pytest.raises(InputError, match="coordinates that are no numbers"):
        find_pairs(universe)


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
    with pytest.raises(InputError, match=r"one strand is here \(A:1 to A:8\)"):
        find_pairs(make_universe(SEQUENCE).select_atoms("segid A"))


def test_strands_that_do_not_match_are_refused(make_universe: Maker) -> None:
    universe = make_universe("AAAAAA")
    for atom in universe.select_atoms("segid B and name O4"):
        atom.name = "N4"
    with pytest.raises(InputError, match=r"A:1 to A:6, B:1 to B:6\) are complementary"):
        find_pairs(universe)


@pytest.mark.parametrize("label", ["A:99", "A1", "C:1"])
def test_a_base_that_is_not_there_is_named(make_universe: Maker, label: str) -> None:
    with pytest.raises(InputError, match=f"0 nucleotides are called '{label}'"):
        find_pairs(make_universe(SEQUENCE), [(label, "B:8")])


def test_no_pairs_given(make_universe: Maker) -> None:
    with pytest.raises(InputError, match="list is empty"):
        find_pairs(make_universe(SEQUENCE), [])


@pytest.mark.parametrize(
    ("residue", "changed", "letter"),
    [
        ("segid A and resid 1", {"O6": "S6"}, "G"),  # 6-thioguanine keeps N2
        ("segid A and resid 1", {"N2": "H2"}, "G"),  # inosine keeps O6
        ("segid A and resid 2", {"N6": "N", "N7": "C7"}, "A"),  # no mark left
        ("segid A and resid 3", {"O4": "S4"}, "T"),  # 4-thiothymine keeps the methyl group
        ("segid A and resid 6", {"N4": "NX4", "C5": "C5"}, "U"),  # no mark left
        ("segid A and resid 6", {"O2": "CM5"}, "C"),  # 5-methylcytosine, oddly named
    ],
)
def test_modified_bases_are_told_by_the_atoms_left(
    make_universe: Maker, residue: str, changed: dict[str, str], letter: str
) -> None:
    universe = make_universe(SEQUENCE)
    modified = universe.select_atoms(residue).residues[0]
    modified.resname = "XYZ"
    for atom in modified.atoms:
        atom.name = changed.get(atom.name, atom.name)
    bases = [nucleotide.base for nucleotide in find_nucleotides(universe.atoms)]
    (found,) = (base for base in bases if base.label == f"A:{modified.resid}")
    assert found.letter == letter
    assert len(find_pairs(universe)) == 8


def test_two_duplexes_of_equal_sequence_are_told_apart_by_geometry(make_universe: Maker) -> None:
    one, other = make_universe("CGCGAATTCGCG"), make_universe("CGCGAATTCGCG")
    other.atoms.translate([30, 5, 0])
    other.segments.segids = ["C", "D"]
    both = MDAnalysis.Merge(one.atoms, other.atoms)
    pairs = find_pairs(both)
    assert [pair.duplex for pair in pairs] == [0] * 12 + [1] * 12
    assert (pairs[0].label, pairs[12].label) == ("A:1-B:12", "C:1-D:12")
    dataset = HelicalParameters(both).run().results.dataset
    assert dataset.step_duplex.values.tolist() == [1] * 11 + [2] * 11
    assert dataset.step.values[11] == "C:1-D:12/C:2-D:11"
    # The same coordinates moved by 30 Å, in float32.
    np.testing.assert_allclose(dataset.twist[0, :11], dataset.twist[0, 11:], atol=2e-3)


def test_strands_of_two_duplexes_in_one_segment(make_universe: Maker) -> None:
    one, other = make_universe(SEQUENCE), make_universe("CCGATCAA")
    other.atoms.translate([30, 5, 0])
    both = MDAnalysis.Merge(one.atoms, other.atoms)
    both.residues.resids = np.arange(1, len(both.residues) + 1)
    both.residues.segments = both.segments[0]
    assert [pair.label for pair in find_pairs(both)][::8] == ["A:1-A:16", "A:17-A:32"]


def test_strands_with_5_phosphates_in_one_segment_are_told_by_distance(
    make_universe: Maker,
) -> None:
    universe = make_universe("CCGATCAAGG")
    inner = universe.select_atoms("resid 2:9")
    inner.residues.resids = np.arange(1, 17)
    inner.residues.segments = universe.segments[0]
    assert {"P"} <= set(inner.residues[8].atoms.names)
    assert [pair.label for pair in find_pairs(inner)][:1] == ["A:1-A:16"]


def test_a_hairpin_pairs_with_itself(make_universe: Maker) -> None:
    universe = make_universe("GCGCAATT")
    # Strand II continues strand I: TT and AA would be its loop.
    universe.residues.resids = np.arange(1, 17)
    universe.select_atoms("resid 9:16 and name O5'").names = "P"
    universe.select_atoms("resid 8 and name O3'").names = "O"
    universe.residues.segments = universe.segments[0]
    assert [pair.label for pair in find_pairs(universe)] == [
        f"A:{n}-A:{17 - n}" for n in range(1, 9)
    ]


def test_a_bulge_parts_a_duplex_in_two(make_universe: Maker) -> None:
    universe = make_universe("CCGATCAAGG")
    # Strand II lacks the partner of the fifth base: numbers of the rest close up.
    left = universe.select_atoms("not (segid B and resid 6)")
    left.select_atoms("segid B").residues.resids = np.arange(1, 10)
    pairs = find_pairs(left)
    assert [pair.duplex for pair in pairs] == [0] * 4 + [1] * 5
    assert (pairs[3].label, pairs[4].label) == ("A:4-B:6", "A:6-B:5")


def test_a_nick_is_bridged_by_a_list_and_flagged(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    part = universe.add_Segment(segid="C")
    universe.select_atoms("segid B and resid 5:8").residues.segments = part
    found = HelicalParameters(universe).run().results.dataset
    assert found.pair_duplex.values.tolist() == [1] * 4 + [2] * 4
    chains = "CCCCBBBB"
    listed = [(f"A:{n}", f"{chains[n - 1]}:{9 - n}") for n in range(1, 9)]
    bridged = HelicalParameters(universe, listed).run().results.dataset
    assert bridged.sizes["step"] == 7
    np.testing.assert_array_equal(
        (bridged.step_flag.values[0] & NOT_CONSECUTIVE) > 0, [False] * 3 + [True] + [False] * 3
    )


def test_a_broken_backbone_is_computed_and_flagged(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    whole = HelicalParameters(universe).run().results.dataset
    universe.select_atoms("segid A and resid 4 and name O3'").translate([4, 0, 0])
    broken = HelicalParameters(universe).run().results.dataset
    assert (broken.step_flag.values[0] & NOT_CONSECUTIVE).tolist() == [0, 0, 0, 32, 0, 0, 0]
    np.testing.assert_array_equal(broken.twist, whole.twist)


def test_parallel_strands(make_ideal: Callable[..., MDAnalysis.Universe]) -> None:
    turns = Rotation.from_euler("z", 30.0 * np.arange(6)[:, None], degrees=True)
    origins_A = np.outer(np.arange(6), [0, 0, 3.4])
    # Reverse Watson-Crick pairs: the partner turned half about the pair's normal.
    half = Rotation.from_euler("z", 180, degrees=True)
    universe = make_ideal("ATTATA", "TAATAT", turns, origins_A, half, antiparallel=False)
    dataset = HelicalParameters(universe).run().results.dataset
    assert dataset.pair.values.tolist() == [f"A:{n}-B:{n}" for n in range(1, 7)]
    np.testing.assert_array_equal(dataset.pair_flag, np.full((1, 6), PARALLEL))
    # float32 coordinates of 20 Å over a ring of 1.4 Å.
    np.testing.assert_allclose(dataset.opening, 180, atol=1e-3)
    np.testing.assert_allclose(dataset.twist, 30, atol=1e-3)
    np.testing.assert_allclose(dataset.rise, 3.4, atol=1e-5)


def test_no_nucleic_acid(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    universe.atoms.names = "CA"
    universe.residues.resnames = "ALA"
    with pytest.raises(InputError, match=r"no nucleic acid found among 16 residues \(ALA\)"):
        find_pairs(universe)


def test_a_topology_without_names() -> None:
    with pytest.raises(InputError, match="does not tell atom and residue names"):
        find_pairs(MDAnalysis.Universe.empty(3, trajectory=True))


def test_coordinates_of_another_topology(make_universe: Maker) -> None:
    universe = make_universe(SEQUENCE)
    universe.atoms.positions = universe.atoms.positions[::-1]
    with pytest.raises(InputError, match="same atoms in the same order"):
        find_pairs(universe)


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        ([("A:1", "B:8"), ("A:2", "B:8")], "B:8 is listed twice"),
        ([("A:1", "A:1")], "A:1 is listed twice"),
        ([("A:3", "B:6"), ("A:2", "B:7"), ("A:1", "B:8")], "3' to 5'"),
        ([("A:1", "B:8"), ("A:3", "B:6"), ("A:2", "B:7"), ("A:4", "B:5")], "3' to 5'"),
        ([("A:1", "B:8"), ("A:2", "B:6"), ("A:3", "B:7")], "turns back along strand II"),
    ],
)
def test_odd_lists_are_refused(
    make_universe: Maker, pairs: list[tuple[str, str]], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        find_pairs(make_universe(SEQUENCE), pairs)


def test_lists_of_two_duplexes_go_one_after_the_other(make_universe: Maker) -> None:
    one, other = make_universe(SEQUENCE), make_universe(SEQUENCE)
    other.atoms.translate([30, 5, 0])
    other.segments.segids = ["C", "D"]
    both = MDAnalysis.Merge(one.atoms, other.atoms)
    duplexes = [[(f"{s}:{n}", f"{t}:{9 - n}") for n in range(1, 9)] for s, t in ("AB", "CD")]
    assert [pair.duplex for pair in find_pairs(both, duplexes[0] + duplexes[1])] == [0] * 8 + [
        1
    ] * 8
    interleaved = [pair for pairs in zip(*duplexes, strict=True) for pair in pairs]
    with pytest.raises(InputError, match="one duplex after the other"):
        find_pairs(both, interleaved)


def test_a_list_as_a_file(make_universe: Maker, tmp_path: Path) -> None:
    file = tmp_path / "pairs.csv"
    file.write_text("index,chain1,resid1,chain2,resid2\n1,A,3,B,6\n2,,12,,13\n")
    assert read_pairs(file) == [("A:3", "B:6"), (":12", ":13")]
    universe = make_universe(SEQUENCE)
    universe.residues.resids = np.arange(1, 17)
    assert [p.label for p in find_pairs(universe, [(":2", ":15")])] == ["A:2-B:15"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("chain1,resid1\nA,1\n", "needed are chain1, resid1, chain2, resid2"),
        ("chain1,resid1,chain2,resid2\n", "lists no base pair"),
        ("chain1,resid1,chain2,resid2\nA,1,B\n", "line 2: a residue number is missing"),
    ],
)
def test_a_file_that_is_no_list(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "pairs.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        read_pairs(file)
