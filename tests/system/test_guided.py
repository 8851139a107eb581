"""A guided end: its forces and Hessian as derivatives, and constants known beforehand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.spatial.transform import Rotation

from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.guided import (
    LOCKS,
    STATIC_WAVES,
    GuidedEnd,
    first_estimates_A_per_ps,
    line_density,
    linear_response,
    speed_A_per_ps,
)
from dnawaves.system.hessian import ReferenceForces

Array = NDArray[np.float64]
SEQUENCE = "ACGTTACG"
PAIRS = len(SEQUENCE)
RISE_A = 3.375
# kJ/mol/nm² and kJ/mol/rad²: those of B-DNA's steps in order of magnitude.
STRETCH, TWIST = 2e4, 300.0


@pytest.fixture(scope="module")
def duplex(as_built: Callable[..., SimulatedDuplex]) -> SimulatedDuplex:
    return as_built(SEQUENCE)


def turns(duplex: SimulatedDuplex) -> Array:
    """Return the atoms' velocities when all turn about the helix axis at 1 rad/ps."""
    return np.cross(duplex.frame.axis, duplex.positions_nm - duplex.frame.origin_nm)


@pytest.fixture(scope="module")
def rigid_pair_chain(duplex: SimulatedDuplex) -> Array:
    """Return the Hessian of base pairs that can only slide along and turn about the axis.

    Neighbours are joined by springs between their slides and between their turns; every other
    motion of the atoms, in the metric of the masses, costs 1e4 /ps².
    """
    atoms = len(duplex.masses_Da)
    weights = np.repeat(duplex.masses_Da, 3)
    hessian = 1e4 * np.diag(weights)
    slide = np.broadcast_to(duplex.frame.axis, (atoms, 3))
    for motion, stiffness in ((slide, STRETCH), (turns(duplex), TWIST)):
        coordinates = []
        for pair in range(PAIRS):
            shape = np.where(duplex.pairs[:, None] == pair, motion, 0.0).ravel()
            # The coordinate that belongs to this motion and is blind to all orthogonal ones.
            momentum = weights * shape
            coordinates.append(momentum / (shape @ momentum))
            hessian -= 1e4 * np.outer(momentum, momentum) / (shape @ momentum)
        for stretch in np.diff(coordinates, axis=0):
            hessian += stiffness * np.outer(stretch, stretch)
    return hessian


def test_first_estimates_are_the_speeds_of_a_chain_of_springs(
    duplex: SimulatedDuplex, rigid_pair_chain: Array
) -> None:
    speeds = first_estimates_A_per_ps(duplex, rigid_pair_chain)
    mass = duplex.masses_Da.sum() / PAIRS
    inertia = float(np.sum(duplex.masses_Da[:, None] * turns(duplex) ** 2)) / PAIRS
    # V = a √(k/m). What lets the Hessian be factored, 1e-3 kJ/mol/nm² on each of 63 atoms a pair
    # (some 0.8 nm from the axis), adds 1e-3 · 63 · N²/3 to the stretch stiffness and 0.6 of that
    # to the twist stiffness: 7e-5 and 3e-3 of them, half that in the speeds.
    assert speeds["extension"] == pytest.approx(RISE_A * np.sqrt(STRETCH / mass), rel=1e-4)
    assert speeds["twist"] == pytest.approx(RISE_A * np.sqrt(TWIST / inertia), rel=3e-3)


@pytest.mark.parametrize("wave", STATIC_WAVES)
@pytest.mark.parametrize("held", [1, 3])
def test_a_chain_of_springs_gives_way_by_one_spring_a_step(
    duplex: SimulatedDuplex, rigid_pair_chain: Array, wave: str, held: int
) -> None:
    answers = linear_response(GuidedEnd(duplex, wave, held), rigid_pair_chain)
    stiffness = {"extension": STRETCH, "twist": TWIST}[wave]
    for lock in LOCKS:
        # Nothing moves across the axis here, so a lock changes nothing. 3e-3 as above.
        assert answers[lock] == pytest.approx((PAIRS - held) / stiffness, rel=6e-3)


def test_speed_of_a_rod(duplex: SimulatedDuplex) -> None:
    # V² = (load L / displacement) / density, 1 nm/ps = 10 Å/ps.
    length_nm = 7 * RISE_A / 10
    for wave in STATIC_WAVES:
        expected = 10 * np.sqrt(40.0 * length_nm / 0.02 / line_density(duplex, wave))
        assert speed_A_per_ps(duplex, wave, 40.0, 0.02) == pytest.approx(expected, rel=1e-7)


def test_line_density(duplex: SimulatedDuplex) -> None:
    # 0.3375 nm: the fibre's rise. Equal by definition; 1e-7 as the fitted axis.
    mass = duplex.masses_Da.sum() / PAIRS / 0.3375
    assert line_density(duplex, "extension") == pytest.approx(mass, rel=1e-7)
    # A nucleotide pair has 616 Da; of eight pairs the two outer ones lack 61 Da each.
    assert mass * 0.3375 == pytest.approx(616 - 2 * 61 / 8, abs=1)
    inertia = np.sum(duplex.masses_Da[:, None] * turns(duplex) ** 2) / PAIRS / 0.3375
    assert line_density(duplex, "twist") == pytest.approx(inertia, rel=1e-7)


