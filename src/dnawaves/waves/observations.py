"""What a scene's record looks like to each lattice: fields, source, ends."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dnawaves.waves.estimators.lattice_fit import Observation
from dnawaves.waves.estimators.lattices import AxialLattice, ScalarLattice
from dnawaves.waves.estimators.next_nearest import NextNearestLattice
from dnawaves.waves.estimators.plane_lattice import PlaneLattice
from dnawaves.waves.record import Record
from dnawaves.waves.scene_source import course, is_force, mean_mass, pattern, velocity_nm

Array = NDArray[np.float64]

# The coordinates of the two coupled lattices, in the order of their fields.
AXIAL = ("extension", "twist")
PLANE = ("shear", "bend")


def single(
    wave: str, lattice: type[ScalarLattice] | type[NextNearestLattice] = ScalarLattice
) -> Callable[[Record, int], Observation]:
    """Return what observes extension or twist alone in the first frames of a record."""

    def observe(record: Record, frames: int) -> Observation:
        respond = course(record, record.times_ps[:frames])
        chain = lattice(
            record.pairs, record.spacing_nm, record.held, respond, pattern(record, wave)
        )
        return Observation(velocity_nm(record, wave, frames), chain)

    return observe


def coupled(record: Record, frames: int) -> Observation:
    """Return extension and twist with the lattice that couples them."""
    lattice = AxialLattice(
        record.pairs,
        record.spacing_nm,
        record.held,
        course(record, record.times_ps[:frames]),
        _patterns(record, AXIAL),
        (mean_mass(record, AXIAL[0]), mean_mass(record, AXIAL[1])),
    )
    return Observation(_fields(record, AXIAL, frames), lattice)


def plane(record: Record, frames: int) -> Observation:
    """Return shear and bend with the lattice of their plane."""
    lattice = PlaneLattice(
        record.pairs,
        record.spacing_nm,
        record.held,
        course(record, record.times_ps[:frames]),
        _patterns(record, PLANE),
        (mean_mass(record, PLANE[0]), mean_mass(record, PLANE[1])),
        is_force(record),
    )
    return Observation(_fields(record, PLANE, frames), lattice)


def _patterns(record: Record, waves: tuple[str, ...]) -> Array:
    return np.stack([pattern(record, wave) for wave in waves], axis=1)


def _fields(record: Record, waves: tuple[str, ...], frames: int) -> Array:
    return np.stack([velocity_nm(record, wave, frames) for wave in waves], axis=-1)
