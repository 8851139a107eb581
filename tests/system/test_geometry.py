"""The helix axis and the base pairs: exact on the fibre model, the same however it lies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.duplex.fibre import RISE_A, fibre_duplex
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.geometry import helix_frame, sugar_anchors

Array = NDArray[np.float64]
SEQUENCE = "ACGTTA"
PAIRS = len(SEQUENCE)
coordinates = st.floats(-20, 20)


def fibre_anchors_nm() -> Array:
    """Return the fibre model's C1' atoms, (2, N, 3); its helix axis is z, pair 1 at z = 0."""
    duplex = fibre_duplex(SEQUENCE)
    sugars = duplex.atom_names == "C1'"
    first, second = (duplex.positions_nm[sugars & (duplex.chain_ids == c)] for c in "AB")
    return np.array([first, second[::-1]])


@pytest.fixture(scope="module")
def duplex(as_built: Callable[..., SimulatedDuplex]) -> SimulatedDuplex:
    return as_built(SEQUENCE)


def test_axis_of_the_fibre_model_is_found() -> None:
    frame = helix_frame(fibre_anchors_nm())
    # The sum of squares is minimised to round-off; the axis follows to its root, about 1e-8.
    np.testing.assert_allclose(frame.axis, [0, 0, 1], atol=1e-8)
    np.testing.assert_allclose(frame.origin_nm[:2], 0, atol=1e-8)
    # Pair 1 has its dyad on x, so the line between its C1' atoms, II to I, lies along y.
    np.testing.assert_allclose(np.abs(frame.directions[0]), [0, 1, 0], atol=1e-8)
    np.testing.assert_allclose(np.linalg.det(frame.directions), 1, atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1),
    st.tuples(coordinates, coordinates, coordinates),
)
def test_frame_moves_with_the_duplex(
    quaternion: list[float], shift_nm: tuple[float, float, float]
) -> None:
    turn = Rotation.from_quat(quaternion)
    anchors_nm = fibre_anchors_nm()
    lying = helix_frame(anchors_nm)
    moved_nm = turn.apply(anchors_nm.reshape(-1, 3)).reshape(anchors_nm.shape) + shift_nm
    moved = helix_frame(moved_nm)
    # As above, and 1e-15 of a shift of 20 nm.
    np.testing.assert_allclose(moved.directions, turn.apply(lying.directions), atol=1e-7)
    np.testing.assert_allclose(
        moved.on_axis(np.array(shift_nm)), shift_nm, atol=1e-7
    )  # the fibre's axis went through the origin
    heights = moved.height_nm(moved_nm.mean(axis=0))
    np.testing.assert_allclose(np.diff(heights), RISE_A / 10, atol=1e-7)


def test_frame_turns_over_when_the_pairs_are_counted_from_the_other_end() -> None:
    anchors_nm = fibre_anchors_nm()
    frame = helix_frame(anchors_nm[::-1, ::-1])
    np.testing.assert_allclose(frame.axis, [0, 0, -1], atol=1e-8)
    np.testing.assert_allclose(np.linalg.det(frame.directions), 1, atol=1e-12)


def test_axis_of_a_deformed_duplex_minimises_the_cylinders_misfit() -> None:
    generator = np.random.default_rng(3)
    anchors_nm = fibre_anchors_nm() + generator.normal(0, 0.03, (2, PAIRS, 3))
    frame = helix_frame(anchors_nm)

    def misfit(origin_nm: Array, axis: Array) -> float:
        arms = np.cross(anchors_nm.reshape(-1, 3) - origin_nm, axis / np.linalg.norm(axis))
        return float(np.var(np.linalg.norm(arms, axis=1)))

    least = misfit(frame.origin_nm, frame.axis)
    assert least > 1e-5
    for transverse in frame.directions[:2]:
        for change in (-1e-3, 1e-3):
            assert misfit(frame.origin_nm + change * transverse, frame.axis) > least
            assert misfit(frame.origin_nm, frame.axis + change * transverse) > least


def test_base_pairs_are_counted_along_strand_one(duplex: SimulatedDuplex) -> None:
    assert duplex.labels == ["A:1-B:6", "A:2-B:5", "A:3-B:4", "A:4-B:3", "A:5-B:2", "A:6-B:1"]
    for atom in duplex.topology.atoms():
        number = int(atom.residue.id)
        expected = number if atom.residue.chain.id == "A" else PAIRS + 1 - number
        assert duplex.pairs[atom.index] == expected - 1
    atoms = list(duplex.topology.atoms())
    for strand, chain in zip(sugar_anchors(duplex.topology), "AB", strict=True):
        assert [duplex.pairs[index] for index in strand] == list(range(PAIRS))
        assert {(atoms[index].name, atoms[index].residue.chain.id) for index in strand} == {
            ("C1'", chain)
        }


def test_heights_and_spacing_of_the_fibre_model(duplex: SimulatedDuplex) -> None:
    # The fibre model's rise; 1e-8 as the axis.
    np.testing.assert_allclose(np.diff(duplex.heights_nm), RISE_A / 10, atol=1e-8)
    assert duplex.spacing_nm == pytest.approx(RISE_A / 10, abs=1e-8)


def test_masses_and_centres(duplex: SimulatedDuplex) -> None:
    masses = duplex.bodies.masses_Da
    # Nucleotides within a chain, formula weights: dA C10H11N5O5P 312.20, dT C10H12N2O7P 303.19,
    # dC C9H11N3O6P 288.18, dG C10H11N5O6P 328.20. Each duplex end lacks one PO2 and has two H more.
    at, cg, end = 312.20 + 303.19, 288.18 + 328.20, 30.97 + 2 * 16.00 - 2 * 1.01
    # Force fields round atomic masses to 0.01 Da or better; 64 atoms, mostly to 0.001.
    np.testing.assert_allclose(masses, [at - end, cg, cg, at, at, at - end], atol=0.05)
    assert masses.sum() == pytest.approx(duplex.masses_Da.sum(), rel=1e-14)
    np.testing.assert_allclose(
        masses @ duplex.bodies.centres_nm,
        duplex.masses_Da @ duplex.positions_nm,
        rtol=1e-12,
        atol=1e-9,
    )


def test_axial_inertia_is_the_kinetic_energy_of_a_turn(duplex: SimulatedDuplex) -> None:
    # Turn every base pair about z (the fibre's axis) at 2 rad/ps: energy I omega²/2.
    velocities = np.cross([0, 0, 2.0], duplex.positions_nm)
    energy = 0.5 * duplex.masses_Da * np.sum(velocities**2, axis=1)
    expected = np.bincount(duplex.pairs, energy) / 2
    np.testing.assert_allclose(duplex.axial_inertia_Da_nm2, expected, rtol=1e-7)  # as the axis
