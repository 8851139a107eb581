"""Duplexes on given frames: the fibre model again, bends, and what they ask of the backbone."""

from __future__ import annotations

import numpy as np
import openmm
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from openmm import app, unit
from scipy.spatial.distance import pdist

from dnawaves.duplex.build import with_hydrogens
from dnawaves.duplex.fibre import FibreDuplex, fibre_duplex
from dnawaves.duplex.on_frames import (
    backbone_bonds_nm,
    duplex_from_steps,
    duplex_on_frames,
    geometry,
)
from dnawaves.errors import InputError
from dnawaves.frames.helix import helix_parameters
from dnawaves.frames.parameters import STEP_PARAMETERS

DICKERSON = "CGCGAATTCGCG"


def own_steps(sequence: str) -> NDArray[np.float64]:
    return geometry(fibre_duplex(sequence)).step_values


def changed(sequence: str, **changes: float) -> NDArray[np.float64]:
    """Return the fibre model's own steps, some parameters changed by as much at every step."""
    steps = own_steps(sequence)
    for name, change in changes.items():
        steps[STEP_PARAMETERS.index(name)] += change
    return steps


def bent_in_a_plane(sequence: str, bend_deg: float) -> NDArray[np.float64]:
    """Return the fibre model's own steps, each bent by as much towards one side of the helix."""
    steps = own_steps(sequence)
    phase = np.radians(np.cumsum(steps[5]))
    steps[3] += bend_deg * np.sin(phase)
    steps[4] += bend_deg * np.cos(phase)
    return steps


@settings(max_examples=25, deadline=None)
@given(st.text("ACGT", min_size=4, max_size=16))
def test_its_own_steps_give_the_fibre_model_back(sequence: str) -> None:
    fibre = fibre_duplex(sequence)
    built = duplex_from_steps(sequence, geometry(fibre).step_values)
    # Round-off only, in nm.
    np.testing.assert_allclose(built.positions_nm, fibre.positions_nm, atol=1e-9)
    np.testing.assert_array_equal(built.atom_names, fibre.atom_names)


def test_the_fibre_model_is_a_helix_of_36_degrees_and_3375_angstrom() -> None:
    found = helix_parameters(geometry(fibre_duplex("A" * 8)).pairs).values
    expected = np.broadcast_to([[3.375], [36.0]], (2, 7))
    # One rigid pair repeated: round-off only (Arnott & Hukins 1972).
    np.testing.assert_allclose(found[[2, 5]], expected, atol=1e-10)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_steps_and_pairs_asked_for_are_those_of_the_atoms(seed: int) -> None:
    random = np.random.default_rng(seed)
    sequence = "".join(random.choice(list("ACGT"), 9))
    steps = random.normal([0, 0, 3.4, 0, 2, 35], [1, 1, 0.5, 15, 15, 15], size=(8, 6)).T
    pairs = random.normal([0, 0, 0, 0, -10, 0], [0.5, 0.2, 0.5, 10, 10, 10], size=(9, 6)).T
    found = geometry(duplex_from_steps(sequence, steps, pairs))
    # The frames are fitted anew, to atoms up to 40 Å from the origin.
    np.testing.assert_allclose(found.step_values, steps, atol=1e-9)
    np.testing.assert_allclose(found.pair_values, pairs, atol=1e-9)


def test_nucleotides_stay_rigid_and_right_handed() -> None:
    fibre, bent = fibre_duplex(DICKERSON), duplex_from_steps(DICKERSON, changed(DICKERSON, roll=20))
    for chain in "AB":
        for resid in range(1, 13):
            here = (fibre.chain_ids == chain) & (fibre.residue_ids == resid)
            before, after = fibre.positions_nm[here], bent.positions_nm[here]
            np.testing.assert_allclose(pdist(after), pdist(before), atol=1e-12)
            handed = [np.linalg.det(np.diff(atoms[:4], axis=0)) for atoms in (before, after)]
            assert handed[0] == pytest.approx(handed[1], abs=1e-12)


def test_frames_anywhere() -> None:
    pairs = geometry(fibre_duplex(DICKERSON)).pairs
    elsewhere = pairs._replace(origin=pairs.origin + np.array([[10.0], [20], [30]]))
    moved = duplex_on_frames(DICKERSON, elsewhere)
    expected = fibre_duplex(DICKERSON).positions_nm + np.array([1, 2, 3])
    np.testing.assert_allclose(moved.positions_nm, expected, atol=1e-9)


