"""The fibre model's atoms: screw, handedness, chirality, contacts."""

from __future__ import annotations

from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import shortest_path
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

from dnawaves.duplex.build import heavy_topology
from dnawaves.duplex.fibre import FibreDuplex, fibre_duplex
from dnawaves.errors import InputError
from dnawaves.scene.sequence import reverse_complement

MIXED = "ATGCCGTAAGCT"
TWIST_DEG, RISE_A = 36.0, 3.375  # Arnott & Hukins (1972), B-DNA

HEAVY_ATOMS = {"A": 21, "C": 19, "G": 22, "T": 20}  # of one nucleotide, phosphate included

# Cahn-Ingold-Prelog order of the three neighbours above the hydrogen. 2'-deoxyadenosine is
# (2R,3S,5R)-5-(adenin-9-yl)-2-(hydroxymethyl)oxolan-3-ol: C4' is R, C3' is S, C1' is R.
# Seen with the hydrogen away, R runs clockwise: the triple product is negative.
CHIRAL = {
    "C1'": (("O4'", "N", "C2'"), -1.0),
    "C3'": (("O3'", "C4'", "C2'"), +1.0),
    "C4'": (("O4'", "C3'", "C5'"), -1.0),
}


def residue_atoms(duplex: FibreDuplex, chain: str, resid: int) -> dict[str, NDArray[np.float64]]:
    """Return atom name -> position in Å of one nucleotide."""
    here = (duplex.chain_ids == chain) & (duplex.residue_ids == resid)
    positions_A = 10 * duplex.positions_nm[here]
    return dict(zip(duplex.atom_names[here].tolist(), positions_A, strict=True))


