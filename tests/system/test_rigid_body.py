"""Base pairs as rigid bodies: known motions in, the same motions out."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.system.rigid_body import RigidBodies

Array = NDArray[np.float64]
PAIRS, ATOMS = 4, 60


class Cloud:
    """Random atoms of four bodies, in mixed order."""

    def __init__(self) -> None:
        generator = np.random.default_rng(7)
        self.pairs = generator.permutation(np.arange(ATOMS) % PAIRS)
        self.masses_Da = generator.uniform(1, 31, ATOMS)
        self.positions_nm = generator.normal(0, 0.5, (ATOMS, 3)) + 0.34 * self.pairs[:, None]
        self.bodies = RigidBodies(self.positions_nm, self.masses_Da, self.pairs)

    def centre_nm(self, pair: int) -> Array:
        chosen = self.pairs == pair
        return np.average(self.positions_nm[chosen], axis=0, weights=self.masses_Da[chosen])


@pytest.fixture(scope="module")
def cloud() -> Cloud:
    return Cloud()


def test_reference_is_no_displacement(cloud: Cloud) -> None:
    displacement, rotation = cloud.bodies.pose(cloud.positions_nm)
    # Round-off of a singular value decomposition.
    np.testing.assert_allclose(displacement, 0, atol=1e-13)
    np.testing.assert_allclose(rotation, 0, atol=1e-13)


@pytest.mark.parametrize("angle_rad", [1e-6, 0.05, 1.0, 3.0])
def test_rigid_motions_are_recovered(cloud: Cloud, angle_rad: float) -> None:
    generator = np.random.default_rng(8)
    shifts_nm = generator.normal(0, 1, (PAIRS, 3))
    vectors = generator.normal(size=(PAIRS, 3))
    vectors *= angle_rad / np.linalg.norm(vectors, axis=1)[:, None]
    moved_nm = np.empty_like(cloud.positions_nm)
    for pair in range(PAIRS):
        chosen, centre = cloud.pairs == pair, cloud.centre_nm(pair)
        arms = cloud.positions_nm[chosen] - centre
        moved_nm[chosen] = (
            centre + shifts_nm[pair] + Rotation.from_rotvec(vectors[pair]).apply(arms)
        )
    displacement, rotation = cloud.bodies.pose(moved_nm)
    # Round-off; near a half turn a rotation vector magnifies it.
    np.testing.assert_allclose(displacement, shifts_nm, atol=1e-10)
    np.testing.assert_allclose(rotation, vectors, atol=1e-10)


def test_pose_of_deformed_bodies_is_the_least_squares_one(cloud: Cloud) -> None:
    generator = np.random.default_rng(9)
    moved_nm = cloud.positions_nm @ Rotation.from_rotvec([0.2, -0.1, 0.3]).as_matrix().T
    moved_nm += generator.normal(0, 0.05, moved_nm.shape)
    _, rotation = cloud.bodies.pose(moved_nm)
    for pair in range(PAIRS):
        chosen = cloud.pairs == pair
        weights = cloud.masses_Da[chosen]
        before, after = (
            positions[chosen] - np.average(positions[chosen], axis=0, weights=weights)
            for positions in (cloud.positions_nm, moved_nm)
        )
        best, _ = Rotation.align_vectors(after, before, weights=weights)
        # Two algorithms of the same problem: round-off.
        np.testing.assert_allclose(rotation[pair], best.as_rotvec(), atol=1e-12)


def test_a_mirror_image_is_not_taken_for_a_rotation(cloud: Cloud) -> None:
    _, rotation = cloud.bodies.pose(cloud.positions_nm * [1, 1, -1])
    for vector in rotation:
        assert np.linalg.det(Rotation.from_rotvec(vector).as_matrix()) == pytest.approx(1)


def test_velocities_of_a_rigid_motion_are_recovered(cloud: Cloud) -> None:
    generator = np.random.default_rng(10)
    linear, angular = generator.normal(size=(2, PAIRS, 3))
    centres = np.array([cloud.centre_nm(pair) for pair in range(PAIRS)])
    arms = cloud.positions_nm - centres[cloud.pairs]
    velocities = linear[cloud.pairs] + np.cross(angular[cloud.pairs], arms)
    found_linear, found_angular = cloud.bodies.velocity(cloud.positions_nm, velocities)
    # Round-off of a 3 by 3 solve.
    np.testing.assert_allclose(found_linear, linear, atol=1e-12)
    np.testing.assert_allclose(found_angular, angular, atol=1e-12)


def test_velocities_carry_the_momentum_and_the_angular_momentum(cloud: Cloud) -> None:
    generator = np.random.default_rng(11)
    velocities = generator.normal(size=(ATOMS, 3))
    # Away from the reference: the inertia must be that of the moment.
    positions_nm = cloud.positions_nm + generator.normal(0, 0.1, (ATOMS, 3))
    linear, angular = cloud.bodies.velocity(positions_nm, velocities)
    for pair in range(PAIRS):
        chosen = cloud.pairs == pair
        masses, r, v = cloud.masses_Da[chosen], positions_nm[chosen], velocities[chosen]
        np.testing.assert_allclose(masses.sum() * linear[pair], masses @ v, rtol=1e-12)
        arms = r - masses @ r / masses.sum()
        momentum = sum(m * np.cross(a, u) for m, a, u in zip(masses, arms, v, strict=True))
        inertia = sum(
            m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms, strict=True)
        )
        # Round-off.
        np.testing.assert_allclose(inertia @ angular[pair], momentum, rtol=1e-11, atol=1e-11)


def test_inertia_of_a_dumb_bell() -> None:
    # Two masses 2 Da, 1 nm apart along x, and a light one on y: 2·2·0.25 about y and z.
    reference = np.array([[0.5, 0, 0], [-0.5, 0, 0], [0, 0.5, 0], [0, -0.5, 0]])
    bodies = RigidBodies(reference, np.array([2.0, 2.0, 0.1, 0.1]), np.zeros(4, dtype=np.intp))
    np.testing.assert_allclose(bodies.inertia_Da_nm2[0], np.diag([0.05, 1.0, 1.05]), atol=1e-15)
    np.testing.assert_allclose(bodies.masses_Da, [4.2], rtol=1e-15)


def test_velocity_map_is_the_velocity_at_the_reference(cloud: Cloud) -> None:
    velocities = np.random.default_rng(11).normal(size=(ATOMS, 3))
    linear, angular = cloud.bodies.velocity(cloud.positions_nm, velocities)
    mapped = (cloud.bodies.velocity_map() @ velocities.ravel()).reshape(PAIRS, 6)
    # Two ways to the same sums: round-off.
    np.testing.assert_allclose(mapped, np.concatenate([linear, angular], axis=1), atol=1e-12)


def test_velocity_map_is_the_derivative_of_the_pose(cloud: Cloud) -> None:
    moved = np.random.default_rng(12).normal(size=(ATOMS, 3))
    step = 1e-5
    forward, backward = (
        np.concatenate(cloud.bodies.pose(cloud.positions_nm + sign * step * moved), axis=1)
        for sign in (1, -1)
    )
    mapped = (cloud.bodies.velocity_map() @ moved.ravel()).reshape(PAIRS, 6)
    # Step squared times a third derivative of order one, and round-off over the step.
    np.testing.assert_allclose((forward - backward) / (2 * step), mapped, atol=1e-8)


def test_momenta_are_those_of_the_atoms(cloud: Cloud) -> None:
    generator = np.random.default_rng(13)
    motion = generator.normal(size=(PAIRS, 6))
    centres = np.array([cloud.centre_nm(pair) for pair in range(PAIRS)])[cloud.pairs]
    arms = cloud.positions_nm - centres
    atoms = motion[cloud.pairs, :3] + np.cross(motion[cloud.pairs, 3:], arms)
    momenta = cloud.bodies.momenta(motion)
    # Two ways to the same sums: round-off.
    for pair in range(PAIRS):
        chosen = cloud.pairs == pair
        momentum = cloud.masses_Da[chosen, None] * atoms[chosen]
        np.testing.assert_allclose(momenta[pair, :3], momentum.sum(axis=0), atol=1e-11)
        moment = np.cross(arms[chosen], momentum).sum(axis=0)
        np.testing.assert_allclose(momenta[pair, 3:], moment, atol=1e-11)
