"""Impulse response from an equilibrium run, without any forcing: fluctuation and dissipation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError

Array = NDArray[np.float64]


def equilibrium_response(
    velocity: Array, impulse: Array, energy: float, lags: int, observed: Array | None = None
) -> tuple[Array, Array]:
    """Return what an impulse would do, (lag, channel), and its standard error.

    A kick p -> p + b gives <dA(t)> = <A(t) v_b(0)>/kT with v_b = b.v (Kubo). `velocity`
    (run, time, channel) of runs, or of one run cut into blocks that are longer than memory lasts
    (`intervals.blocks`); `impulse` (channel,) in momentum, `energy` kT; A is `observed`
    (run, time, channel), by default the velocity itself. The standard error is that of the mean
    over the runs.
    """
    answers = velocity if observed is None else observed
    if velocity.ndim != 3 or len(velocity) < 2 or lags > velocity.shape[1]:
        raise InputError(
            "the response needs at least two runs or blocks, (run, time, channel), each longer "
            "than the lags"
        )
    source = velocity @ impulse
    frames = velocity.shape[1]
    length = 2 * frames
    spectrum = np.fft.rfft(source, n=length, axis=1).conj()[..., np.newaxis]
    products = np.fft.irfft(spectrum * np.fft.rfft(answers, n=length, axis=1), n=length, axis=1)[
        :, :lags
    ]
    counts = (frames - np.arange(lags))[:, np.newaxis]
    each = products / counts / energy
    mean: Array = each.mean(axis=0)
    error: Array = each.std(axis=0, ddof=1) / np.sqrt(len(each))
    return mean, error
