"""A user's own PDB or mmCIF file becomes a duplex, or is refused with what is wrong in it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import gemmi
import numpy as np
import pytest
from openmm import app

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.duplex.from_file import read_duplex
from dnawaves.errors import InputError
from dnawaves.scene.structure_file import digest_of_file, sequence_of_file

SEQUENCE = "GGATAC"
Change = Callable[[gemmi.Structure], None]


@pytest.fixture(scope="module")
def force_field() -> app.ForceField:
    return app.ForceField("amber19/DNA.OL21.xml")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory, force_field: app.ForceField) -> Path:
    path = tmp_path_factory.mktemp("user") / "duplex.pdb"
    write_pdb(*build_duplex(SEQUENCE, force_field), path)
    return path


@pytest.fixture
def changed(written: Path, tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes the duplex with a change, as PDB or mmCIF."""

    def write(change: Change, suffix: str = ".pdb") -> Path:
        structure = gemmi.read_structure(str(written))
        change(structure)
        path = tmp_path / f"changed{suffix}"
        if suffix == ".pdb":
            structure.write_pdb(str(path))
        else:
            structure.setup_entities()
            structure.make_mmcif_document().write_file(str(path))
        return path

    return write


def heavy(path: Path) -> int:
    return sum(not atom.is_hydrogen() for atom in atoms_of(gemmi.read_structure(str(path))))


def atoms_of(structure: gemmi.Structure) -> list[gemmi.Atom]:
    return [site.atom for site in structure[0].all()]


def test_what_build_writes_is_read_back_atom_for_atom(
    written: Path, force_field: app.ForceField
) -> None:
    pdb = app.PDBFile(str(written))
    topology, positions = read_duplex(written, force_field)
    assert sequence_of_file(written) == SEQUENCE
    assert [str(atom) for atom in topology.atoms()] == [str(atom) for atom in pdb.topology.atoms()]
    # The same decimals, divided by ten by another program: the last bit.
    np.testing.assert_allclose(positions, pdb.getPositions(asNumpy=True)._value, rtol=0, atol=1e-15)


def rename_and_renumber(structure: gemmi.Structure) -> None:
    old = {"OP1": "O1P", "OP2": "O2P", "C7": "C5M", "HO5'": "H5T", "H2''": "H2'2"}
    for name, chain in zip("XY", structure[0], strict=True):
        chain.name = name
        for number, residue in enumerate(chain, start=101):
            residue.seqid = gemmi.SeqId(str(number))
            for atom in residue:
                atom.name = old.get(atom.name, atom.name).replace("'", "*")


@pytest.mark.parametrize("suffix", [".pdb", ".cif"])
def test_names_and_numbers_come_to_the_projects(
    changed: Callable[..., Path], written: Path, force_field: app.ForceField, suffix: str
) -> None:
    topology, positions = read_duplex(changed(rename_and_renumber, suffix), force_field)
    ours = app.PDBFile(str(written)).topology
    assert [str(atom) for atom in topology.atoms()] == [str(atom) for atom in ours.atoms()]
    assert {chain.id for chain in topology.chains()} == {"A", "B"}
    expected = read_duplex(written, force_field)[1]
    np.testing.assert_allclose(positions, expected, rtol=0, atol=1e-12)


def test_missing_hydrogens_are_added_and_heavy_atoms_stay(
    changed: Callable[..., Path], written: Path, force_field: app.ForceField
) -> None:
    topology, positions = read_duplex(
        changed(lambda structure: structure.remove_hydrogens()), force_field
    )
    ours, places = read_duplex(written, force_field)
    assert topology.getNumAtoms() == ours.getNumAtoms() > heavy(written)
    where = {
        (a.residue.chain.id, a.residue.id, a.name): positions[a.index] for a in topology.atoms()
    }
    for atom in ours.atoms():
        found = where[atom.residue.chain.id, atom.residue.id, atom.name]
        # Modeller puts hydrogens to 0.01 nm or so again, heavy atoms are not touched.
        limit = 0.05 if atom.element.symbol == "H" else 1e-12
        assert np.linalg.norm(found - places[atom.index]) < limit


