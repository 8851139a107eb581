"""Speed of a wave from thermal mode velocities: the debiased Whittle likelihood.

Whittle (1953), Ark. Mat. 2, 423; Sykulski et al. (2019), Biometrika 106, 251: the spectrum S is
the expectation of the periodogram of a record of this length and interval, so that neither
aliasing nor leakage biases the fit. -ln L = sum(ln S + P/S).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import minimize, minimize_scalar

from dnawaves.rod.dispersion import lattice_frequency
from dnawaves.rod.modal import impulse_response
from dnawaves.waves.estimators.intervals import limit_of_rise
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.model_class import SIGNIFICANCE

Array = NDArray[np.float64]

STARTING_SPEEDS_A_PER_PS = np.geomspace(2.0, 50.0, 80)
STARTING_FRICTIONS_PER_PS = (0.05, 0.5)
BINS = 10
# A periodogram counts as a mode's own where it is expected to exceed the spectrum by less.
LEAKAGE = 1.05
ENDLESS_FRAMES = 10**9


@dataclass(frozen=True)
class WhittleFit:
    """Speed, friction and the modes' mean square velocity; is the spectrum of the right class?

    `p_value` compares the periodogram with the fitted spectrum in bins of frequency, mode by mode.
    """

    speed_A_per_ps: Value
    friction_per_ps: Value
    mean_square: float
    p_value: float
    wrong: bool


def periodogram(velocity: Array, interval_ps: float) -> tuple[Array, Array]:
    """Return angular frequencies (rad/ps), zero and Nyquist's left out, and P (frequency, mode)."""
    frames = len(velocity)
    power = np.asarray(interval_ps / frames * np.abs(np.fft.rfft(velocity, axis=0)) ** 2)
    frequency = np.asarray(2 * np.pi * np.fft.rfftfreq(frames, interval_ps), dtype=np.float64)
    inside = slice(1, (frames + 1) // 2)
    return frequency[inside], power[inside]


def expected_periodogram(
    frames: int,
    interval_ps: float,
    modes_rad_per_ps: Array,
    friction_per_ps: float,
    frequencies_rad_per_ps: Array,
) -> Array:
    """Return the expectation (frequency, mode) for modes of mean square velocity 1.

    At Fourier frequencies of the record. The autocovariance is the velocity's answer to a unit
    impulse (fluctuation and dissipation): an element of the k-th power of the 2x2 propagator F of
    one interval. Its sum with the weights 1 - k/n and phases is closed, without a special case at
    critical damping: R - (1 - F^n) W R^2/n with W = F exp(-i w dt) and R = 1/(1 - W).
    """
    step = _propagator(interval_ps, modes_rad_per_ps, friction_per_ps)
    whole = _propagator(interval_ps * frames, modes_rad_per_ps, friction_per_ps)
    phase = np.exp(-1j * interval_ps * frequencies_rad_per_ps)[
        :, np.newaxis, np.newaxis, np.newaxis
    ]
    turned = phase * step
    a, b = 1 - turned[..., 0, 0], -turned[..., 0, 1]
    c, d = -turned[..., 1, 0], 1 - turned[..., 1, 1]
    resolvent = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    resolvent /= (a * d - b * c)[..., np.newaxis, np.newaxis]
    ends = (np.eye(2) - whole) @ turned @ resolvent @ resolvent / frames
    total = (resolvent - ends)[..., 1, 1].real
    return np.asarray(interval_ps * (2 * total - 1))


def _propagator(time_ps: float, modes_rad_per_ps: Array, friction_per_ps: float) -> Array:
    """Return what a time does to position and velocity of each mode, (mode, 2, 2)."""
    position, velocity = (
        part[0] for part in impulse_response([time_ps], modes_rad_per_ps, friction_per_ps)
    )
    rows = [
        [velocity + friction_per_ps * position, position],
        [-(modes_rad_per_ps**2) * position, velocity],
    ]
    return np.array(rows).transpose(2, 0, 1)


def whittle_fit(
    velocity: Array,
    interval_ps: float,
    wavenumbers_rad_per_nm: Array,
    spacing_nm: float,
    highest_rad_per_ps: float = np.inf,
) -> WhittleFit:
    """Fit speed and friction of the base-pair lattice to mode velocities (time, mode).

    The modes share the friction and the mean square velocity (equipartition, mass-normalised).
    Frequencies above `highest` are left out: there other motion than the rod's may be. Intervals
    are profile likelihoods of 95 %.
    """
    frequency, power = periodogram(velocity, interval_ps)
    band = frequency <= highest_rad_per_ps
    unit = lattice_frequency(wavenumbers_rad_per_nm, 1.0, spacing_nm)

    def spectrum(parameters: Array) -> Array:
        speed, friction = np.exp(parameters)
        return expected_periodogram(
            len(velocity), interval_ps, speed * unit, friction, frequency[band]
        )

    def cost(parameters: Array) -> float:
        shape = np.maximum(spectrum(parameters), np.finfo(float).tiny)
        # The mean square velocity of the largest likelihood is mean(P/S).
        level = np.mean(power[band] / shape)
        return float(np.sum(np.log(shape)) + shape.size * (np.log(level) + 1))

    starts = [
        np.log([speed, friction])
        for speed in STARTING_SPEEDS_A_PER_PS
        for friction in STARTING_FRICTIONS_PER_PS
    ]
    start = min(starts, key=cost)
    best = minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-4})
    shape = spectrum(best.x)
    level = float(np.mean(power[band] / shape))
    limits = [_profile(cost, best.x, index) for index in range(2)]
    values = [Value(*(float(np.exp(x)) for x in (best.x[i], *limits[i]))) for i in range(2)]
    speed, friction = np.exp(best.x)
    endless = expected_periodogram(
        ENDLESS_FRAMES, interval_ps, speed * unit, friction, frequency[band]
    )
    p_value = _p_ratio(power[band] / (level * shape), shape < LEAKAGE * endless)
    return WhittleFit(values[0], values[1], level, p_value, p_value < SIGNIFICANCE)


