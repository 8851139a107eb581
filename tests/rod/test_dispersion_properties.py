"""The 6x6 dispersion of any rod against a ring of rigid bodies, its zero modes, its hard cases."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import bend_shear_branches, dispersion, strain_operator
from dnawaves.rod.measured import MassPerLength, measured_rod
from dnawaves.rod.plane_waves import plane_waves
from dnawaves.rod.rod import BEND_1, BEND_2, EXTENSION, SHEAR_1, SHEAR_2, TWIST, Rod, cross_matrix

PAPER = Rod.paper()
TWISTED = Rod.paper(twisted=True)
A = PAPER.spacing_nm
ZONE_EDGE = np.pi / A
TURN = TWISTED.omega0_rad_per_nm[2]
Coordinates = Callable[[np.ndarray, np.ndarray], np.ndarray]


def random_rod(seed: int) -> Rod:
    """A rod with every coupling, a bent and sheared rest state and an offset centre of mass."""
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(6, 6)), rng.normal(size=(3, 3))
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 100 * roots[0] @ roots[0].T,
        inertia_Da_nm=PAPER.inertia_Da_nm + 100 * roots[1] @ roots[1].T,
        gamma0=np.array([0.2, -0.2, 1.0]) * rng.normal(1, 0.2, 3),
        omega0_rad_per_nm=rng.normal(size=3),
        centre_nm=0.1 * rng.normal(size=3),
    )


def screw(six: np.ndarray) -> np.ndarray:
    """Return the rigid motion (4, 4) of a screw (nm, rad)."""
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = cross_matrix(six[3:]), six[:3]
    return scipy.linalg.expm(generator)


def excess_screw(step: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return the screw that a step is in excess of the step at rest, half @ half."""
    inverse = np.linalg.inv(half)
    logarithm = scipy.linalg.logm(inverse @ step @ inverse).real
    x, y, z = logarithm[[2, 0, 1], [1, 2, 0]]
    return np.array([*logarithm[:3, 3], x, y, z])


