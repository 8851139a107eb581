"""The Hessian by central differences of forces, with the sparsity that a cutoff gives, if any."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import openmm
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

DISPLACEMENT_NM = 1e-5


class ReferenceForces:
    """Energy and forces in double precision, on OpenMM's Reference platform."""

    def __init__(self, system: openmm.System) -> None:
        self._context = openmm.Context(
            system,
            openmm.VerletIntegrator(0.001),
            openmm.Platform.getPlatformByName("Reference"),
        )

    def __call__(self, positions_nm: Array) -> tuple[float, Array]:
        """Return the energy (kJ/mol) and forces (kJ/mol/nm), both of shape (atoms, 3)."""
        self._context.setPositions(positions_nm)
        state = self._context.getState(getEnergy=True, getForces=True)
        forces: Array = state.getForces(asNumpy=True)._value
        return state.getPotentialEnergy()._value, forces.copy()


class Hessian:
    """Differentiates the forces of one System, on several threads.

    Atoms further apart than twice the cutoff share no neighbour, so they are displaced together
    and each answer is attributed to the one displaced atom in reach. Without a cutoff (None) each
    atom is displaced on its own.
    """

    def __init__(self, system: openmm.System, cutoff_nm: float | None, threads: int) -> None:
        # A pair that a displacement brings within the cutoff must count as in reach.
        self._reach_nm = np.inf if cutoff_nm is None else cutoff_nm + 10 * DISPLACEMENT_NM
        # OpenMM computes outside Python's lock, so threads with a Context each run side by side.
        self._forces = [ReferenceForces(system) for _ in range(threads)]

    def __call__(self, positions_nm: Array) -> tuple[Array, float]:
        """Return the symmetrised Hessian (3 atoms, 3 atoms), kJ/mol/nm², and its asymmetry.

        The asymmetry is the largest difference between the two estimates of one element.
        """
        atoms = len(positions_nm)
        groups = independent_groups(positions_nm, 2 * self._reach_nm)
        tree, everything = cKDTree(positions_nm), list(range(atoms))
        hessian = np.zeros((atoms, 3, atoms, 3))

        def fill(worker: int) -> None:
            for group in groups[worker :: len(self._forces)]:
                columns = _columns(self._forces[worker], positions_nm, group)
                for atom in group:
                    near = everything
                    if np.isfinite(self._reach_nm):
                        near = tree.query_ball_point(positions_nm[atom], self._reach_nm)
                    hessian[near, :, atom, :] = np.moveaxis(columns[:, near], 0, -1)

        with ThreadPoolExecutor(len(self._forces)) as pool:
            list(pool.map(fill, range(len(self._forces))))
        flat = hessian.reshape(3 * atoms, 3 * atoms)
        asymmetry = max(float(np.abs(flat[row] - flat[:, row]).max()) for row in range(3 * atoms))
        flat += flat.T.copy()
        flat *= 0.5
        return flat, asymmetry

    def price(self, positions_nm: Array) -> str:
        """Return in words what one Hessian costs, from the time of one evaluation."""
        evaluate, atoms = self._forces[0], len(positions_nm)
        evaluate(positions_nm)  # the first one also sets up what is reused
        started = time.perf_counter()
        evaluate(positions_nm)
        each_s = time.perf_counter() - started
        groups = len(independent_groups(positions_nm, 2 * self._reach_nm))
        evaluations = 6 * groups
        return (
            f"a Hessian takes {evaluations} evaluations of the forces, about "
            f"{evaluations * each_s / len(self._forces):.0f} s, and "
            f"{8e-6 * (3 * atoms) ** 2:.0f} MB"
        )


def _columns(forces: ReferenceForces, positions_nm: Array, group: Indices) -> Array:
    """Return minus the forces' central difference for x, y and z, (3, atoms, 3)."""
    columns = np.empty((3, *positions_nm.shape))
    for component in range(3):
        moved = positions_nm.copy()
        moved[group, component] += DISPLACEMENT_NM
        forward = forces(moved)[1]
        moved[group, component] -= 2 * DISPLACEMENT_NM
        columns[component] = (forces(moved)[1] - forward) / (2 * DISPLACEMENT_NM)
    return columns


def independent_groups(positions_nm: Array, separation_nm: float) -> list[Indices]:
    """Return groups of atoms such that two of one group lie further apart than `separation_nm`."""
    if np.isinf(separation_nm):
        return list(np.arange(len(positions_nm), dtype=np.intp)[:, None])
    tree = cKDTree(positions_nm)
    # Along the longest extent, greedy filling packs the most atoms into a group.
    extent = int(np.argmax(np.ptp(positions_nm, axis=0)))
    left = list(np.argsort(positions_nm[:, extent]))
    groups = []
    while left:
        blocked = np.zeros(len(positions_nm), dtype=bool)
        group = []
        for atom in left:
            if not blocked[atom]:
                group.append(atom)
                blocked[tree.query_ball_point(positions_nm[atom], separation_nm)] = True
        groups.append(np.array(group, dtype=np.intp))
        taken = set(group)
        left = [atom for atom in left if atom not in taken]
    return groups
