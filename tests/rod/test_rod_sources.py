"""Rods from a user's constants, from measured steps and from atoms."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
from openmm import unit
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames, fit_frames
from dnawaves.frames.parameters import pair_parameters
from dnawaves.frames.standard import standard_ring
from dnawaves.rod.constants import read_rod, rod_from_constants
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.measured import (
    MassPerLength,
    mass_per_length,
    measured_rod,
    mid_frame_jacobian,
    step_stiffness_from_pN_A,
)
from dnawaves.rod.rod import EXTENSION, Rod, cross_matrix
from dnawaves.system.duplex import SimulatedDuplex

PAPER = Rod.paper(twisted=True)
# Da/nm and Da nm: 3.22e-15 kg/m and 4.03e-34 kg m over 1.66054e-27 kg
CONSTANTS = {
    "density_Da_per_nm": 1939.13,
    "inertia_Da_nm": [242.692, 242.692, 485.384],
    "shear_pN": 816,
    "extension_pN": 2160,
    "bend_pN_nm2": 270,
    "twist_pN_nm2": 206,
    "spacing_A": 3.4,
    "omega0_rad_per_nm": [0, 0, 1.76],
}
KG_M_PER_DA_NM = 1.66053906660e-36
MASS_DA = {"C": 12.011, "N": 14.007, "O": 15.999, "P": 30.974}


def test_the_papers_constants_in_the_units_of_the_literature_give_the_papers_rod(
    tmp_path: Path,
) -> None:
    path = tmp_path / "rod.yaml"
    path.write_text("\n".join(f"{name}: {value}" for name, value in CONSTANTS.items()))
    k = np.linspace(-9, 9, 7)
    # the constants above are rounded to 6 digits
    assert dispersion(read_rod(path), k, lattice=True) == pytest.approx(
        dispersion(PAPER, k, lattice=True), rel=3e-6
    )


def test_a_stiffness_matrix_stands_for_the_four_stiffnesses_and_adds_couplings() -> None:
    matrix = np.diag([816.0, 816, 2160, 270, 270, 206])
    matrix[2, 5] = matrix[5, 2] = -90
    few = {name: CONSTANTS[name] for name in ("density_Da_per_nm", "inertia_Da_nm", "spacing_A")}
    rod = rod_from_constants({**few, "stiffness": matrix.tolist(), "twist_deg_per_bp": 36})
    # -90 pN nm is -90/1.66054 kJ/mol; the constant is quoted to 6 digits
    assert rod.stiffness[2, 5] == pytest.approx(-90 / 1.66054, rel=1e-5)
    assert rod.stiffness[EXTENSION, EXTENSION] == pytest.approx(2160 / 1.66054, rel=1e-5)
    # 36 degrees over 0.34 nm, exact but for round-off
    assert rod.omega0_rad_per_nm[2] == pytest.approx(np.pi / 5 / 0.34, rel=1e-14)


@pytest.mark.parametrize(
    ("change", "messages"),
    [
        ({"density_Da_per_nm": -1939}, ["density_Da_per_nm", "-1939", "500 to 900 Da a base pair"]),
        ({"density_Da_per_nm": 3.22e-15}, ["found 3.22e-15", "500 to 900 Da a base pair"]),
        ({"inertia_Da_nm": [24269, 24269, 48538]}, ["inertia_Da_nm", "24269", "1.5 to 10 A"]),
        ({"inertia_Da_nm": [243, 243, 500]}, ["243, 243, 500", "sum of the other two"]),
        ({"inertia_Da_nm": [243, 243]}, ["inertia_Da_nm", "three moments"]),
        ({"shear_pN": 8.16e-10}, ["shear_pN", "90 to 3400 pN"]),
        ({"extension_pN": 2.16}, ["extension_pN", "found 2.16", "pN"]),
        ({"bend_pN_nm2": [270, 27000]}, ["bend_pN_nm2", "found 27000", "828 pN nm^2"]),
        ({"spacing_A": 0.34}, ["spacing_A", "found 0.34", "2 to 5 A"]),
        ({"omega0_rad_per_nm": [0, 0, 0.176]}, ["omega0_rad_per_nm", "rad/nm"]),
        ({"omega0_rad_per_nm": None, "twist_deg_per_bp": 0.6}, ["found 0.6", "degrees"]),
        ({"twist_deg_per_bp": 36}, ["twist_deg_per_bp and omega0_rad_per_nm", "one of them"]),
        ({"gamma0": [0, 0, 3.4]}, ["gamma0", "0.5 to 1.5"]),
        ({"centre_A": [12, 0, 0]}, ["centre_A", "up to 5 A"]),
        ({"shear_pN": None}, ["found no shear_pN"]),
        ({"stiffness": np.diag([816, 816, 2160, 270, 270, 206]).tolist()}, ["the matrix alone"]),
        ({"stiffness": np.eye(3).tolist()}, ["stiffness", "six rows of six numbers"]),
        ({"poisson_ratio": 0.3}, ["poisson_ratio", "no such constant", "shear_pN"]),
        ({"shear_pN": "stiff"}, ["shear_pN", "'stiff'"]),
    ],
)
def test_slips_in_constants_are_named(change: dict, messages: list[str]) -> None:
    with pytest.raises(InputError) as error:
        rod_from_constants({**CONSTANTS, **change}, "config.yaml")
    for message in ["config.yaml", *messages]:
        assert message in str(error.value)


def test_a_coupling_beyond_what_is_stable_and_a_wrong_diagonal_are_named() -> None:
    few = {name: CONSTANTS[name] for name in ("density_Da_per_nm", "inertia_Da_nm", "spacing_A")}
    matrix = np.diag([816.0, 816, 2160, 270, 270, 206])
    matrix[2, 5] = matrix[5, 2] = 1.01 * np.sqrt(2160 * 206)
    with pytest.raises(InputError, match="not positive definite"):
        rod_from_constants({**few, "stiffness": matrix.tolist()})
    matrix = np.diag([816.0, 816, 2160, 270, 270, 2.06])
    with pytest.raises(
        InputError, match=r"found 2\.06; allowed: element 6 of the diagonal, 83 to 828"
    ):
        rod_from_constants({**few, "stiffness": matrix.tolist()})


# pN and pN nm^2: shear/slide 354 to 816, stretch 1000 to 2160, bend 155 to 287, twist 206 to 410;
# inertia of the base pairs of 355D and of the paper
PUBLISHED = {
    "extension_pN": [1000, 1087, 2160],
    "shear_pN": [[354, 567], 816],
    "bend_pN_nm2": [[155, 287], 206, 270],
    "twist_pN_nm2": [206, 233, 410],
    "density_Da_per_nm": [1812, 1939],
    "inertia_Da_nm": [[776, 61.4, 819], [242.692, 242.692, 485.384]],
    "spacing_A": [3.4],
    "twist_deg_per_bp": [32.7, 36.0],
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_what_is_published_passes_and_a_power_of_ten_from_it_does_not(name: str) -> None:
    others = {key: CONSTANTS[key] for key in CONSTANTS if key != "omega0_rad_per_nm"}
    for value in PUBLISHED[name]:
        rod_from_constants({**others, name: value})
        for power in (1e-3, 1e-1, 1e1, 1e3):
            with pytest.raises(InputError, match=name):
                rod_from_constants({**others, name: (power * np.array(value)).tolist()})


def test_a_slip_in_one_moment_of_inertia_is_no_body_or_too_small_or_too_wide() -> None:
    for axis, power in ((0, 0.1), (0, 10), (1, 0.1), (2, 0.1), (2, 10)):
        moments = np.array([776, 61.4, 819])
        moments[axis] *= power
        with pytest.raises(InputError, match="inertia_Da_nm"):
            rod_from_constants({**CONSTANTS, "inertia_Da_nm": moments.tolist()})
    # ten times the least is a cylinder's, which cannot be told from a slip
    rod_from_constants({**CONSTANTS, "inertia_Da_nm": [776, 614, 819]})


def test_unusual_constants_are_taken_if_they_are_said_to_be_but_impossible_ones_are_not() -> None:
    # 12.9 nN: a duplex without solvent, stretched before it could relax
    stiff = {**CONSTANTS, "extension_pN": 12900}
    with pytest.raises(InputError, match="unusual: true"):
        rod_from_constants(stiff)
    assert rod_from_constants({**stiff, "unusual": True}).stiffness[2, 2] == pytest.approx(
        12900 / 1.66054, rel=1e-5
    )
    for impossible in ({"inertia_Da_nm": [243, 243, 500]}, {"density_Da_per_nm": -1}):
        with pytest.raises(InputError, match=next(iter(impossible))):
            rod_from_constants({**CONSTANTS, **impossible, "unusual": True})


def test_a_file_that_is_no_rod_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "rod.yaml"
    path.write_text("- 1\n- 2\n")
    with pytest.raises(InputError, match=r"found no mapping; allowed: .*density_Da_per_nm"):
        read_rod(path)
    with pytest.raises(InputError, match="no such file"):
        read_rod(tmp_path / "none.yaml")
    path.write_text("density: [1\n")
    with pytest.raises(InputError, match="cannot be read as YAML"):
        read_rod(path)


def screw(six: np.ndarray) -> np.ndarray:
    """Return the rigid motion (4, 4) of a screw (nm, rad)."""
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = cross_matrix(six[3:]), six[:3]
    return expm(generator)


def mid_step_coordinates(step: np.ndarray) -> np.ndarray:
    """Return displacement and rotation vector of a step (4, 4) in its mid-frame."""
    rotation = Rotation.from_matrix(step[:3, :3]).as_rotvec()
    return np.concatenate([Rotation.from_rotvec(-rotation / 2).apply(step[:3, 3]), rotation])


@pytest.mark.parametrize(
    "rest", [[0.05, -0.1, 0.33, 0.1, 0.2, 0.6], [0.1, 0, 0.34, 0, 0, 0], [0, 0, 0.34, 1, 1, 2]]
)
def test_mid_frame_jacobian_against_numerical_differentiation(rest: list[float]) -> None:
    half = screw(np.array(rest) / 2)
    h = 1e-5
    columns = [
        mid_step_coordinates(half @ screw(h * one) @ half)
        - mid_step_coordinates(half @ screw(-h * one) @ half)
        for one in np.eye(6)
    ]
    step = mid_step_coordinates(half @ half)
    # central differences: h^2 = 1e-10, round-off 1e-16/h = 1e-11
    assert mid_frame_jacobian(step) == pytest.approx(np.array(columns).T / (2 * h), abs=1e-9)


def test_bends_of_a_twisted_step_measured_as_rotation_vectors_look_too_soft() -> None:
    twist = np.radians(36)
    jacobian = mid_frame_jacobian([0, 0, 0.34, 0, 0, twist])
    # the rotation vector is (18 deg)/sin(18 deg) = 1.0166 times the bend seen from the mid-frame
    assert jacobian[3, 3] == pytest.approx(1.0166, abs=5e-5)
    mass = MassPerLength(PAPER.density_Da_per_nm, np.zeros(3), PAPER.inertia_Da_nm)
    rod = measured_rod(np.eye(6), [0, 0, 0.34, 0, 0, twist], mass, 0.34)
    # without it D would come out 1/1.0166^2 - 1 = -3.2 % (and a shear-bend part, (0.34/2 tan 9)^2)
    part = (0.17 * np.tan(twist / 4)) ** 2
    assert rod.stiffness[3, 3] / 0.34 == pytest.approx(1.0166**2 + part, abs=2e-4)


def test_measured_steps_give_the_rod_and_its_intrinsic_screw_back() -> None:
    rng = np.random.default_rng(3)
    root = rng.normal(size=(6, 6))
    xi = np.array([0.05, -0.1, 0.33, 0.1, 0.2, 0.6])
    mass = MassPerLength(1900.0, np.array([0.1, 0.0, 0.02]), np.diag([780.0, 62.0, 820.0]))
    rod = Rod(
        density_Da_per_nm=mass.density_Da_per_nm,
        inertia_Da_nm=mass.inertia_Da_nm,
        stiffness=PAPER.stiffness + 20 * root @ root.T,
        spacing_nm=0.34,
        gamma0=xi[:3] / 0.34,
        omega0_rad_per_nm=xi[3:] / 0.34,
        centre_nm=mass.centre_nm,
    )
    half = screw(xi / 2)
    mean_step = mid_step_coordinates(half @ half)
    inverse = np.linalg.inv(mid_frame_jacobian(mean_step))
    stiffness = inverse.T @ rod.stiffness @ inverse / 0.34
    measured = measured_rod(stiffness, mean_step, mass, 0.34)
    k = np.linspace(-9, 9, 7)
    # round-off relative to the largest frequency
    highest = dispersion(rod, k, lattice=True).max()
    assert dispersion(measured, k, lattice=True) == pytest.approx(
        dispersion(rod, k, lattice=True), abs=1e-12 * highest
    )
    assert measured.gamma0 == pytest.approx(rod.gamma0, abs=1e-13)


def test_step_stiffness_in_piconewton_and_angstrom() -> None:
    # 1 pN/A = 10 pN/nm = 10/1.66054 kJ/mol/nm^2; 1 pN = 1/1.66054 kJ/mol/nm; 1 pN A = 0.1 pN nm
    converted = step_stiffness_from_pN_A(np.ones((6, 6)))
    assert converted[0, 0] == pytest.approx(10 / 1.66054, rel=1e-5)
    assert converted[0, 3] == pytest.approx(1 / 1.66054, rel=1e-5)
    assert converted[3, 3] == pytest.approx(0.1 / 1.66054, rel=1e-5)


def frames_of_pairs(
    pairs: list[tuple[str, dict[str, np.ndarray], str, dict[str, np.ndarray]]],
) -> tuple[np.ndarray, np.ndarray]:
    """Return origins (pairs, 3) in A and axes (pairs, axis, component).

    A pair is the letter and the atoms by name of its base in strand I and in strand II.
    """

    def fitted(letter: str, atoms: dict[str, np.ndarray]) -> Frames:
        ring = standard_ring(letter)
        return fit_frames(np.array(list(ring.values())), np.array([atoms[name] for name in ring]).T)

    strands = [[fitted(*pair[i : i + 2]) for pair in pairs] for i in (0, 2)]
    first, second = (
        Frames(*(np.stack(part, axis=-1) for part in zip(*strand, strict=True)))
        for strand in strands
    )
    middle = pair_parameters(first, second).middle
    return middle.origin.T, middle.axes.transpose(2, 0, 1)


def test_inertia_of_the_base_pairs_of_a_crystal_structure(shared: Path) -> None:
    folder = shared / "reference/helical/dickerson_355d"
    universe = MDAnalysis.Universe(str(folder / "structure.pdb"))
    with (folder / "pairs.csv").open() as file:
        rows = list(csv.DictReader(file))
    residues = [
        [
            universe.select_atoms(f"chainID {row[f'chain{i}']} and resid {row[f'resid{i}']}")
            for i in "12"
        ]
        for row in rows
    ]
    pair_of_atom = np.full(len(universe.atoms), -1)
    for index, pair in enumerate(residues):
        for residue in pair:
            pair_of_atom[residue.indices] = index
    places = [dict(zip(r.names, r.positions, strict=True)) for pair in residues for r in pair]
    letters = [row[f"base{i}"] for row in rows for i in "12"]
    origins, axes = frames_of_pairs(
        [(letters[i], places[i], letters[i + 1], places[i + 1]) for i in range(0, 24, 2)]
    )
    masses = np.array([MASS_DA.get(name[0], 0.0) for name in universe.atoms.names])
    positions = universe.atoms.positions.astype(float) / 10

    def inertia(pairs: list[int]) -> np.ndarray:
        mass = mass_per_length(positions, masses, pair_of_atom, origins / 10, axes, 0.34, pairs)
        return mass.inertia_Da_nm * KG_M_PER_DA_NM * 1e34

    interior = range(2, 10)
    principal = np.mean([np.linalg.eigvalsh(inertia([pair])) for pair in interior], axis=0)
    # the reference, rounded to three digits, is the mean of the pairs' principal values without
    # hydrogens, which this structure lacks, over 3.4 A
    assert principal == pytest.approx([1.02, 12.9, 13.6], abs=0.05)
    # the mean pair: its long axis tips about d1 by half the propeller, so that the moment about d2
    # itself is larger than the principal one
    mean = inertia(list(interior))
    assert np.linalg.eigvalsh(mean)[0] < np.diag(mean)[1] - 0.2
    assert np.argmin(np.diag(mean)) == 1


def test_mass_inertia_and_centre_of_the_built_duplex(
    as_built: Callable[..., SimulatedDuplex],
) -> None:
    duplex = as_built("CGCGAATTCGCG")
    chains = list(duplex.topology.chains())[:2]
    masses = np.array(
        [atom.element.mass.value_in_unit(unit.dalton) for atom in duplex.topology.atoms()]
    )
    strands = [list(chain.residues()) for chain in chains]
    pair_of_atom = np.full(len(masses), -1)
    pairs = []
    for index, residues in enumerate(zip(strands[0], strands[1][::-1], strict=True)):
        entry: list = []
        for residue in residues:
            indices = [atom.index for atom in residue.atoms()]
            pair_of_atom[indices] = index
            entry += [
                residue.name[1],
                {atom.name: 10 * duplex.positions_nm[atom.index] for atom in residue.atoms()},
            ]
        pairs.append(tuple(entry))
    origins, axes = frames_of_pairs(pairs)
    mass = mass_per_length(
        duplex.positions_nm, masses, pair_of_atom, origins / 10, axes, 0.34, range(2, 10)
    )
    # ~616 Da a base pair without ions
    assert mass.density_Da_per_nm * 0.34 == pytest.approx(616, abs=0.5)
    # 1.1 to 1.2 A from the frame's origin, towards the minor groove
    assert 0.11 < np.linalg.norm(mass.centre_nm) < 0.12
    assert mass.centre_nm[0] == pytest.approx(-np.linalg.norm(mass.centre_nm), rel=1e-4)
    # near those of 355D, (1.02, 12.9, 13.6), which has no hydrogens (+4 %) and another propeller
    principal = np.linalg.eigvalsh(mass.inertia_Da_nm) * KG_M_PER_DA_NM * 1e34
    assert principal == pytest.approx([1.02, 12.9, 13.6], rel=0.1)
    rod = replace(
        PAPER,
        density_Da_per_nm=mass.density_Da_per_nm,
        inertia_Da_nm=mass.inertia_Da_nm,
        centre_nm=mass.centre_nm,
    )
    # the kinetic energy of a random motion of the frames, atom by atom
    six = np.random.default_rng(4).normal(size=6)
    energy = 0.0
    for pair in range(2, 10):
        mine = pair_of_atom == pair
        arms = (duplex.positions_nm[mine] - origins[pair] / 10) @ axes[pair].T
        velocity = six[:3] + np.cross(six[3:], arms)
        energy += float(masses[mine] @ (velocity**2).sum(axis=1)) / 2
    # sums of some 500 atoms, round-off
    assert six @ rod.mass @ six / 2 == pytest.approx(energy / (8 * 0.34), rel=1e-12)


def test_a_base_pair_without_atoms_is_named() -> None:
    with pytest.raises(InputError, match="base pair 1"):
        mass_per_length(
            np.eye(3), np.ones(3), np.zeros(3, int), np.zeros((2, 3)), [np.eye(3)] * 2, 0.34
        )
