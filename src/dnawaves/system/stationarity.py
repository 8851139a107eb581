"""Has a thermal run come to rest? Its temperature, and trends in what it fluctuates in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Array = NDArray[np.float64]

# Of a mean temperature; Gaussian, 0.3 % of sound runs lie beyond.
TEMPERATURE_SIGMAS = 3.0
# Few blocks, so that neighbouring ones hardly know of each other. Of sound runs whose fluctuations
# live a fiftieth, a tenth, a fifth of the window (AR(1)) 1, 2, 4 % are called drifting.
BLOCKS = 5
FALSE_ALARMS = 0.01


@dataclass(frozen=True)
class Check:
    """One verdict: what was found, its standard error, whether it is as it should be, in words."""

    value: float
    standard_error: float
    sound: bool
    verdict: str


def temperature_check(
    temperatures_K: Array,
    target_K: float,
    degrees_of_freedom: int,
    friction_per_ps: float,
    interval_ps: float,
) -> Check:
    """Return whether the mean kinetic temperature is the thermostat's, within 3 standard errors.

    Under friction γ the kinetic energy of a harmonic or a free degree of freedom decorrelates with
    an integral time of 1/(2γ), so with f degrees of freedom over a time t the mean has
    σ/T = √(2/(f γ t)), corrected for γ t that are not large as for exponential correlations.
    """
    decayed = 2 * friction_per_ps * interval_ps * len(temperatures_K)
    shorter = 1 + np.expm1(-decayed) / decayed
    error_K = target_K * float(np.sqrt(4 / (degrees_of_freedom * decayed) * shorter))
    mean_K = float(np.mean(temperatures_K))
    off = (mean_K - target_K) / error_K
    sound = abs(off) <= TEMPERATURE_SIGMAS
    verdict = "as set" if sound else f"{off:+.1f} standard errors off {target_K:g} K"
    return Check(mean_K, error_K, sound, verdict)


def trend_check(values: Array, interval_ps: float) -> Check:
    """Return whether values (samples,) have no linear trend against the scatter of block means.

    A line is fitted to the means of five blocks; Student's t of its slope, with three degrees of
    freedom, decides at 1 % false alarms (Box, Hunter & Hunter 2005, Statistics for Experimenters,
    ch. 10). The value is the slope per ps. Too few samples to tell are no sound run.
    """
    each = len(values) // BLOCKS
    if each < 2:
        wanted = 2 * BLOCKS
        return Check(np.nan, np.nan, False, f"too short to tell: {len(values)} of {wanted} samples")
    means = values[len(values) - each * BLOCKS :].reshape(BLOCKS, each).mean(axis=1)
    fit = stats.linregress(np.arange(BLOCKS) * each * interval_ps, means)
    sound = bool(fit.pvalue >= FALSE_ALARMS)
    return Check(
        float(fit.slope),
        float(fit.stderr),
        sound,
        "stationary" if sound else f"drifts (p = {fit.pvalue:.1g})",
    )
