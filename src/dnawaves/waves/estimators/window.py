"""How far into a record the answer to an excitation can be trusted."""

from __future__ import annotations

import numpy as np
import xarray as xr

# Room for round-off and for the work of a drive being known to second order in the timestep, as a
# part of the energy put in so far and of all that was put in.
ENERGY_ROOM = 1e-3
FEWEST_FRAMES = 12


def usable_frames(fields: xr.Dataset) -> int:
    """Return the number of frames before the difference holds more energy than was put in.

    In a stable linear system it never does; where it starts to, the two signs have come apart by
    another cause than the excitation. A null, into which nothing was put, has none.
    """
    put_in = fields["energy_put_in"].values
    if not put_in.any():
        return 0
    allowed = put_in + ENERGY_ROOM * (put_in + put_in.max())
    excess = fields["kinetic_energy"].values > allowed
    return int(np.argmax(excess)) if excess.any() else len(excess)


def windows(frames: int) -> list[int]:
    """Return the lengths of the fit windows, in frames, the longest first."""
    lengths = [frames, 3 * frames // 4, frames // 2]
    return [length for length in lengths if length >= FEWEST_FRAMES]
