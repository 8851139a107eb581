"""Strains of steps: their linearisation, the rod's lattice, and what CEHS angles are instead."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from dnawaves.frames.fit import Frames
from dnawaves.frames.inverse import pairs_from_steps
from dnawaves.frames.parameters import step_parameters
from dnawaves.frames.strain import (
    in_own_frames,
    linear_strains,
    step_strains,
    strain_deviations,
    strain_jacobian,
)
from dnawaves.rod.dispersion import dispersion, strain_operator
from dnawaves.rod.measured import MassPerLength, measured_rod, mid_frame_jacobian
from dnawaves.rod.rod import Rod, cross_matrix

TWIST_RAD = np.radians(36.0)
# The half angle over its sine: 1.01664 at 36 degrees, its inverse 0.984, its square 1.034.
FACTOR = (TWIST_RAD / 2) / np.sin(TWIST_RAD / 2)


def frames(origins: np.ndarray, rotations: Rotation) -> Frames:
    """Return frames over (pairs,) from origins (pairs, 3)."""
    return Frames(origins.T, rotations.as_matrix().transpose(2, 1, 0))


def moved(origins: np.ndarray, rotations: Rotation, displacements: np.ndarray) -> Frames:
    """Move pairs by displacements (6, pairs) in their own frames."""
    return frames(
        origins + rotations.apply(displacements[:3].T),
        rotations * Rotation.from_rotvec(displacements[3:].T),
    )


def test_strains_are_scipys_logarithm_and_half_way_frame() -> None:
    random = np.random.default_rng(1)
    origins, rotations = random.normal(size=(50, 3)), Rotation.random(50, rng=random)
    found = step_strains(frames(origins, rotations))
    omega = (rotations[:-1].inv() * rotations[1:]).as_rotvec()
    middle = rotations[:-1] * Rotation.from_rotvec(omega / 2)
    np.testing.assert_allclose(found.values[3:].T, omega, atol=1e-13)
    gamma = middle.inv().apply(np.diff(origins, axis=0))
    np.testing.assert_allclose(found.values[:3].T, gamma, atol=1e-13)
    np.testing.assert_allclose(found.middle.axes.transpose(2, 1, 0), middle.as_matrix(), atol=1e-13)


def test_a_rigid_motion_strains_nothing() -> None:
    random = np.random.default_rng(2)
    pairs = pairs_from_steps(random.normal([0, 0, 3.4, 0, 2, 35], 4, size=(9, 6)).T)
    reference = Frames(pairs.origin, pairs.axes)
    turn = Rotation.from_rotvec([1.0, -2.0, 0.5]).as_matrix()
    carried = Frames(
        (turn @ pairs.origin + np.array([[100.0], [-50], [20]]))[..., np.newaxis],
        np.einsum("ij,ajp->aip", turn, pairs.axes)[..., np.newaxis],
    )
    # Coordinates of 100 Å round at 1e-14.
    np.testing.assert_allclose(strain_deviations(carried, reference), 0, atol=1e-12)


def test_from_the_other_strand_the_first_components_change_sign() -> None:
    pairs = pairs_from_steps(np.array([[0.4, -0.6, 3.3, 2.5, -4.0, 33.0]]).T)
    x, y, z = pairs.axes
    other = Frames(pairs.origin[:, ::-1], np.stack([x, -y, -z])[..., ::-1])
    expected = step_strains(pairs).values[:, 0] * [-1, 1, 1, -1, 1, 1]
    np.testing.assert_allclose(step_strains(other).values[:, 0], expected, atol=1e-13)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6), st.floats(0, 2.5))
def test_jacobian_is_the_derivative(seed: int, largest_angle: float) -> None:
    random = np.random.default_rng(seed)
    origins = random.normal(scale=2, size=(4, 3))
    rotations = [Rotation.identity()]
    for _ in range(3):
        axis = random.normal(size=3)
        step = Rotation.from_rotvec(largest_angle * axis / np.linalg.norm(axis))
        rotations.append(rotations[-1] * step)
    turned = Rotation.concatenate(rotations)
    direction = random.normal(size=(6, 4))
    jacobian = strain_jacobian(step_strains(frames(origins, turned)).values)

    def strains(length: float) -> np.ndarray:
        return step_strains(moved(origins, turned, length * direction)).values

    h = 2e-3
    derivative = sum(
        weight * (strains(n * h) - strains(-n * h)) / h
        for n, weight in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    )
    # Sixth-order difference: (2e-3 |x|)^6, 1e-13 for |x| = 3, and round-off 1e-14 Å/h.
    np.testing.assert_allclose(linear_strains(jacobian, direction), derivative, atol=5e-11)


def test_jacobian_about_a_step_without_rotation() -> None:
    jacobian = strain_jacobian(np.array([0.3, -0.2, 3.4, 0, 0, 0]))
    lever = cross_matrix([0.3, -0.2, 3.4]) / 2
    none, one = np.zeros((3, 3)), np.eye(3)
    # Each pair turns the mid-frame by half its own rotation.
    expected = np.block([[-one, lever, one, lever], [none, -one, none, one]])
    np.testing.assert_array_equal(jacobian, expected)
    nearly = strain_jacobian(np.array([0.3, -0.2, 3.4, 1e-9, 0, -2e-9]))
    # The derivative of the Jacobian by the angle is of order Γ.
    np.testing.assert_allclose(nearly, expected, atol=1e-8)


def test_displacements_of_the_laboratory() -> None:
    random = np.random.default_rng(4)
    origins, rotations = random.normal(size=(5, 3)), Rotation.random(5, rng=random)
    displacements = 1e-5 * random.normal(size=(6, 5, 1))
    pairs = frames(origins, rotations)
    after = frames(
        origins + displacements[:3, :, 0].T,
        Rotation.from_rotvec(displacements[3:, :, 0].T) * rotations,
    )
    jacobian = strain_jacobian(step_strains(pairs).values)
    found = linear_strains(jacobian, in_own_frames(displacements, pairs))
    exact = step_strains(after).values - step_strains(pairs).values
    # Second order in 1e-5, with second derivatives of up to ten.
    np.testing.assert_allclose(found[..., 0], exact, atol=2e-9)


def rod_of(gamma0: np.ndarray, omega0: np.ndarray) -> Rod:
    return Rod(1.0, np.eye(3), np.eye(6), 0.34, gamma0, omega0)


def strains_at_rest(rod: Rod) -> np.ndarray:
    """Return Γ (nm) and Ω (rad) (6,) of one step of a uniform rod: lengths in nm here."""
    generator = np.zeros((4, 4))
    generator[:3, :3] = cross_matrix(rod.omega0_rad_per_nm)
    generator[:3, 3] = rod.gamma0
    step = scipy.linalg.expm(rod.spacing_nm * generator)
    origins = np.stack([np.zeros(3), step[:3, 3]])
    rotations = Rotation.from_matrix(np.stack([np.eye(3), step[:3, :3]]))
    return step_strains(frames(origins, rotations)).values[:, 0]


def plane_waves(jacobian: np.ndarray, phases: np.ndarray) -> np.ndarray:
    """Return the strains (k, 6, 6) of waves with these phases per step, seen half-way."""
    half = np.exp(0.5j * phases)[:, np.newaxis, np.newaxis]
    return jacobian[:, :6] / half + jacobian[:, 6:] * half


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6))
def test_strains_of_waves_follow_from_those_of_the_rods_lattice(seed: int) -> None:
    random = np.random.default_rng(seed)
    rod = rod_of(random.normal(size=3), 2 * random.normal(size=3))
    rest = strains_at_rest(rod)
    k = np.array([0.0, 0.7, 3.0, 9.0])
    found = plane_waves(strain_jacobian(rest), k * rod.spacing_nm)
    # (2/a) sinh(a (ik + A)/2), for the whole step.
    lattice = rod.spacing_nm * strain_operator(rod, k, lattice=True)
    # Round-off of a matrix exponential and some products.
    np.testing.assert_allclose(found, mid_frame_jacobian(rest) @ lattice, atol=1e-13)


def test_without_twist_strains_of_rotation_are_those_of_the_rods_lattice() -> None:
    rod = rod_of(np.array([0.0, 0.2, 1.0]), np.zeros(3))
    k = np.array([0.0, 0.7, 3.0, 9.0])
    found = plane_waves(strain_jacobian(strains_at_rest(rod)), k * rod.spacing_nm)
    lattice = rod.spacing_nm * strain_operator(rod, k, lattice=True)
    np.testing.assert_allclose(found, lattice, atol=1e-15)


def test_waves_of_a_measured_rod_are_those_of_the_chain_of_its_steps() -> None:
    """One chain in two coordinates: the strains of steps, and the lattice of the rod."""
    paper = Rod.paper(twisted=True)
    rest = strains_at_rest(paper)
    stiffness = paper.stiffness / paper.spacing_nm
    mass = MassPerLength(paper.density_Da_per_nm, np.zeros(3), paper.inertia_Da_nm)
    k = np.linspace(0.1, 9.0, 20)
    strains = plane_waves(strain_jacobian(rest), k * paper.spacing_nm)
    dynamical = strains.conj().swapaxes(1, 2) @ stiffness @ strains / paper.spacing_nm
    squared = [scipy.linalg.eigh(matrix, paper.mass, eigvals_only=True) for matrix in dynamical]
    measured = measured_rod(stiffness, rest, mass, paper.spacing_nm)
    exact = dispersion(measured, k, lattice=True) ** 2
    # Round-off of the eigensolver, relative to the highest frequency squared.
    np.testing.assert_allclose(squared, exact, atol=1e-12 * np.max(squared))
    # The same constants taken for those of the lattice are another chain, by some percent.
    naive = dispersion(paper, k, lattice=True) ** 2
    assert np.max(np.abs(naive / exact - 1)) > 0.02


def test_cehs_tilt_and_roll_are_smaller_by_the_half_angle_over_its_sine() -> None:
    small = 1e-4
    for index in (3, 4):
        values = np.array([0.0, 0, 3.4, 0, 0, 36.0])
        values[index] = small
        omega = step_strains(pairs_from_steps(values[:, np.newaxis])).values[3:, 0]
        # Third order in an angle of 1e-4 degrees.
        assert np.degrees(omega[index - 3]) / small == pytest.approx(FACTOR, rel=1e-8)
        assert np.degrees(omega[2]) == pytest.approx(36, abs=1e-8)
    assert pytest.approx(1 / FACTOR, abs=5e-4) == 0.984


def test_about_a_straight_stack_the_strains_of_the_rods_lattice_are_cehs() -> None:
    random = np.random.default_rng(9)
    rest = np.array([0, 0, 3.4, 0, 0, TWIST_RAD])
    small = 1e-5 * random.normal(size=6)
    values = rest + small
    values[3:] = np.degrees(values[3:])
    strains = step_strains(pairs_from_steps(values[:, np.newaxis])).values[:, 0] - rest
    # Second order in 1e-5.
    np.testing.assert_allclose(np.linalg.solve(mid_frame_jacobian(rest), strains), small, atol=1e-9)


def test_bend_constants_from_cehs_angles_are_stiffer_by_3_4_percent() -> None:
    random = np.random.default_rng(6)
    values = np.zeros((6, 2000)) + np.array([[0.0], [0], [3.4], [0], [0], [36]])
    values[3:5] += random.normal(scale=1e-3, size=(2, 2000))
    pairs = pairs_from_steps(values[:, np.newaxis])
    cehs = np.radians(step_parameters(pairs).values[3:5, 0])
    vector = step_strains(pairs).values[3:5, 0]
    stiffer = np.linalg.inv(np.cov(cehs)) @ np.cov(vector)
    # The same samples in both: only the curvature of the map remains, (1e-3 deg)^2.
    np.testing.assert_allclose(stiffer, FACTOR**2 * np.eye(2), atol=1e-6)
    assert pytest.approx(1.034, abs=5e-4) == FACTOR**2


def test_cehs_bend_is_the_angle_by_which_the_axis_bends() -> None:
    """A planar bend of 1 degree a step, laid on 36 degrees of twist."""
    steps, bend_deg = 30, 1.0
    number = np.arange(steps + 1)
    bent = Rotation.from_rotvec(np.outer(number, [bend_deg, 0, 0]), degrees=True)
    twist = Rotation.from_rotvec(np.outer(number, [0, 0, 36.0]), degrees=True)
    pairs = frames(np.zeros((steps + 1, 3)), bent * twist)
    tilt, roll = step_parameters(pairs).values[3:5]
    np.testing.assert_allclose(np.hypot(tilt, roll), bend_deg, atol=1e-12)
    straight = np.array([0, 0, 0, 0, 0, TWIST_RAD])
    deviation = np.degrees(step_strains(pairs).values[3:] - straight[3:, np.newaxis])
    # First order in the bend of 0.017 rad; the twist takes up the second.
    across = np.hypot(deviation[0], deviation[1])
    np.testing.assert_allclose(across, FACTOR * bend_deg, rtol=2e-4)
    # The strain of the rod's lattice is this bend too.
    lattice = np.linalg.solve(mid_frame_jacobian(straight)[3:, 3:], deviation)
    np.testing.assert_allclose(np.hypot(lattice[0], lattice[1]), bend_deg, rtol=2e-4)
