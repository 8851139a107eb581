"""How far what was observed is from what is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from dnawaves.accuracy.models import Case
from dnawaves.accuracy.observe import HELICAL, Observed
from dnawaves.scene.excitations import Kick
from dnawaves.scene.pairs import held_pairs
from dnawaves.waves.estimators.lattice_fit import Observation, fit_lattice
from dnawaves.waves.estimators.lattices import ScalarLattice
from dnawaves.waves.estimators.oscillation import fit_oscillation, share_of_start
from dnawaves.waves.estimators.sources import kick
from dnawaves.waves.record import AXIAL_WAVES

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Errors:
    """Parts of 1; None where there is nothing to compare.

    `waveform` is that of the worst pair against its own peak, `waveform_rms` that of the whole
    field, `helical` that of the worst of twelve parameters against its own largest response.
    """

    speed: float | None
    waveform: float
    waveform_rms: float
    helical: float
    helical_worst: str


def errors(found: Observed, known: Observed, case: Case, spacing_nm: float) -> Errors:
    """Return the errors of a run at its own frames, all of which must be among the known ones."""
    known = at_frames(known, found.times_ps)
    speeds = [rate(one, case, spacing_nm) for one in (found, known)]
    speed = None
    if speeds[0] is not None and speeds[1] is not None:
        speed = abs(speeds[0] / speeds[1] - 1)
    off = np.abs(found.helical - known.helical).max(axis=(1, 2))
    helical = off / np.abs(known.helical).max(axis=(1, 2))
    return Errors(
        speed,
        worst_pair(found.velocity, known.velocity),
        float(np.linalg.norm(found.velocity - known.velocity) / np.linalg.norm(known.velocity)),
        float(helical.max()),
        HELICAL[int(np.argmax(helical))],
    )


def worst_pair(found: Array, known: Array) -> float:
    """Return the largest difference (frames, N) of a pair as a part of that pair's own peak."""
    peaks = np.abs(known).max(axis=0)
    moves = peaks > 0
    return float((np.abs(found - known).max(axis=0)[moves] / peaks[moves]).max())


def between_frames(found: Observed, known: Observed) -> float:
    """Return the error of the worst pair of a curve through the frames, at all known times."""
    inside = known.times_ps <= found.times_ps[-1] + 1e-9
    curve = CubicSpline(found.times_ps, found.velocity)(known.times_ps[inside])
    return worst_pair(curve, known.velocity[inside])


def at_frames(known: Observed, times_ps: Array) -> Observed:
    """Return the known answer at some of its times."""
    which = np.searchsorted(known.times_ps, times_ps - 1e-6)
    assert np.allclose(known.times_ps[which], times_ps, atol=1e-6)
    return Observed(times_ps, known.velocity[which], known.helical[:, which])


def scaled(known: Observed, scale: float) -> Observed:
    """Return a linear answer to a kick so many times as large."""
    return Observed(known.times_ps, scale * known.velocity, scale * known.helical)


def rate(observed: Observed, case: Case, spacing_nm: float) -> float | None:
    """Return the fitted speed (Å/ps), of a standing wave the frequency (rad/ps).

    None for a kick of bend or shear: no estimator fits a single speed to it.
    """
    if not isinstance(case.excitation, Kick):
        share = share_of_start([(1.0, observed.velocity)])
        return fit_oscillation(observed.times_ps, share, interval=False).frequency_rad_per_ps.value
    if case.excitation.wave not in AXIAL_WAVES:
        return None
    held = held_pairs(case.ends, observed.velocity.shape[1])
    source = observed.velocity[0].copy()
    source[held] = 0.0
    respond = kick(observed.times_ps)
    lattice = ScalarLattice(observed.velocity.shape[1], spacing_nm, held, respond, source)
    fit = fit_lattice([Observation(observed.velocity, lattice)], intervals=[])
    return fit["speed_A_per_ps"].value