def _profile(cost: Callable[[Array], float], best: Array, index: int) -> tuple[float, float]:
    """Return where the cost, minimised over the other parameter, rises by half of chi-squared's."""
    least = cost(best)
    step = 1e-3
    around = [np.eye(2)[index] * step, -np.eye(2)[index] * step]
    curvature = sum(cost(best + offset) - least for offset in around) / step**2
    threshold = float(stats.chi2.ppf(1 - SIGNIFICANCE, 1)) / 2
    reach = np.sqrt(2 * threshold / max(curvature, np.finfo(float).eps))

    def excess(offset: float) -> float:
        def of_other(other: float) -> float:
            point = np.array(best)
            point[index] += offset
            point[1 - index] = other
            return cost(point)

        other = float(best[1 - index])
        return float(minimize_scalar(of_other, (other, other + 0.1), tol=1e-4).fun) - least

    low, high = (
        float(best[index]) + limit_of_rise(excess, sign * reach, threshold) for sign in (-1, 1)
    )
    return low, high


def _p_ratio(ratio: Array, own: NDArray[np.bool_]) -> float:
    """Return the p value of ratios P/S (frequency, mode) being exponential of mean 1, in bins.

    Only of those that are a mode's `own` motion: what leaks from the record's two ends is one
    number at all frequencies, so that it has no such distribution.
    """
    cells = zip(
        np.array_split(np.where(own, ratio, 0.0), BINS), np.array_split(own, BINS), strict=True
    )
    sums, counts = np.array([(r.sum(axis=0), n.sum(axis=0)) for r, n in cells]).transpose(1, 0, 2)
    filled = counts > 0
    # A sum of m such ratios has a gamma distribution: each bin has a normal score.
    level = stats.gamma.cdf(sums[filled], counts[filled])
    score = stats.norm.ppf(np.clip(level, 1e-15, 1 - 1e-15))
    return float(stats.chi2.sf(np.sum(score**2), score.size - 3))
