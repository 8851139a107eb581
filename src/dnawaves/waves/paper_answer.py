"""What the paper's rod answers to the same excitation, on the duplex's own lattice and ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.chain import PlaneChain, ScalarChain
from dnawaves.rod.rod import Rod
from dnawaves.waves.observations import PLANE
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.scene_source import course, is_force, pattern, unit_A

Array = NDArray[np.float64]


def paper_rod(spacing_nm: float) -> Rod:
    """Return the paper's rod with the duplex's own distance of base pairs."""
    return replace(Rod.paper(), spacing_nm=spacing_nm)


def paper_velocity(record: Record, wave: str, times_ps: Array) -> Array:
    """Return the velocity field (time, pair), Å/ps or rad/ps, of the paper's rod.

    Kicked with the same velocities, or pushed with the same accelerations.
    """
    respond = course(record, times_ps)
    if wave in AXIAL_WAVES:
        speed = record.paper_speeds_A_per_ps[wave]
        chain = ScalarChain.from_speed(record.pairs, speed, record.spacing_nm, record.held)
        return respond(chain, pattern(record, wave), 0.0) * unit_A(wave)
    rod = paper_rod(record.spacing_nm)
    plane = PlaneChain(rod, record.pairs, record.held)
    source = np.stack([pattern(record, one) for one in PLANE], axis=1)
    if is_force(record):
        source = source * rod.spacing_nm * [rod.density_Da_per_nm, rod.inertia_Da_nm[0, 0]]
    return respond(plane, source, 0.0)[..., PLANE.index(wave)] * unit_A(wave)
