"""Cross-checks that read a single lag or pick: simple, and biased on a lattice.

A pulse of standard deviation s in time is slow by about a^2/(16 s^2 V^2) on a lattice of spacing a,
whatever is read off it: the higher wavenumbers lag. Full-waveform fits have no such bias.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]


def lag_ps(interval_ps: float, early: Array, late: Array) -> float:
    """Return by how much one signal (time,) comes after another, by their cross-correlation.

    The largest value at a lag above zero, of either sign (a reflection at a held end turns it),
    interpolated by a parabola.
    """
    products = np.correlate(late, early, "full")[len(early) - 1 :]
    top = 1 + int(np.argmax(np.abs(products[1:-1])))
    return interval_ps * (top + _vertex(np.abs(products[top - 1 : top + 2])))


def first_peak_ps(times_ps: Array, signal: Array, least: float = 0.5) -> float | None:
    """Return the time of the first local maximum that is `least` of the largest, or None."""
    inner = (signal[1:-1] >= signal[:-2]) & (signal[1:-1] > signal[2:])
    peaks = 1 + np.flatnonzero(inner & (signal[1:-1] >= least * signal.max()))
    if len(peaks) == 0:
        return None
    top = int(peaks[0])
    vertex = _vertex(signal[top - 1 : top + 2])
    return float(times_ps[top] + vertex * (times_ps[1] - times_ps[0]))


def threshold_ps(times_ps: Array, signal: Array, fraction: float) -> float | None:
    """Return when a signal reaches a fraction of its first peak, or None if it starts above."""
    peak = first_peak_ps(times_ps, signal)
    if peak is None:
        return None
    last = int(np.searchsorted(times_ps, peak)) + 1
    curve = CubicSpline(times_ps[: last + 1], signal[: last + 1])
    crossings = curve.solve(fraction * float(curve(peak)), extrapolate=False)
    crossings = crossings[curve(crossings, 1) > 0]
    return float(crossings[0]) if len(crossings) else None


def _vertex(three: Array) -> float:
    before, here, after = three
    bend = before - 2 * here + after
    return float((before - after) / (2 * bend)) if bend < 0 else 0.0
