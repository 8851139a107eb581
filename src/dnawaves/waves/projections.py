"""The share of a record's motion in one standing wave, as a function of time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.standing import (
    axial_standing_wave,
    bend_standing_wave,
    shear_standing_wave,
)
from dnawaves.waves.estimators.oscillation import share_of_start
from dnawaves.waves.observations import PLANE
from dnawaves.waves.paper_answer import paper_rod
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.scene_source import mean_mass, pattern, unit_A, velocity_nm

Array = NDArray[np.float64]


def standing_projection(record: Record, wave: str) -> Array:
    """Return the share (time,) of the motion in the standing wave that was kicked, 1 at first."""
    coordinates = (wave,) if wave in AXIAL_WAVES else PLANE
    return share_of_start(
        [(mean_mass(record, one), velocity_nm(record, one)) for one in coordinates]
    )


def mode_projection(record: Record, wave: str, mode: int = 1) -> Array:
    """Return the amplitude (time,) of a standing wave, counted from 1, in a record's velocities.

    In the wave's own unit, Å/ps or rad/ps, where its motion is largest. The paper's rod only
    chooses the shape of bend and shear that is looked at.
    """
    shapes = mode_shape(record, wave, mode)
    fields = {one: velocity_nm(record, one) for one in shapes}
    return amplitude(record, shapes, fields) * unit_A(wave)


def mode_source(record: Record, wave: str, mode: int = 1) -> float:
    """Return the amplitude of the scene's source in a standing wave, in the same unit."""
    shapes = mode_shape(record, wave, mode)
    fields = {one: pattern(record, one)[np.newaxis] for one in shapes}
    return float(amplitude(record, shapes, fields)[0]) * unit_A(wave)


def mode_shape(record: Record, wave: str, mode: int) -> dict[str, Array]:
    """Return a standing wave's shape (pair,) in each coordinate, largest 1 in the wave's own."""
    first, last = record.span
    count = last - first + 1
    backwards = record.ends == "one_held" and last in record.held
    if wave in AXIAL_WAVES:
        parts = {wave: axial_standing_wave(count, mode, record.ends)}
    else:
        standing = bend_standing_wave if wave == "bend" else shear_standing_wave
        found = standing(paper_rod(record.spacing_nm), count, mode, record.ends)
        turn = -found.rotation_rad_per_nm if backwards else found.rotation_rad_per_nm
        parts = {"shear": found.displacement, "bend": turn}
    largest = np.abs(parts[wave]).max()
    shapes = {}
    for one, part in parts.items():
        shapes[one] = np.zeros(record.pairs)
        shapes[one][first : last + 1] = (part[::-1] if backwards else part) / largest
    return shapes


def amplitude(record: Record, shapes: dict[str, Array], fields: dict[str, Array]) -> Array:
    """Return the amplitude (time,) of a shape in fields (time, pair), nm and rad, by their mass."""
    masses = {one: mean_mass(record, one) for one in shapes}
    overlap = sum(masses[one] * fields[one] @ shape for one, shape in shapes.items())
    norm = sum(masses[one] * float(shape @ shape) for one, shape in shapes.items())
    return np.asarray(overlap / norm)
