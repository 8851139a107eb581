"""Estimators of a wave's speed or frequency from its field along the helix axis."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.modal import impulse_response, sine_drive_response
from dnawaves.waves.fit import Fit, fit_rate

Array = NDArray[np.float64]

# The fraction of the first peak at which the front of a kick of one base pair on an endless lattice
# arrives with the least bias, within 0.3 % from 12 base pairs on. A wider kick and an end bias it.
ARRIVAL_FRACTION = 0.663
# Fits start from all speeds that a wave in a molecule might have, in Å/ps.
STARTING_SPEEDS_A_PER_PS = np.geomspace(2.0, 50.0, 8)


def waveform_fit(
    times_ps: Array,
    velocity: Array,
    spacing_nm: float,
    held: Sequence[int],
    observed: NDArray[np.bool_] | None = None,
) -> Fit:
    """Fit the speed of a uniform chain to the whole record of a kicked wave.

    `velocity` (time, pair) of extension or twist; its first frame is the source. The forward model
    is the base-pair lattice with the scene's ends, so dispersion and reflections are part of it.
    `observed` (pair,) limits the pairs that are fitted. The rate is the speed in Å/ps.
    """
    pairs = velocity.shape[1]
    chain = ScalarChain.from_speed(pairs, 1.0, spacing_nm, held)
    source = velocity[0] * chain.free
    chosen = chain.free if observed is None else chain.free & observed

    def model(speed: float, friction: float) -> Array:
        return chain.scaled(speed).kick_response(times_ps, source, friction)[1][:, chosen]

    return fit_rate(model, velocity[:, chosen], STARTING_SPEEDS_A_PER_PS)


def damped_sine_fit(times_ps: Array, projection: Array) -> Fit:
    """Fit a damped free oscillation started by an impulse; the rate is in rad/ps."""

    def model(frequency: float, friction: float) -> Array:
        return impulse_response(times_ps, [frequency], friction)[1][:, 0]

    return fit_rate(model, projection, _starting_frequencies(times_ps))


def resonance_fit(
    times_ps: Sequence[Array],
    projections: Sequence[Array],
    drives_rad_per_ps: Sequence[float],
    ramps_ps: Sequence[float] | None = None,
) -> Fit:
    """Fit one driven oscillator, from rest and transient included, to runs of several drives.

    `projections` are the mode's velocities, `ramps_ps` the times over which the drives rise, left
    out none; frequency, friction and gain are common to all runs, so the frequency is known better
    than the inverse length of a record. The rate is in rad/ps.
    """

    ramps = ramps_ps or [0.0 for _ in drives_rad_per_ps]

    def model(frequency: float, friction: float) -> Array:
        return np.concatenate(
            [
                sine_drive_response(times, [frequency], friction, drive, ramp_ps)[1][:, 0]
                for times, drive, ramp_ps in zip(times_ps, drives_rad_per_ps, ramps, strict=True)
            ]
        )

    longest = max(times_ps, key=lambda times: float(times[-1]))
    return fit_rate(model, np.concatenate(projections), _starting_frequencies(longest))


def arrival_ps(times_ps: Array, velocity: Array) -> float | None:
    """Return when a front arrives, from the velocity (time,) of one base pair.

    When it reaches 66.3 % of its first peak, interpolated between frames. The first peak is the
    first local maximum, in the sign of the largest motion, that is at least half as large. None
    where nothing has peaked yet, or where the base pair was already moving.
    """
    signal = velocity * np.sign(velocity[np.argmax(np.abs(velocity))])
    inner = (signal[1:-1] >= signal[:-2]) & (signal[1:-1] > signal[2:])
    peaks = 1 + np.flatnonzero(inner & (signal[1:-1] >= 0.5 * signal.max()))
    if not signal.any() or len(peaks) == 0:
        return None
    peak = int(peaks[0])
    threshold = ARRIVAL_FRACTION * signal[peak]
    below = np.flatnonzero(signal[:peak] < threshold)
    if len(below) == 0:
        return None
    before = int(below[-1])
    rise = (threshold - signal[before]) / (signal[before + 1] - signal[before])
    return float(times_ps[before] + rise * (times_ps[before + 1] - times_ps[before]))


def project_on_start(*weighted: tuple[float, Array]) -> Array:
    """Return the motion's share (time,) in the shape that was kicked, 1 at the start.

    Each field (time, pair) comes with its mass or moment of inertia as weight.
    """
    overlap = sum(weight * field @ field[0] for weight, field in weighted)
    return np.asarray(overlap / overlap[0])


def project_on_shape(field: Array, shape: Array) -> Array:
    """Return the amplitude (time,) of a shape (pair,) in a field (time, pair)."""
    return field @ shape / float(shape @ shape)


def _starting_frequencies(times_ps: Array) -> Array:
    """From a quarter of a period in the record to a quarter of the Nyquist frequency."""
    interval = float(times_ps[1] - times_ps[0])
    return np.geomspace(0.25 * 2 * np.pi / float(times_ps[-1]), 0.25 * np.pi / interval, 8)