def glycosidic_nitrogen(atoms: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    return atoms["N9"] if "N9" in atoms else atoms["N1"]


def closest_unbonded_distance(duplex: FibreDuplex) -> float:
    """Return the smallest distance in Å between heavy atoms more than three bonds apart."""
    topology = heavy_topology(duplex)
    bonds = np.array([(a.index, b.index) for a, b in topology.bonds()]).T
    atoms = topology.getNumAtoms()
    graph = coo_array((np.ones(bonds.shape[1]), tuple(bonds)), shape=(atoms, atoms))
    apart = shortest_path(graph.tocsr(), directed=False, unweighted=True) > 3
    return float(10 * cdist(duplex.positions_nm, duplex.positions_nm)[apart].min())


def test_backbone_atoms_obey_the_screw_whatever_the_sequence() -> None:
    duplex = fibre_duplex(MIXED)
    screw = Rotation.from_euler("z", TWIST_DEG, degrees=True)
    for chain, side in (("A", 1), ("B", -1)):
        for name in ("P", "C1'"):
            here = (duplex.chain_ids == chain) & (duplex.atom_names == name)
            positions_A = 10 * duplex.positions_nm[here][::side]
            expected = screw.apply(positions_A[:-1]) + np.array([0, 0, RISE_A])
            # Built by the screw itself: only round-off may differ.
            np.testing.assert_allclose(positions_A[1:], expected, atol=1e-9)


def test_a_tract_bases_turn_and_rise_by_the_screw() -> None:
    duplex = fibre_duplex("AAAAAA")
    for chain, side in (("A", 1), ("B", -1)):
        for resid in range(2, 5):
            here, there = (
                np.array(list(residue_atoms(duplex, chain, n).values())) for n in (resid, resid + 1)
            )
            turn, _ = Rotation.align_vectors(there - there.mean(0), here - here.mean(0))
            # One rigid nucleotide repeated: far below the published rounding of 0.02 deg, 0.001 Å.
            np.testing.assert_allclose(
                turn.as_rotvec(degrees=True), [0, 0, side * TWIST_DEG], atol=1e-6
            )
            rise = (there - here).mean(0)[2]
            assert rise == pytest.approx(side * RISE_A, abs=1e-9)


def test_strands_run_antiparallel_first_strand_up() -> None:
    duplex = fibre_duplex(MIXED)
    for chain, sign in (("A", 1), ("B", -1)):
        for resid in range(1, len(MIXED) + 1):
            atoms = residue_atoms(duplex, chain, resid)
            # O5' to O3' is the strand's direction; a nucleotide spans about 2 Å of the axis.
            assert sign * (atoms["O3'"] - atoms["O5'"])[2] > 1.0


@pytest.mark.parametrize("sequence", [MIXED, "ACGT"])
def test_sugars_are_beta_d_deoxyribose(sequence: str) -> None:
    duplex = fibre_duplex(sequence)
    for chain in "AB":
        for resid in range(1, len(sequence) + 1):
            atoms = residue_atoms(duplex, chain, resid)
            atoms["N"] = glycosidic_nitrogen(atoms)
            for centre, (neighbours, sign) in CHIRAL.items():
                a, b, c = (atoms[name] - atoms[centre] for name in neighbours)
                # An ideal tetrahedral centre gives about 2.6 Å^3; 0 would be a flat one.
                assert sign * np.dot(a, np.cross(b, c)) > 2.0, (chain, resid, centre)


def test_sugars_pucker_towards_c2_endo() -> None:
    """C2'-endo is what makes the duplex B-form: C2' on the side of C5', away from C1'-O4'-C4'."""
    atoms = residue_atoms(fibre_duplex(MIXED), "A", 5)
    normal = np.cross(atoms["C4'"] - atoms["O4'"], atoms["C1'"] - atoms["O4'"])
    normal /= np.linalg.norm(normal)
    out_C2, out_C3, out_C5 = (
        np.dot(normal, atoms[name] - atoms["O4'"]) for name in ("C2'", "C3'", "C5'")
    )
    assert out_C2 * out_C5 > 0
    # An envelope lifts its endo atom by some 0.5 Å; the other one stays near the plane.
    assert abs(out_C2) > 0.4 > abs(out_C3)


def test_names_are_todays_and_the_ends_have_no_phosphate() -> None:
    duplex = fibre_duplex("ACGT")
    assert set(duplex.residue_names) == {"DA", "DC", "DG", "DT"}
    assert not {"O1P", "O2P", "C5M"} & set(duplex.atom_names)
    assert "C7" in duplex.atom_names
    for chain in "AB":
        assert "P" not in residue_atoms(duplex, chain, 1)
        assert {"P", "OP1", "OP2"} <= set(residue_atoms(duplex, chain, 2))


@settings(max_examples=25, deadline=None)
@given(st.text("ACGT", min_size=4, max_size=16))
def test_any_sequence_gives_a_sound_duplex(sequence: str) -> None:
    duplex = fibre_duplex(sequence)
    both = sequence + reverse_complement(sequence)
    assert len(duplex.atom_names) == sum(HEAVY_ATOMS[base] for base in both) - 6
    assert np.isfinite(duplex.positions_nm).all()
    # Bonded ends of the backbone: P-O3' is 1.60 Å (Gelbin et al. 1996), 0.02 for a fibre model.
    for chain in "AB":
        for resid in range(2, len(sequence) + 1):
            oxygen = residue_atoms(duplex, chain, resid - 1)["O3'"]
            phosphorus = residue_atoms(duplex, chain, resid)["P"]
            assert np.linalg.norm(oxygen - phosphorus) == pytest.approx(1.60, abs=0.02)
    # Hydrogen bonds of 2.85 Å are the closest wanted contacts; an O..C contact of van der Waals
    # radii less 0.5 Å is 2.7 Å.
    assert closest_unbonded_distance(duplex) > 2.7


def test_refuses_what_is_no_sequence() -> None:
    with pytest.raises(InputError, match="'X' at position 2"):
        fibre_duplex("AXGT")


@pytest.mark.parametrize(
    ("case", "sequence"), [("fibre_bdna_12", "CGCGAATTCGCG"), ("fibre_polyA_12", "A" * 12)]
)
def test_is_the_published_model(shared: Path, case: str, sequence: str) -> None:
    reference = MDAnalysis.Universe(shared / "reference" / "helical" / case / "structure.pdb")
    duplex = fibre_duplex(sequence)
    chains = {segment.segid: segment.atoms for segment in reference.segments}
    here, there = [], []
    for chain, atoms in chains.items():
        for residue in atoms.residues:
            ours = residue_atoms(duplex, chain, int(residue.resid))
            named = {"C7": "C7", "C5M": "C7"}
            for atom in residue.atoms:
                there.append(atom.position)
                here.append(ours[named.get(atom.name, atom.name)])
    assert len(here) == len(duplex.atom_names)
    first, second = np.array(here), np.array(there, dtype=np.float64)
    _, rssd = Rotation.align_vectors(second - second.mean(0), first - first.mean(0))
    # Both files round: PDB to 0.001 Å, the table to 0.001 Å and 0.01 deg (0.002 Å at 10 Å).
    assert rssd / np.sqrt(len(here)) < 0.002
