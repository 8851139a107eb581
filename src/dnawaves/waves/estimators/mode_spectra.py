"""Frequencies of thermally moving modes upon a background, and the speed that they share.

In a molecule the velocity of a standing wave holds more than the wave: base pairs also move in
themselves, at all frequencies. Near a wave's line that is a flat background, so the spectrum of a
mode is A s(w; w_p, g_p) + B with s that of a damped oscillator. `whittle` is the same without
background and with one friction.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import lattice_frequency
from dnawaves.waves.estimators.intervals import LEVEL
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.model_class import SIGNIFICANCE
from dnawaves.waves.estimators.whittle import expected_periodogram, periodogram

Array = NDArray[np.float64]

SPEEDS_A_PER_PS = np.geomspace(1.0, 60.0, 100)
# From hardly damped within a record to overdamped at the top of the band.
FRICTIONS_PER_PS = np.geomspace(0.02, 30.0, 14)
FINE_FRICTIONS_PER_PS = np.geomspace(0.02, 30.0, 80)
# Around the best speed, for the interval; widened while a limit lies outside.
REFINED = np.geomspace(1 / 1.1, 1.1, 25)
WIDEST = 5
SCORING_STEPS = 12
BINS = 8
# Of the power in the band: a line that holds less may be any bump of the background.
LEAST_SHARE = 0.5
# In the band: a few in each bin.
FEWEST_FREQUENCIES = 3 * BINS


@dataclass(frozen=True)
class ModeSpectrum:
    """One mode: wavenumber, frequency of the undamped wave with its interval, friction, shares.

    `wave_share` is the part of the mode's power within the band that is in its line, `misfit` the
    root mean square deviation of the binned periodogram from the fitted spectrum, relative;
    `p_value` that of such a deviation by chance.
    """

    wavenumber_rad_per_nm: float
    frequency_rad_per_ps: Value
    friction_per_ps: float
    wave_share: float
    misfit: float
    p_value: float

    @property
    def fits(self) -> bool:
        """Whether one line upon a lower flat background is all that the spectrum shows, at 5 %."""
        return self.p_value >= SIGNIFICANCE and self.wave_share >= LEAST_SHARE


@dataclass(frozen=True)
class SharedSpeed:
    """The long-wave speed of the lattice on whose dispersion relation all modes lie.

    `p_dispersion` is that of the likelihood ratio between modes of one speed and modes of any
    frequencies; `wrong` says that it, or the modes' own p values, are below 5 % together, or that
    the lines hold less than half of the power.
    """

    speed_A_per_ps: Value
    friction_per_ps: float
    wave_share: float
    misfit: float
    p_dispersion: float
    wrong: bool
    modes: tuple[ModeSpectrum, ...]


def shared_speed(
    runs: Sequence[Array],
    interval_ps: float,
    wavenumbers_rad_per_nm: Array,
    spacing_nm: float,
    highest_rad_per_ps: float,
) -> SharedSpeed:
    """Fit mode velocities (time, mode) of independent runs, alike long, by Whittle's likelihood.

    Friction, amplitude and background of each mode are its own; frequencies are those of a lattice
    of one speed (profile likelihood, 95 %), and, in `modes`, each mode's own. Frequencies above
    `highest` are left out. Raises `InputError` where too few are left or a mode does not move.
    """
    power, frequency, frames = _mean_power(runs, interval_ps, highest_rad_per_ps)
    unit = lattice_frequency(wavenumbers_rad_per_nm, 1.0, spacing_nm)
    fits = [
        _Mode(power[:, mode], frequency, frames, interval_ps, len(runs), float(one))
        for mode, one in enumerate(unit)
    ]
    own = [_profile(fit.cost, fit.coarse) for fit in fits]
    speed, least = _profile(
        lambda speeds: np.sum([fit.cost(speeds) for fit in fits], axis=0),
        np.sum([fit.coarse for fit in fits], axis=0),
    )
    modes = tuple(
        fit.described(float(k), one)
        for fit, k, (one, _) in zip(fits, wavenumbers_rad_per_nm, own, strict=True)
    )
    ratio = 2 * (least - sum(one for _, one in own))
    degrees = len(fits) - 1
    p_dispersion = float(stats.chi2.sf(max(ratio, 0.0), degrees)) if degrees else 1.0
    at_best = [
        fit.described(float(k), speed) for fit, k in zip(fits, wavenumbers_rad_per_nm, strict=True)
    ]
    p_least = min(1.0, len(modes) * min(one.p_value for one in at_best))
    share = float(np.mean([one.wave_share for one in at_best]))
    return SharedSpeed(
        speed,
        float(np.exp(np.mean(np.log([one.friction_per_ps for one in at_best])))),
        share,
        float(np.sqrt(np.mean([one.misfit**2 for one in at_best]))),
        p_dispersion,
        min(p_dispersion, p_least) < SIGNIFICANCE / 2 or share < LEAST_SHARE,
        modes,
    )


def _mean_power(
    runs: Sequence[Array], interval_ps: float, highest_rad_per_ps: float
) -> tuple[Array, Array, int]:
    frames = min(len(run) for run in runs)
    spectra = [periodogram(run[:frames], interval_ps) for run in runs]
    frequency = spectra[0][0]
    band = frequency <= highest_rad_per_ps
    if np.sum(band) < FEWEST_FREQUENCIES:
        needed = FEWEST_FREQUENCIES * 2 * np.pi / highest_rad_per_ps
        raise InputError(
            f"records of {frames * interval_ps:.3g} ps are too short for spectra; "
            f"allowed: {needed:.3g} ps and more"
        )
    mean = np.mean([power[band] for _, power in spectra], axis=0)
    if not mean.any(axis=0).all():
        raise InputError("a mode does not move: there is no spectrum to fit")
    return mean, frequency[band], frames


class _Mode:
    """The likelihood of one mode's frequency, all else of it fitted.

    Frequencies are given as the speed, Å/ps, of the lattice that has them; `unit` is that of 1.
    """

    def __init__(
        self,
        power: Array,
        frequency: Array,
        frames: int,
        interval_ps: float,
        runs: int,
        unit_rad_per_ps: float,
    ) -> None:
        self._power, self._frequency, self._runs = power, frequency, runs
        self._frames, self._interval, self._unit = frames, interval_ps, unit_rad_per_ps

    @cached_property
    def coarse(self) -> Array:
        """The cost of each of `SPEEDS_A_PER_PS`."""
        return self.cost(SPEEDS_A_PER_PS)

    def cost(self, speeds_A_per_ps: Array) -> Array:
        """Return -ln L (speed,), minimised over friction, amplitude and background."""
        costs = self._grid(speeds_A_per_ps, FRICTIONS_PER_PS)[0]
        return np.asarray([_parabola_minimum(row) for row in costs])

    def described(self, wavenumber: float, speed: Value) -> ModeSpectrum:
        """Return the mode with the speed given."""
        frequency = Value(*(self._unit * x for x in (speed.value, speed.low, speed.high)))
        frictions = FINE_FRICTIONS_PER_PS
        costs, amplitudes, shapes = self._grid(np.array([speed.value]), frictions)
        best = int(np.argmin(costs[0]))
        line, floor = amplitudes[:, 0, best]
        spectrum = line * shapes[:, 0, best] + floor
        ratio = self._power / spectrum
        cells = [part for part in np.array_split(ratio, BINS) if len(part)]
        counts = np.array([self._runs * len(part) for part in cells])
        level = stats.gamma.cdf([self._runs * part.sum() for part in cells], counts)
        score = stats.norm.ppf(np.clip(level, 1e-15, 1 - 1e-15))
        means = np.array([part.mean() for part in cells])
        # Four parameters, but fitted to more than the bins: that takes less than four degrees of
        # freedom off (Chernoff & Lehmann 1954, Ann. Math. Stat. 25, 579).
        p_value = float(stats.chi2.sf(np.sum(score**2), max(len(cells) - 3, 1)))
        return ModeSpectrum(
            wavenumber,
            frequency,
            float(frictions[best]),
            float(np.sum(line * shapes[:, 0, best]) / np.sum(spectrum)),
            float(np.sqrt(np.mean((means - 1) ** 2))),
            p_value,
        )

    def _grid(self, speeds_A_per_ps: Array, frictions_per_ps: Array) -> tuple[Array, Array, Array]:
        """Return -ln L (speed, friction), (A, B) of each, the lines (frequency, speed, friction).

        A and B by Fisher scoring of their logarithms; the likelihood of a mean of periodograms.
        """
        shapes = np.stack(
            [
                expected_periodogram(
                    self._frames,
                    self._interval,
                    self._unit * speeds_A_per_ps,
                    float(friction),
                    self._frequency,
                )
                for friction in frictions_per_ps
            ],
            axis=-1,
        )
        power = self._power[:, np.newaxis, np.newaxis]
        shapes = np.maximum(shapes, 1e-12 * shapes.max(axis=0))
        parts = np.stack([shapes, np.ones_like(shapes)])
        level = float(power.mean())
        logs = np.log(np.stack([level / shapes.mean(axis=0), np.full(shapes.shape[1:], level)]) / 2)
        for _ in range(SCORING_STEPS):
            scaled = np.exp(logs)[:, np.newaxis] * parts
            spectrum = scaled.sum(axis=0)
            scaled /= spectrum
            slope = np.sum(scaled * (power / spectrum - 1), axis=1)
            a, d = np.sum(scaled**2, axis=1)
            b = np.sum(scaled[0] * scaled[1], axis=0)
            # a little damping keeps a part that is not there from running away
            a, d = 1.01 * a + 1e-3, 1.01 * d + 1e-3
            step = np.stack([d * slope[0] - b * slope[1], a * slope[1] - b * slope[0]])
            logs = logs + np.clip(step / (a * d - b**2), -2, 2)
        amplitudes = np.exp(logs)
        spectrum = np.einsum("cmg,cfmg->fmg", amplitudes, parts)
        cost = self._runs * np.sum(np.log(spectrum) + power / spectrum, axis=0)
        return cost, amplitudes, shapes


def _parabola_minimum(costs: Array) -> float:
    """Return the minimum of costs on an even grid, through the three lowest neighbours."""
    best = int(np.argmin(costs))
    if not 0 < best < len(costs) - 1:
        return float(costs[best])
    before, here, after = costs[best - 1 : best + 2]
    curvature = before - 2 * here + after
    return float(here - (before - after) ** 2 / (8 * curvature)) if curvature > 0 else float(here)


def _profile(cost: Callable[[Array], Array], coarse: Array) -> tuple[Value, float]:
    """Return where a cost of speeds is least, with the 95 % interval, and the least cost.

    `coarse` is the cost of `SPEEDS_A_PER_PS`.
    """
    centre = float(SPEEDS_A_PER_PS[int(np.argmin(coarse))])
    rise = float(stats.chi2.ppf(LEVEL, 1)) / 2
    factors = REFINED
    for _ in range(WIDEST):
        speeds = centre * factors
        fine = CubicSpline(np.log(speeds), cost(speeds))
        grid = np.linspace(np.log(speeds[0]), np.log(speeds[-1]), 2001)
        values = fine(grid)
        best = int(np.argmin(values))
        least = float(values[best])
        if min(values[0], values[-1]) > least + rise:
            break
        factors = factors**2

    def limit(side: slice, end: int) -> float:
        reached = np.flatnonzero(values[side] > least + rise)
        if not len(reached):
            return 0.0 if end == 0 else float(np.inf)
        index = int(reached[-1]) if end == 0 else best + int(reached[0])
        pair = (grid[index], grid[index + 1]) if end == 0 else (grid[index - 1], grid[index])
        return float(np.exp(brentq(lambda x: float(fine(x)) - least - rise, *pair)))

    value = Value(float(np.exp(grid[best])), limit(slice(0, best), 0), limit(slice(best, None), 1))
    return value, least
