"""The rigid-body part of the motion of base pairs, each taken as two whole nucleotides."""

from __future__ import annotations

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class RigidBodies:
    """Base pairs as rigid bodies about a reference structure.

    Parameters
    ----------
    reference_nm : (atoms, 3) positions that define zero displacement and rotation
    masses_Da : (atoms,) true masses, also of atoms that are held
    pairs : (atoms,) index of each atom's base pair, 0 to N-1
    """

    def __init__(self, reference_nm: Array, masses_Da: Array, pairs: Indices) -> None:
        self._order = np.argsort(pairs, kind="stable")
        self._starts = np.searchsorted(pairs[self._order], np.arange(pairs.max() + 1))
        self._pairs = pairs[self._order]
        self._weights = masses_Da[self._order, None]
        self.masses_Da: Array = np.add.reduceat(self._weights, self._starts)[:, 0]
        ordered = reference_nm[self._order]
        self.centres_nm = self._centres(ordered)
        self._arms = ordered - self.centres_nm[self._pairs]
        self.inertia_Da_nm2 = self._inertia(self._arms)

    def pose(self, positions_nm: Array) -> tuple[Array, Array]:
        """Return displacement (N, 3) in nm and rotation vector (N, 3) in rad from the reference.

        The rotation is the least-squares one with the masses as weights (Kabsch 1976).
        """
        ordered = positions_nm[self._order]
        centres = self._centres(ordered)
        arms = ordered - centres[self._pairs]
        correlation = self._sum(
            self._weights[:, :, None] * arms[:, :, None] * self._arms[:, None, :]
        )
        u, _, vt = np.linalg.svd(correlation)
        u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
        return centres - self.centres_nm, Rotation.from_matrix(u @ vt).as_rotvec()

    def velocity(self, positions_nm: Array, velocities_nm_per_ps: Array) -> tuple[Array, Array]:
        """Return velocity (N, 3) in nm/ps and angular velocity (N, 3) in rad/ps.

        The velocity is that of the centre of mass, the angular velocity is the one that carries
        the angular momentum about it.
        """
        ordered, moving = positions_nm[self._order], velocities_nm_per_ps[self._order]
        arms = ordered - self._centres(ordered)[self._pairs]
        angular_momentum = self._sum(self._weights * np.cross(arms, moving))
        angular = np.linalg.solve(self._inertia(arms), angular_momentum[:, :, None])[:, :, 0]
        return self._centres(moving), np.asarray(angular, dtype=np.float64)

    def velocity_map(self) -> scipy.sparse.csr_array:
        """Return the matrix (6 N, 3 atoms) from velocities of atoms to those of the bodies.

        Each body has six rows: velocity of its centre of mass, then angular velocity, x, y, z. As
        the rotation is the mass-weighted one, the matrix maps small displacements as well.
        """
        masses, arms = self._weights, self._arms
        blocks = np.empty((len(masses), 6, 3))
        blocks[:, :3] = (masses / self.masses_Da[self._pairs, None])[:, :, None] * np.eye(3)
        # Column k is the angular momentum m a x e_k per unit velocity along k.
        momenta = masses[:, :, None] * np.cross(arms[:, None, :], np.eye(3)).swapaxes(1, 2)
        blocks[:, 3:] = np.linalg.solve(self.inertia_Da_nm2[self._pairs], momenta)
        rows = 6 * self._pairs[:, None, None] + np.arange(6)[:, None]
        columns = 3 * self._order[:, None, None] + np.arange(3)
        where = np.broadcast_arrays(rows, columns)
        shape = (6 * len(self.masses_Da), 3 * len(masses))
        return scipy.sparse.csr_array(
            (blocks.ravel(), (where[0].ravel(), where[1].ravel())), shape=shape
        )

    def momenta(self, velocities: Array) -> Array:
        """Return momentum and angular momentum (..., N, 6) of bodies that move at (..., N, 6)."""
        linear = self.masses_Da[:, None] * velocities[..., :3]
        angular = np.einsum("nxy,...ny->...nx", self.inertia_Da_nm2, velocities[..., 3:])
        return np.concatenate([linear, angular], axis=-1)

    def _sum(self, values: Array) -> Array:
        return np.add.reduceat(values, self._starts, axis=0)

    def _centres(self, ordered: Array) -> Array:
        return self._sum(self._weights * ordered) / self.masses_Da[:, None]

    def _inertia(self, arms: Array) -> Array:
        second = self._sum(self._weights[:, :, None] * arms[:, :, None] * arms[:, None, :])
        trace = np.trace(second, axis1=1, axis2=2)
        inertia: Array = trace[:, None, None] * np.eye(3) - second
        return inertia