@pytest.mark.parametrize("wave", STATIC_WAVES)
def test_guided_pair_moves_as_a_rigid_body_and_held_pairs_not_at_all(
    duplex: SimulatedDuplex, wave: str
) -> None:
    end = GuidedEnd(duplex, wave, held=2)
    moved_nm = end.positions(np.append(end.start()[:-1] + 0.01, 0.3))
    guided = duplex.pairs == PAIRS - 1
    axis, origin_nm = duplex.frame.axis, duplex.frame.origin_nm
    before = duplex.positions_nm[guided]
    if wave == "extension":
        expected = before + 0.3 * axis
    else:
        expected = origin_nm + Rotation.from_rotvec(0.3 * axis).apply(before - origin_nm)
    np.testing.assert_allclose(moved_nm[guided], expected, atol=1e-14)
    held = duplex.pairs < 2
    np.testing.assert_array_equal(moved_nm[held], duplex.positions_nm[held])
    free = ~held & ~guided
    np.testing.assert_allclose(moved_nm[free], duplex.positions_nm[free] + 0.01, atol=1e-14)
    np.testing.assert_allclose(end.positions(end.start()), duplex.positions_nm, atol=1e-14)


@pytest.mark.parametrize("wave", STATIC_WAVES)
def test_force_is_minus_the_derivative_of_the_energy(relaxed: Any, wave: str) -> None:
    end = GuidedEnd(relaxed.duplex, wave, held=1)
    forces = ReferenceForces(relaxed.duplex.system)
    generator = np.random.default_rng(14)
    # Away from the minimum and turned far: the lever arms must be those of the moment.
    coordinates = end.start() + generator.normal(0, 0.002, end.start().size)
    coordinates[-1] = 0.05
    positions_nm = end.positions(coordinates)
    force = end.force(positions_nm, forces(positions_nm)[1])
    step = 1e-5

    def slope(direction: Array) -> float:
        high, low = (
            forces(end.positions(coordinates + sign * step * direction))[0] for sign in (1, -1)
        )
        return (high - low) / (2 * step)

    last = np.zeros(force.size)
    last[-1] = 1.0
    mixed = generator.normal(size=force.size)
    for direction in (last, mixed / np.linalg.norm(mixed)):
        # Step² times a third derivative of 1e7, and round-off 1e-16 · 5e3 / 1e-5.
        assert -slope(direction) == pytest.approx(force @ direction, rel=1e-6, abs=1e-3)
    assert abs(force[-1]) > 10


@pytest.mark.parametrize("wave", STATIC_WAVES)
def test_hessian_is_the_derivative_of_the_force_at_the_minimum(relaxed: Any, wave: str) -> None:
    end = GuidedEnd(relaxed.duplex, wave, held=1)
    forces = ReferenceForces(relaxed.duplex.system)
    reduced = end.hessian(relaxed.hessian)
    np.testing.assert_array_equal(reduced, reduced.T)
    step = 2e-6

    def force(coordinates: Array) -> Array:
        positions_nm = end.positions(coordinates)
        return end.force(positions_nm, forces(positions_nm)[1])

    generator = np.random.default_rng(15)
    last = np.zeros(reduced.shape[0])
    last[-1] = 1.0
    for direction in (last, generator.normal(size=last.size)):
        high, low = (force(end.start() + sign * step * direction) for sign in (1, -1))
        product = reduced @ direction
        difference = (low - high) / (2 * step)
        # As for the Hessian of the atoms: kinks at the cutoff.
        assert np.abs(difference - product).max() < 2e-5 * np.abs(product).max()


def test_transverse_coordinates_are_those_of_rigid_bodies(relaxed: Any) -> None:
    duplex = relaxed.duplex
    end = GuidedEnd(duplex, "extension", held=1)
    generator = np.random.default_rng(16)
    velocities = np.where(end.free[:, None], generator.normal(size=(len(end.free), 3)), 0.0)
    coordinates = np.append(velocities[end.free].ravel(), 0.7)
    linear, angular = duplex.bodies.velocity(duplex.positions_nm, velocities)
    # Carried from the centre of mass to the helix axis at the pair's height.
    at_axis = duplex.frame.origin_nm + duplex.heights_nm[:, None] * duplex.frame.axis
    linear = linear + np.cross(angular, at_axis - duplex.bodies.centres_nm)
    inner = slice(1, duplex.pair_count - 1)
    across = duplex.frame.directions[:2].T
    shear, tilt = linear[inner] @ across, angular[inner] @ across
    # Two ways to the same sums: round-off.
    np.testing.assert_allclose(
        end.rigid_coordinates(("shear",)) @ coordinates, shear.ravel(), atol=1e-12
    )
    np.testing.assert_allclose(
        end.rigid_coordinates(("shear", "bend")) @ coordinates,
        np.stack([shear, tilt], axis=1).ravel(),
        atol=1e-12,
    )


@pytest.mark.parametrize("wave", STATIC_WAVES)
def test_locks_stiffen_as_a_search_among_allowed_motions_says(relaxed: Any, wave: str) -> None:
    end = GuidedEnd(relaxed.duplex, wave, held=1)
    answers = linear_response(end, relaxed.hessian)
    reduced = end.hessian(relaxed.hessian)
    push = np.zeros(reduced.shape[0])
    push[-1] = 1.0
    # What lets the Hessian be factored, 1e-3 kJ/mol/nm² on every coordinate, is 1e-4 of the load's
    # stiffness at most: |response|² 1e-3 / response[-1], with some 300 atoms moving along.
    assert answers["nothing"] == pytest.approx(np.linalg.solve(reduced, push)[-1], rel=1e-4)
    for lock in ("across", "across_and_tilt"):
        allowed = null_space(end.rigid_coordinates(LOCKS[lock]))
        inside = allowed.T @ reduced @ allowed
        response = allowed @ np.linalg.solve(inside, allowed.T @ push)
        assert answers[lock] == pytest.approx(response[-1], rel=1e-4)
    assert answers["nothing"] > answers["across"] > answers["across_and_tilt"] > 0