def mid_step(step: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return displacement and rotation vector of a step, seen in its mid-frame."""
    rotation = Rotation.from_matrix(step[:3, :3]).as_rotvec()
    return np.concatenate([Rotation.from_rotvec(-rotation / 2).apply(step[:3, 3]), rotation])


def ring_frequencies(
    rod: Rod, pairs: int, step_stiffness: np.ndarray, coordinates: Coordinates
) -> np.ndarray:
    """Return the normal modes of a closed chain of rigid bodies whose links are all alike.

    The energy of a link is half of its coordinates (less those at rest) . stiffness . the same;
    their derivatives by the bodies' motion are taken numerically.
    """
    half = screw(A / 2 * np.concatenate([rod.gamma0, rod.omega0_rad_per_nm]))
    h = 1e-5

    def link(moves: np.ndarray) -> np.ndarray:
        step = np.linalg.inv(screw(moves[:6])) @ half @ half @ screw(moves[6:])
        return coordinates(step, half)

    slopes = np.array([(link(h * e) - link(-h * e)) / (2 * h) for e in np.eye(12)]).T
    stiffness = np.zeros((6 * pairs, 6 * pairs))
    for pair in range(pairs):
        ends = np.concatenate([6 * pair + np.arange(6), 6 * ((pair + 1) % pairs) + np.arange(6)])
        stiffness[np.ix_(ends, ends)] += slopes.T @ step_stiffness @ slopes
    # the mass of a body from its centre of mass, in the velocity of its origin: v - c x w
    to_centre = np.block([[np.eye(3), -cross_matrix(rod.centre_nm)], [np.zeros((3, 3)), np.eye(3)]])
    body = scipy.linalg.block_diag(rod.density_Da_per_nm * np.eye(3), rod.inertia_Da_nm)
    mass = np.kron(np.eye(pairs), A * to_centre.T @ body @ to_centre)
    return np.sqrt(np.maximum(scipy.linalg.eigvalsh(stiffness, mass), 0))


@pytest.mark.parametrize("pairs", [2, 7])
@pytest.mark.parametrize("seed", range(3))
def test_the_lattice_of_a_random_rod_has_the_normal_modes_of_a_ring(seed: int, pairs: int) -> None:
    rod = random_rod(seed)
    ring = ring_frequencies(rod, pairs, rod.stiffness / A, excess_screw)
    k = 2 * np.pi * np.arange(pairs) / (pairs * A)
    waves = np.sort(dispersion(rod, k, lattice=True).ravel())
    # squares to 1e-9 of the highest: numerical derivatives 1e-10, round-off of the square 1e-14
    assert ring**2 == pytest.approx(waves**2, abs=1e-9 * waves[-1] ** 2)


def test_steps_measured_as_rotation_vectors_make_the_ring_that_was_measured() -> None:
    rng = np.random.default_rng(8)
    root = rng.normal(size=(6, 6))
    step_stiffness = (PAPER.stiffness + 20 * root @ root.T) / A
    rest = A * np.array([0.05, -0.1, 1.0, 0.2, 0.3, 1.8])
    half = screw(rest / 2)
    mass = MassPerLength(PAPER.density_Da_per_nm, np.array([0.1, 0.02, 0]), PAPER.inertia_Da_nm)
    rod = measured_rod(step_stiffness, mid_step(half @ half, half), mass, A)
    ring = ring_frequencies(rod, 7, step_stiffness, mid_step)
    waves = np.sort(dispersion(rod, 2 * np.pi * np.arange(7) / (7 * A), lattice=True).ravel())
    # as above
    assert ring**2 == pytest.approx(waves**2, abs=1e-9 * waves[-1] ** 2)
    # taken for the lattice's own strain, the same numbers are off by per cents
    naive = replace(rod, stiffness=step_stiffness * A)
    off = np.sort(dispersion(naive, 2 * np.pi * np.arange(7) / (7 * A), lattice=True).ravel())
    assert np.abs(off[6:] / ring[6:] - 1).max() > 0.01


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), k=st.floats(-9.0, 9.0), lattice=st.booleans())
def test_the_strain_operator_has_double_roots_at_zero_and_at_plus_and_minus_one_turn(
    seed: int, k: float, lattice: bool
) -> None:
    rod = random_rod(seed)
    turn = np.linalg.norm(rod.omega0_rad_per_nm)
    factors = np.array([k, k + turn, k - turn])
    if lattice:
        factors = 2 / A * np.sin(factors * A / 2)
    determinant = np.linalg.det(strain_operator(rod, [k], lattice=lattice)[0])
    # round-off relative to the sixth power of the operator's size
    size = np.abs(strain_operator(rod, [k], lattice=lattice)).max() * 3
    assert determinant == pytest.approx(-(np.prod(factors) ** 2), abs=1e-14 * size**6)


@pytest.mark.parametrize("lattice", [False, True])
def test_zero_modes_of_any_rod(lattice: bool) -> None:
    rod = random_rod(5)
    turn = np.linalg.norm(rod.omega0_rad_per_nm)
    frequencies = dispersion(rod, [0.0, turn, -turn, turn / 2], lattice=lattice)
    # round-off of singular values; the next ones are above 0.01 rad/ps
    assert list((frequencies < 1e-12).sum(axis=1)) == [2, 1, 1, 0]
    assert np.sort(frequencies.ravel())[4] > 0.01
    straight = replace(rod, omega0_rad_per_nm=np.zeros(3))
    assert (dispersion(straight, [0.0], lattice=lattice) < 1e-12).sum() == 4


@pytest.mark.parametrize("lattice", [False, True])
def test_an_isotropic_rod_is_the_same_seen_from_the_laboratory_to_round_off(lattice: bool) -> None:
    k = np.linspace(-ZONE_EDGE, ZONE_EDGE, 101)
    shifted = [bend_shear_branches(PAPER, k + s, lattice=lattice) for s in (TURN, -TURN)]
    speeds = np.sqrt(
        [
            PAPER.stiffness[EXTENSION, EXTENSION] / PAPER.density_Da_per_nm,
            PAPER.stiffness[TWIST, TWIST] / PAPER.inertia_Da_nm[2, 2],
        ]
    )
    size = 2 / A * np.abs(np.sin(k * A / 2)) if lattice else np.abs(k)
    expected = np.sort(np.concatenate([np.outer(size, speeds), *shifted], axis=1), axis=1)
    twisted = dispersion(TWISTED, k, lattice=lattice)
    # the reference's 4e-15, relative to the highest frequency, is some 20 units of round-off
    assert np.abs(twisted - expected).max() < 5e-15 * expected.max()


def test_a_rod_without_rise_has_uncoupled_shear_and_bend() -> None:
    q = np.linspace(0.0, ZONE_EDGE, 21)
    shear = q * np.sqrt(PAPER.stiffness[SHEAR_1, SHEAR_1] / PAPER.density_Da_per_nm)
    bend = q * np.sqrt(PAPER.stiffness[BEND_1, BEND_1] / PAPER.inertia_Da_nm[0, 0])
    for stretch in (1e-9, 0.0):
        flat = replace(PAPER, gamma0=np.array([0.0, 0.0, stretch]))
        # coupling stretch * sqrt(C/I) = 1.4e-9 rad/ps
        assert bend_shear_branches(flat, q, lattice=False) == pytest.approx(
            np.stack([shear, bend], axis=1), abs=2e-9
        )
        six = dispersion(flat, q, lattice=False)
        assert six[:, 0] == pytest.approx(shear, abs=2e-9)
        waves = plane_waves(flat, [q[0], q[10]], lattice=False)
        assert np.isfinite(waves.group_velocities_A_per_ps).all()


@pytest.mark.parametrize("lattice", [False, True])
def test_a_rod_100_times_stiffer_in_shear_bends_as_euler_and_rayleigh_have_it(
    lattice: bool,
) -> None:
    stiffness = PAPER.stiffness.copy()
    stiffness[[SHEAR_1, SHEAR_2], [SHEAR_1, SHEAR_2]] *= 100
    stiff = replace(PAPER, stiffness=stiffness)
    q = np.linspace(0.05, 0.3, 6)
    closed = bend_shear_branches(stiff, q, lattice=lattice)
    six = dispersion(stiff, q, lattice=lattice)
    # round-off relative to the highest frequency, now 14 rad/ps at the cut-off
    assert six[:, 0] == pytest.approx(closed[:, 0], abs=1e-13)
    assert six[:, -1] == pytest.approx(closed[:, 1], rel=1e-13)
    inertia, density = stiff.inertia_Da_nm[0, 0], stiff.density_Da_per_nm
    rayleigh = q**2 * np.sqrt(
        stiff.stiffness[BEND_1, BEND_1] / (density + inertia * q**2) / stiff.gamma0[2] ** 2
    )
    # shear softens by (D/C) q^2/2 = 1.5e-4 at 0.3/nm; the lattice by (qa)^2/12 < 1e-3
    assert closed[:, 0] == pytest.approx(rayleigh, rel=2e-3 if lattice else 3e-4)


def coupled_to(one_minus_r: float) -> Rod:
    """The paper's rod with extension and twist coupled to the limit of stability."""
    stiffness = PAPER.stiffness.copy()
    # equal diagonals in the rod's own units: condition number 2/(1 - r)
    stiffness[TWIST, TWIST] = stiffness[EXTENSION, EXTENSION]
    coupling = stiffness[TWIST, TWIST] * (1 - one_minus_r)
    stiffness[EXTENSION, TWIST] = stiffness[TWIST, EXTENSION] = coupling
    return replace(PAPER, stiffness=stiffness)


def test_a_stiffness_of_condition_number_1e12_works() -> None:
    rod = coupled_to(2e-12)
    assert np.linalg.cond(rod.stiffness[2::3, 2::3]) == pytest.approx(1e12, rel=1e-3)
    k = 0.7
    extension, coupling, twist = (
        Fraction(float(rod.stiffness[i, j])) for i, j in ((2, 2), (2, 5), (5, 5))
    )
    density, inertia = rod.density_Da_per_nm, rod.inertia_Da_nm[2, 2]
    # det and trace of M^-1 K, the determinant of the stored numbers without round-off
    determinant = float(extension * twist - coupling**2) / (density * inertia)
    trace = float(extension) / density + float(twist) / inertia
    fast = np.sqrt((trace + np.sqrt(trace**2 - 4 * determinant)) / 2)
    slow = np.sqrt(determinant) / fast
    frequencies = dispersion(rod, [k], lattice=False)[0]
    bends = bend_shear_branches(PAPER, k, lattice=False)
    # the squared slow speed carries eps * condition = 2e-4
    assert frequencies[0] == pytest.approx(k * slow, rel=2e-4)
    # others: round-off
    assert frequencies[1:] == pytest.approx(np.sort([*bends, *bends, k * fast]), rel=1e-12)
    waves = plane_waves(rod, [k], lattice=True)
    assert np.isfinite(waves.strain_shares()).all()


def test_a_stiffness_that_is_singular_to_round_off_fails_clearly() -> None:
    with pytest.raises(InputError, match=r"stiffness is not positive definite.*round-off"):
        coupled_to(2e-16)


def test_units_alone_do_not_make_a_stiffness_singular() -> None:
    # twist stiffness 1e-16 of the others, uncoupled: far from round-off in units of its own
    stiffness = PAPER.stiffness.copy()
    stiffness[TWIST, TWIST] *= 1e-16
    slow = dispersion(replace(PAPER, stiffness=stiffness), [1.0], lattice=False)[0, 0]
    # an uncoupled column of the operator: its singular value is exact
    assert slow == pytest.approx(1e-8 * 0.50555, rel=1e-4)


@pytest.mark.parametrize("edge", [ZONE_EDGE, -ZONE_EDGE])
def test_at_the_zone_edge_neighbours_move_against_each_other(edge: float) -> None:
    waves = plane_waves(PAPER, [edge], lattice=True)
    bends = bend_shear_branches(PAPER, [edge], lattice=True)[0]
    extension = 2 / A * np.sqrt(PAPER.stiffness[2, 2] / PAPER.density_Da_per_nm)
    twist = 2 / A * np.sqrt(PAPER.stiffness[5, 5] / PAPER.inertia_Da_nm[2, 2])
    assert waves.frequencies_rad_per_ps[0] == pytest.approx(
        np.sort([*bends, *bends, extension, twist]), rel=1e-13
    )
    # all slopes vanish there by symmetry; round-off relative to 8 A/ps
    assert np.abs(waves.group_velocities_A_per_ps).max() < 1e-12


def test_long_bends_of_an_anisotropic_lattice_see_the_harmonic_mean_too() -> None:
    stiffness = PAPER.stiffness.copy()
    stiffness[BEND_1, BEND_1] *= 3
    stiffness[BEND_2, BEND_2] *= 0.5
    rod = replace(PAPER, stiffness=stiffness, omega0_rad_per_nm=np.array([0, 0, TURN]))
    q = 0.01
    bend = dispersion(rod, [TURN + q], lattice=True)[0, 0]
    effective = 2 / (1 / stiffness[BEND_1, BEND_1] + 1 / stiffness[BEND_2, BEND_2])
    # corrections of order (q/turn)^2 = 3e-5 and (q gyration radius)^2 = 1e-5
    assert bend == pytest.approx(q**2 * np.sqrt(effective / rod.density_Da_per_nm), rel=1e-3)
