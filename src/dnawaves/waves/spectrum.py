"""Frequency-wavenumber maps: how the energy of a field is spread over standing waves."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.signal.windows import hann

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.standing import Ends, axial_wavenumber

Array = NDArray[np.float64]

ZERO_PADDING = 4


def frequency_wavenumber(
    times_ps: Array, velocity: Array, spacing_nm: float, held: list[int]
) -> xr.DataArray:
    """Return the power (wavenumber, frequency) of a velocity field (time, pair), largest 1.

    In space the modes of the uniform chain with the scene's own ends, in time a Hann-windowed,
    zero-padded Fourier transform: the padding only draws the map finer, its resolution is one over
    the record's length and stands in the attribute `resolution_GHz`.
    """
    inside = _chain_between(velocity.shape[1], held)
    field = velocity[:, inside]
    pairs = field.shape[1]
    ends, ends_held = _ends(velocity.shape[1], held)
    chain = ScalarChain.from_speed(pairs, 1.0, spacing_nm, ends_held)
    shapes = chain.shapes[chain.frequencies_rad_per_ps > 1e-9]
    projections = field @ shapes.T * hann(len(field), sym=False)[:, None]
    length = ZERO_PADDING * len(field)
    power = np.abs(np.fft.rfft(projections, n=length, axis=0)) ** 2
    interval = float(times_ps[1] - times_ps[0])
    wavenumbers = [
        axial_wavenumber(pairs, mode, ends, spacing_nm) / 10 for mode in range(1, len(shapes) + 1)
    ]
    return xr.DataArray(
        (power / max(float(power.max()), np.finfo(float).tiny)).T,
        dims=("wavenumber", "frequency"),
        coords={
            "wavenumber": ("wavenumber", wavenumbers, {"units": "rad/angstrom"}),
            "frequency": ("frequency", 1e3 * np.fft.rfftfreq(length, interval), {"units": "GHz"}),
        },
        attrs={"resolution_GHz": 1e3 / float(times_ps[-1] - times_ps[0])},
    )


def _ends(pairs: int, held: list[int]) -> tuple[Ends, tuple[int, ...]]:
    first, last = 0 in held, pairs - 1 in held
    if first and last:
        return "held", (0, -1)
    if first or last:
        return "one_held", (0,) if first else (-1,)
    return "free", ()


def _chain_between(pairs: int, held: list[int]) -> slice:
    """Return the pairs from the innermost held one of each end on: the others never move."""
    first = [pair for pair in held if pair < pairs // 2]
    last = [pair for pair in held if pair >= pairs // 2]
    return slice(max(first, default=0), min(last, default=pairs - 1) + 1)