def test_water_is_left_out_and_so_are_terminal_phosphates(
    changed: Callable[..., Path], force_field: app.ForceField
) -> None:
    def cut(structure: gemmi.Structure) -> None:
        one, other = structure[0]
        del one[0]  # the second nucleotide, that has a phosphate, is now the first
        del other[-1]
        water = gemmi.Residue()
        water.name, water.seqid, water.het_flag = "HOH", gemmi.SeqId("50"), "H"
        water.add_atom(gemmi.Atom())
        water[0].name, water[0].element = "O", gemmi.Element("O")
        one.add_residue(water)

    path = changed(cut)
    topology, _ = read_duplex(path, force_field)
    assert sequence_of_file(path) == SEQUENCE[1:]
    for chain in topology.chains():
        named = [{atom.name for atom in residue.atoms()} for residue in chain.residues()]
        assert "P" not in named[0] and "HO5'" in named[0]
        assert all("P" in names for names in named[1:])


def drop(chain: int, residue: int, name: str) -> Change:
    def change(structure: gemmi.Structure) -> None:
        structure[0][chain][residue].remove_atom(name, "\0")

    return change


def mutate(structure: gemmi.Structure) -> None:
    # G to A by its atoms: N6 for O6, no N2.
    residue = structure[0][0][1]
    residue.name = "DA"
    for name in ("N2", "H21", "H22", "H1"):
        residue.remove_atom(name, "\0")
    residue.find_atom("O6", "*").name = "N6"


def add_hydroxyl(structure: gemmi.Structure) -> None:
    structure[0][0][2].add_atom(structure[0][0][2][0]).name = "O2'"


def pull_apart(structure: gemmi.Structure) -> None:
    for atom in structure[0][1][3]:
        atom.pos.x += 8


def take_strands_apart(structure: gemmi.Structure) -> None:
    for residue in structure[0][1]:
        for atom in residue:
            atom.pos.x += 40


def pile_up(structure: gemmi.Structure) -> None:
    for atom in structure[0][1][3]:
        atom.pos = gemmi.Position(0, 0, 0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (drop(0, 2, "C8"), "residue A:3: found no C8"),
        (drop(1, 3, "P"), "residue B:4: found no P"),
        (mutate, "found GTATCC; allowed: GTATTC, the Watson-Crick complement of GAATAC"),
        (add_hydroxyl, "residue A:3: found O2'; allowed: the atoms of DA"),
        (pull_apart, "residues B:3 and B:4: found O3' and P "),
        (take_strands_apart, "residues A:1 and B:6: found C1' and C1' "),
        (pile_up, "residue B:4: found several atoms in one place"),
        (
            lambda structure: setattr(structure[0][0][1][3].pos, "x", float("nan")),
            "residue A:2: found coordinates that are no numbers",
        ),
        (lambda structure: structure[0].remove_chain("B"), "chains: found 1 of nucleotides"),
        (
            lambda structure: setattr(structure[0][0][1], "name", "PSU"),
            "residue A:2: found PSU; allowed: DA, DC, DG or DT",
        ),
    ],
)
def test_what_is_no_duplex_is_refused(
    changed: Callable[..., Path], change: Change, said: str
) -> None:
    path = changed(change)
    with pytest.raises(InputError) as caught:
        sequence_of_file(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert said in str(caught.value)


def test_what_is_no_structure_is_refused(tmp_path: Path) -> None:
    for name, content in (("a.cif", "hello"), ("a.pdb", ""), ("a.gro", "")):
        (tmp_path / name).write_text(content)
        with pytest.raises(InputError, match=name):
            sequence_of_file(tmp_path / name)
    for read in (sequence_of_file, digest_of_file):
        with pytest.raises(InputError, match="cannot be read"):
            read(tmp_path / "none.pdb")


def test_the_digest_is_the_contents(tmp_path: Path) -> None:
    path = tmp_path / "x.pdb"
    path.write_bytes(b"abc")
    # SHA-256 of "abc", FIPS 180-4, example.
    expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert digest_of_file(path) == expected
