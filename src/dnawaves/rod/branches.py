"""Branches of the dispersion relation, followed through crossings by their polarisation."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from dnawaves.errors import InputError
from dnawaves.rod.plane_waves import SAME_FREQUENCY, PlaneWaves, plane_waves
from dnawaves.rod.rod import FloatArray, Rod

# Of the largest wavenumber. Two branches that change places within the smallest step cross; an
# avoided crossing as narrow as that cannot be told from it.
SMALLEST_STEP = 1e-8
# Of the largest group velocity: branches of one frequency that are nearer leave it together.
SAME_VELOCITY = 1e-6

ARRAYS = [field.name for field in fields(PlaneWaves) if field.name != "rod"]


def follow_branches(rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool) -> PlaneWaves:
    """Return the plane waves with wave b of every wavenumber on the same branch.

    Branches are counted by frequency at the first wavenumber. Each is continuous in frequency and
    polarisation: where two cross they go straight on, where they avoid each other they change
    character. Where two seem to change places, the step between the wavenumbers is halved until
    it is clear which of the two they do. Polarisations keep their phase and, of equal waves,
    their plane.

    Raises InputError unless the wavenumbers ascend.
    """
    waves = plane_waves(rod, wavenumbers_rad_per_nm, lattice=lattice)
    k = waves.wavenumbers_rad_per_nm
    if not np.all(np.diff(k) > 0):
        raise InputError("branches are followed along wavenumbers that ascend; these do not")
    smallest = SMALLEST_STEP * np.abs(k).max()
    current = _select(waves, 0)
    followed = [current]
    for index in range(1, len(k)):
        # waves between the wavenumbers asked for serve only as stepping stones
        targets = [_select(waves, index)]
        while targets:
            after = _continue(current, targets[-1])
            start, end = current.wavenumbers_rad_per_nm[0], after.wavenumbers_rad_per_nm[0]
            if end - start > smallest and _change_places(current, after):
                targets.append(plane_waves(rod, [(start + end) / 2], lattice=lattice))
            else:
                current = after
                targets.pop()
        followed.append(current)
    return _join(followed)


def _continue(before: PlaneWaves, after: PlaneWaves) -> PlaneWaves:
    """Return `after` with its waves in the order, phase and plane of `before`."""
    columns = _equal_waves(after)
    overlap = np.abs(before.motion[0].conj().T @ after.motion[0]) ** 2
    weight = overlap @ columns
    order = linear_sum_assignment(-weight)[1]
    motion, stress = after.motion[0][:, order], after.stress[0][:, order]
    alike = columns[np.ix_(order, order)]
    for branch in range(6):
        group = np.flatnonzero(alike[branch])
        if group[0] == branch:
            v = motion[:, group]
            # the unitary matrix that brings equal waves closest to those before (Procrustes)
            left, _, right = np.linalg.svd(v.conj().T @ before.motion[0][:, group])
            motion[:, group], stress[:, group] = v @ left @ right, stress[:, group] @ left @ right
    return replace(
        after,
        frequencies_rad_per_ps=after.frequencies_rad_per_ps[:, order],
        group_velocities_nm_per_ps=after.group_velocities_nm_per_ps[:, order],
        motion=motion[np.newaxis],
        stress=stress[np.newaxis],
    )


def _equal_waves(waves: PlaneWaves) -> NDArray[np.bool_]:
    """Return which waves (6, 6) have the same frequency and the same group velocity."""
    omega, velocity = waves.frequencies_rad_per_ps[0], waves.group_velocities_nm_per_ps[0]
    return _close(omega, SAME_FREQUENCY) & _close(velocity, SAME_VELOCITY)


def _close(values: FloatArray, tolerance: float) -> NDArray[np.bool_]:
    return np.abs(values[:, np.newaxis] - values) <= tolerance * np.abs(values).max()


def _change_places(before: PlaneWaves, after: PlaneWaves) -> bool:
    """Return whether any two waves stand in another order than before."""
    first, second = before.frequencies_rad_per_ps[0], after.frequencies_rad_per_ps[0]
    tolerance = SAME_FREQUENCY * first.max()
    below = first[:, np.newaxis] < first - tolerance
    above = second[:, np.newaxis] > second + tolerance
    return bool(np.any(below & above))


def _select(waves: PlaneWaves, index: int) -> PlaneWaves:
    one = slice(index, index + 1)
    return PlaneWaves(waves.rod, *(getattr(waves, name)[one] for name in ARRAYS))


def _join(waves: list[PlaneWaves]) -> PlaneWaves:
    joined = (np.concatenate([getattr(one, name) for one in waves]) for name in ARRAYS)
    return PlaneWaves(waves[0].rod, *joined)