# Shortest and longest O3'-P bond in Å, a nucleotide of the fibre model being rigid.
@pytest.mark.parametrize(
    ("steps", "shortest_A", "longest_A"),
    [
        (changed(DICKERSON), 1.60, 1.60),
        (changed(DICKERSON, roll=5), 1.78, 1.79),
        (changed(DICKERSON, roll=-5), 1.43, 1.44),
        (changed(DICKERSON, tilt=5), 1.22, 2.17),
        (changed(DICKERSON, twist=5), 1.87, 1.88),
        (changed(DICKERSON, twist=-5), 1.66, 1.66),
        (changed(DICKERSON, rise=0.3), 1.80, 1.80),
        (changed(DICKERSON, slide=0.3), 1.82, 1.82),
        (bent_in_a_plane(DICKERSON, 1), 1.50, 1.71),
        (bent_in_a_plane(DICKERSON, 2), 1.41, 1.83),
        (bent_in_a_plane(DICKERSON, 5), 1.21, 2.20),
        (bent_in_a_plane(DICKERSON, 10), 1.14, 2.89),
    ],
)
def test_what_a_deformation_asks_of_the_backbone(
    steps: NDArray[np.float64], shortest_A: float, longest_A: float
) -> None:
    bonds_A = 10 * backbone_bonds_nm(duplex_from_steps(DICKERSON, steps))
    assert bonds_A.shape == (2, 11)
    # The table of docs/frames.md, to its two decimals.
    assert bonds_A.min() == pytest.approx(shortest_A, abs=0.0051)
    assert bonds_A.max() == pytest.approx(longest_A, abs=0.0051)


def test_backbone_bonds_run_along_strand_I() -> None:
    steps = own_steps(DICKERSON)
    steps[2, 3] += 1.0
    bonds_A = 10 * backbone_bonds_nm(duplex_from_steps(DICKERSON, steps))
    stretched = bonds_A > 1.8
    np.testing.assert_array_equal(np.flatnonzero(stretched[0]), [3])
    np.testing.assert_array_equal(np.flatnonzero(stretched[1]), [3])


def test_a_short_minimisation_heals_the_backbone_of_a_bent_duplex() -> None:
    sequence = "CGATCG"
    force_field = app.ForceField("amber19/DNA.OL21.xml", "implicit/obc2.xml")
    steps = bent_in_a_plane(sequence, 5)
    topology, positions_nm = with_hydrogens(duplex_from_steps(sequence, steps), force_field)
    heavy = [atom.index for atom in topology.atoms() if atom.element is not app.element.hydrogen]
    system = force_field.createSystem(topology, nonbondedMethod=app.NoCutoff)
    context = openmm.Context(
        system,
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("CPU"),
        {"Threads": "1"},
    )
    context.setPositions(positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, maxIterations=100)
    relaxed = context.getState(positions=True).getPositions(asNumpy=True)
    fibre = fibre_duplex(sequence)
    after = FibreDuplex(
        fibre.atom_names,
        fibre.residue_names,
        fibre.residue_ids,
        fibre.chain_ids,
        relaxed.value_in_unit(unit.nanometer)[heavy],
    )
    # P-O3' of the force field at rest is 1.61 Å.
    np.testing.assert_allclose(backbone_bonds_nm(after), 0.161, atol=0.003)
    # The shape stays: the fibre model's own steps move as far, about 5 degrees, when it relaxes.
    moved = geometry(after).step_values - steps
    assert np.sqrt(np.mean(moved[3:] ** 2)) < 7


def test_refuses_the_wrong_number_of_parameters() -> None:
    with pytest.raises(InputError, match=r"step parameters have shape \(6, 5\).*ACGT: \(6, 3\)"):
        duplex_from_steps("ACGT", np.zeros((6, 5)))
    with pytest.raises(InputError, match=r"pair parameters have shape \(6, 3\).*ACGT: \(6, 4\)"):
        duplex_from_steps("ACGT", own_steps("ACGT"), np.zeros((6, 3)))
