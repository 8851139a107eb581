"""Frequency-wavenumber maps: how the energy of a field is spread over standing waves."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.signal.windows import hann

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.standing import Ends, axial_wavenumber
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]

ZERO_PADDING = 4


def frequency_wavenumber(
    times_ps: Array, velocity: Array, spacing_nm: float, held: tuple[int, ...]
) -> xr.DataArray:
    """Return the power (wavenumber, frequency) of a velocity field (time, pair), largest 1.

    `velocity` holds the base pairs that a wave can reach, the innermost held ones included;
    `held` says which of its ends, 0 and -1, are held. In space the modes of the uniform chain with
    these ends, in time a Hann-windowed, zero-padded Fourier transform: the padding only draws the
    map finer. Its resolution, at which the window's power has fallen to a quarter, is two over the
    record's length and stands in the attribute `resolution_GHz`.
    """
    pairs = velocity.shape[1]
    ends: Ends = "held" if len(held) == 2 else "one_held" if held else "free"
    chain = ScalarChain.from_speed(pairs, 1.0, spacing_nm, held)
    shapes = chain.shapes[chain.frequencies_rad_per_ps > 1e-9]
    projections = velocity @ shapes.T * hann(len(velocity), sym=False)[:, None]
    length = ZERO_PADDING * len(velocity)
    power = np.abs(np.fft.rfft(projections, n=length, axis=0)) ** 2
    interval = float(times_ps[1] - times_ps[0])
    wavenumbers = [
        axial_wavenumber(pairs, mode, ends, spacing_nm) / A_PER_NM
        for mode in range(1, len(shapes) + 1)
    ]
    return xr.DataArray(
        (power / max(float(power.max()), np.finfo(float).tiny)).T,
        dims=("wavenumber", "frequency"),
        coords={
            "wavenumber": ("wavenumber", wavenumbers, {"units": "rad/angstrom"}),
            "frequency": ("frequency", 1e3 * np.fft.rfftfreq(length, interval), {"units": "GHz"}),
        },
        attrs={"resolution_GHz": 2e3 / float(times_ps[-1] - times_ps[0])},
    )
