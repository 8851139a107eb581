"""The complete duplex: atoms, bonds, hydrogen bonds, hydrogens, files."""

from __future__ import annotations

import io
import random
from pathlib import Path

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray
from openmm import app, unit

from dnawaves.duplex.build import build_duplex, watson_crick_bonds, write_pdb
from dnawaves.duplex.fibre import fibre_duplex
from dnawaves.errors import InputError

DICKERSON = "CGCGAATTCGCG"
SHORT = "ACGTA"

Built = tuple[app.Topology, NDArray[np.float64]]


@pytest.fixture(scope="module")
def force_field() -> app.ForceField:
    return app.ForceField("amber19/DNA.OL21.xml", "implicit/obc2.xml")


@pytest.fixture(scope="module")
def dickerson(force_field: app.ForceField) -> Built:
    return build_duplex(DICKERSON, force_field)


def test_atom_count_of_the_dodecamer(dickerson: Built) -> None:
    topology, positions_nm = dickerson
    # dA 32, dC 30, dG 33, dT 32 atoms inside a strand; each strand loses a PO3 less an H, gains H.
    per_strand = 2 * 32 + 4 * 30 + 4 * 33 + 2 * 32 - 3 + 1 + 1
    assert topology.getNumAtoms() == 2 * per_strand == 758
    assert positions_nm.shape == (758, 3)


def test_chains_and_numbers(dickerson: Built) -> None:
    topology, _ = dickerson
    chains = list(topology.chains())
    assert [chain.id for chain in chains] == ["A", "B"]
    for chain in chains:
        assert [residue.id for residue in chain.residues()] == [str(n) for n in range(1, 13)]
        assert "".join(residue.name[1] for residue in chain.residues()) == DICKERSON


def test_bonds_are_as_long_as_bonds_are(dickerson: Built) -> None:
    topology, positions_nm = dickerson
    # A tree of atoms has atoms - 1 bonds per strand; every ring adds one (sugar 1, base 1 or 2).
    rings = sum(2 + (residue.name in ("DA", "DG")) for residue in topology.residues())
    assert topology.getNumBonds() == topology.getNumAtoms() - 2 + rings
    for a, b in topology.bonds():
        length_nm = np.linalg.norm(positions_nm[a.index] - positions_nm[b.index])
        hydrogen = app.element.hydrogen in (a.element, b.element)
        # X-H 0.96 to 1.09 Å; C=O 1.22 Å to P-O 1.60 Å; 0.05 Å for the models.
        low, high = (0.091, 0.114) if hydrogen else (0.117, 0.165)
        assert low < length_nm < high, (a, b)


def test_heavy_atoms_stay_where_the_fibre_model_has_them(dickerson: Built) -> None:
    topology, positions_nm = dickerson
    heavy = [a.index for a in topology.atoms() if a.element is not app.element.hydrogen]
    # The hydrogens relax around frozen atoms: only round-off may differ.
    np.testing.assert_allclose(
        positions_nm[heavy], fibre_duplex(DICKERSON).positions_nm, atol=1e-12
    )


def test_watson_crick_bonds(dickerson: Built) -> None:
    topology, positions_nm = dickerson
    atoms = list(topology.atoms())
    pairs = watson_crick_bonds(topology)
    assert [len(bonds) for bonds in pairs] == [{"A": 2, "T": 2}.get(b, 3) for b in DICKERSON]
    for number, bonds in enumerate(pairs, start=1):
        for i, j in bonds:
            assert (atoms[i].residue.chain.id, atoms[i].residue.id) == ("A", str(number))
            assert (atoms[j].residue.chain.id, atoms[j].residue.id) == ("B", str(13 - number))
            # N-H..N and N-H..O of base pairs in crystals: 2.8 to 3.0 Å, 0.2 Å about it.
            assert 0.26 < np.linalg.norm(positions_nm[i] - positions_nm[j]) < 0.32
    names = {(atoms[i].name, atoms[j].name) for i, j in pairs[0]}
    assert names == {("N4", "O6"), ("N3", "N1"), ("O2", "N2")}  # C-G


def test_the_same_call_gives_the_same_numbers(force_field: app.ForceField) -> None:
    random.seed(5)
    state = random.getstate()
    _, first = build_duplex(SHORT, force_field)
    assert random.getstate() == state
    random.seed(6)
    _, second = build_duplex(SHORT, force_field)
    np.testing.assert_array_equal(first, second)


def test_starts_free_of_strain(dickerson: Built, force_field: app.ForceField) -> None:
    topology, positions_nm = dickerson
    system = force_field.createSystem(topology, nonbondedMethod=app.NoCutoff)
    context = openmm.Context(
        system,
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("CPU"),
        {"Threads": "2"},
    )
    context.setPositions(positions_nm)
    before = potential_energy(context)
    openmm.LocalEnergyMinimizer.minimize(context, maxIterations=50)
    after = potential_energy(context)
    # Trial runs: -2.09e4 to -2.21e4 kJ/mol. A clash of two atoms alone costs 1e5 and more.
    assert before == pytest.approx(-2.09e4, rel=0.05)
    assert -2.35e4 < after < before
    relaxed = context.getState(positions=True).getPositions(asNumpy=True)
    moved_nm = np.linalg.norm(relaxed.value_in_unit(unit.nanometer) - positions_nm, axis=1)
    # The same structure still: well below the 0.7 Å between two thermal snapshots of B-DNA.
    assert np.sqrt(np.mean(moved_nm**2)) < 0.03


def potential_energy(context: openmm.Context) -> float:
    energy = context.getState(energy=True).getPotentialEnergy()
    return float(energy.value_in_unit(unit.kilojoule_per_mole))


def test_pdb_keeps_chains_names_and_places(dickerson: Built, tmp_path: Path) -> None:
    topology, positions_nm = dickerson
    write_pdb(topology, positions_nm, tmp_path / "duplex.pdb")
    with open(tmp_path / "duplex.pdb", encoding="utf-8") as file:
        text = io.StringIO(file.read())
    read = app.PDBFile(text)
    assert [a.name for a in read.topology.atoms()] == [a.name for a in topology.atoms()]
    assert [c.id for c in read.topology.chains()] == ["A", "B"]
    back_nm = read.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    np.testing.assert_allclose(back_nm, positions_nm, atol=0.5001e-4)  # PDB rounds to 0.001 Å


def test_pdb_to_an_open_file(dickerson: Built) -> None:
    stream = io.StringIO()
    write_pdb(*dickerson, stream)
    assert stream.getvalue().count("\nATOM ") == 758


def test_refuses_strands_that_do_not_pair(force_field: app.ForceField) -> None:
    topology, _ = build_duplex(SHORT, force_field)
    next(topology.residues()).name = "DG"
    with pytest.raises(InputError, match="DG A:1 and DT B:5 do not pair"):
        watson_crick_bonds(topology)


def test_refuses_what_is_no_nucleotide(force_field: app.ForceField) -> None:
    topology, _ = build_duplex(SHORT, force_field)
    next(topology.residues()).name = "HOH"
    with pytest.raises(InputError, match="HOH A:1 is none of DA"):
        watson_crick_bonds(topology)


def test_refuses_a_single_strand() -> None:
    topology = app.Topology()
    topology.addChain("A")
    with pytest.raises(InputError, match="two chains; this topology has 1"):
        watson_crick_bonds(topology)


def test_refuses_what_is_no_sequence(force_field: app.ForceField) -> None:
    with pytest.raises(InputError, match="allowed: 4 or more"):
        build_duplex("ACG", force_field)
