"""What follows from speeds and frictions: attenuation, diffusion, distances from a lag, trends.

A wave with friction obeys w² + i g w = w_k² (telegrapher's equation): with the friction g per
mass, its front runs at the speed of the undamped wave, its amplitude falls by exp(-g x/2V), and
waves with w_k < g/2 do not oscillate but diffuse, with D = V²/g.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from dnawaves.errors import InputError
from dnawaves.units import A_PER_NM
from dnawaves.waves.estimators.correlation import FRONT_FRACTION, threshold_ps, upright
from dnawaves.waves.estimators.intervals import LEVEL

Array = NDArray[np.float64]


class Measured(NamedTuple):
    """A number and its standard error."""

    value: float
    sd: float = 0.0


def attenuation_length_A(group_velocity_A_per_ps: float, friction_per_ps: float) -> float:
    """Return the distance, Å, over which the amplitude of a weakly damped wave falls by e: 2V/g.

    Of extension and twist at all frequencies far above g/2, and at their front at any friction; of
    bend and shear with the group velocity at the wave's own wavenumber. Infinite without friction.
    """
    if friction_per_ps < 0:
        raise InputError(f"friction: found {friction_per_ps:g} /ps; allowed: 0 and above")
    return 2 * group_velocity_A_per_ps / friction_per_ps if friction_per_ps else np.inf


def driven_attenuation_length_A(
    frequency_rad_per_ps: ArrayLike,
    speed_A_per_ps: float,
    friction_per_ps: float,
    spacing_nm: float | None = None,
) -> Array:
    """Return 1/Im k, Å, of extension or twist that is driven at a frequency, any friction.

    k V = sqrt(w² + i g w); on a lattice of that spacing (2V/a) sin(k a/2). It is 2V/g far above
    g/2, the diffusive sqrt(2 V²/(g w)) far below, and above the lattice's edge, where nothing
    propagates, short without any friction.
    """
    frequency = np.asarray(frequency_rad_per_ps, dtype=float)
    root = np.sqrt(frequency**2 + 1j * friction_per_ps * frequency) / speed_A_per_ps
    if spacing_nm is not None:
        half = A_PER_NM * spacing_nm / 2
        root = np.arcsin(half * root) / half
    with np.errstate(divide="ignore"):
        return np.asarray(1 / np.abs(root.imag))


class Crossover(NamedTuple):
    """Where propagation turns into diffusion: waves longer than this only relax."""

    frequency_rad_per_ps: float
    wavenumber_rad_per_A: float
    wavelength_A: float
    diffusion_A2_per_ps: float


def crossover(
    speed_A_per_ps: float, friction_per_ps: float, spacing_nm: float | None = None
) -> Crossover:
    """Return the crossover of extension or twist, at w_k = g/2; on a lattice of that spacing.

    Wavenumber infinite, wavelength 0, where the friction exceeds twice the lattice's highest
    frequency, 4V/a: then nothing propagates.
    """
    if not (speed_A_per_ps > 0 and friction_per_ps > 0):
        raise InputError(
            f"found {speed_A_per_ps:g} Å/ps and a friction of {friction_per_ps:g} /ps; "
            "allowed: above 0"
        )
    wavenumber = friction_per_ps / (2 * speed_A_per_ps)
    if spacing_nm is not None:
        half = A_PER_NM * spacing_nm / 2
        sine = half * wavenumber
        wavenumber = float(np.arcsin(sine)) / half if sine <= 1 else np.inf
    return Crossover(
        friction_per_ps / 2,
        wavenumber,
        2 * np.pi / wavenumber,
        speed_A_per_ps**2 / friction_per_ps,
    )


def flexural_crossover_per_A(bend_over_density_A4_per_ps2: float, friction_per_ps: float) -> float:
    """Return the wavenumber, 1/Å, below which long bend waves, w = k² sqrt(D/rho), only relax."""
    return float(np.sqrt(friction_per_ps / 2 / np.sqrt(bend_over_density_A4_per_ps2)))


def distance_from_lag(
    extension_ps: Measured, twist_ps: Measured, extension: Measured, twist: Measured
) -> Measured:
    """Return the distance, Å, of two points from the arrivals of two waves that left together.

    t_twist - t_extension = x (1/V_twist - 1/V_extension), as Bishop & Zhmudsky propose. Speeds in
    Å/ps; errors are independent and propagated to first order. Raises `InputError` where the
    speeds are equal.
    """
    slowness = 1 / twist.value - 1 / extension.value
    if slowness == 0:
        raise InputError(f"both speeds are {twist.value:g} Å/ps: the waves never come apart")
    distance = (twist_ps.value - extension_ps.value) / slowness
    variance = (extension_ps.sd**2 + twist_ps.sd**2) / slowness**2
    for speed in (extension, twist):
        variance += (distance / slowness * speed.sd / speed.value**2) ** 2
    return Measured(float(distance), float(np.sqrt(variance)))


def front_lags(
    extension: tuple[Array, Array], twist: tuple[Array, Array], pairs: Sequence[int]
) -> dict[int, tuple[Measured, Measured]]:
    """Return when the fronts of extension and of twist arrive at base pairs that both reach.

    Each is times (time,) and velocities (time, pair) of a kick of the same base pairs at t = 0; the
    error of an arrival is half the difference to a lower pick, of half the first peak.
    """
    found = {}
    for pair in pairs:
        arrivals = [_arrival(times, velocity[:, pair]) for times, velocity in (extension, twist)]
        if arrivals[0] and arrivals[1]:
            found[pair] = (arrivals[0], arrivals[1])
    return found


def _arrival(times_ps: Array, velocity: Array) -> Measured | None:
    signal = upright(times_ps, velocity)
    picks = [threshold_ps(times_ps, signal, part) for part in (FRONT_FRACTION, 0.5)]
    if picks[0] is None or picks[1] is None:
        return None
    return Measured(picks[0], abs(picks[0] - picks[1]) / 2)


class Ruler(NamedTuple):
    """A straight line from lags to distances: distance = at_no_lag + A_per_ps times the lag.

    `error_A` is the standard error of one distance read off it.
    """

    A_per_ps: float
    at_no_lag_A: float
    error_A: float

    def distance_A(self, lag_ps: float) -> float:
        """Return the distance of two points whose waves come so far apart."""
        return self.at_no_lag_A + self.A_per_ps * lag_ps


def lag_ruler(distances_A: ArrayLike, lags_ps: ArrayLike) -> Ruler:
    """Return the best line from lags to distances that are known, by least squares.

    It says how well a lag measures a distance where the fronts are blurred: a width of the kick
    that delays both waves unlike is in the line, scatter and bends of the lags in its error.
    Raises `InputError` for fewer than three points.
    """
    lags, distances = np.asarray(lags_ps, dtype=float), np.asarray(distances_A, dtype=float)
    if len(lags) < 3 or len(np.unique(lags)) < 2:
        raise InputError(f"a ruler needs three different lags and more, found {len(lags)}")
    line = stats.linregress(lags, distances)
    residual = distances - line.intercept - line.slope * lags
    error = float(np.sqrt(np.sum(residual**2) / (len(lags) - 2)))
    return Ruler(float(line.slope), float(line.intercept), error)


class Trend(NamedTuple):
    """A straight line through measured values: slope with its 95 % interval."""

    slope: float
    low: float
    high: float
    at_mean: float


def trend(x: Sequence[float], y: Sequence[Measured]) -> Trend:
    """Return how measured values depend on a quantity, such as a speed on the temperature.

    Weighted least squares; where the values scatter by more than their errors say, the errors are
    scaled up by it. Two points have the errors' own interval.
    """
    values, sd = np.array([one.value for one in y]), np.array([one.sd for one in y])
    places = np.asarray(x, dtype=float)
    if len(places) != len(values) or len(np.unique(places)) < 2:
        raise InputError(f"a trend needs two or more different places, found {list(x)}")
    if not np.all(sd > 0):
        raise InputError("a trend needs the standard error of every value")
    weight = 1 / sd**2
    centre = float(np.sum(weight * places) / np.sum(weight))
    mean = float(np.sum(weight * values) / np.sum(weight))
    moment = float(np.sum(weight * (places - centre) ** 2))
    slope = float(np.sum(weight * (places - centre) * values)) / moment
    freedom = len(values) - 2
    residual = values - mean - slope * (places - centre)
    scale = max(1.0, float(np.sum(weight * residual**2)) / freedom) if freedom else 1.0
    quantile = (
        stats.t.ppf((1 + LEVEL) / 2, freedom) if scale > 1 else stats.norm.ppf((1 + LEVEL) / 2)
    )
    reach = float(quantile * np.sqrt(scale / moment))
    return Trend(slope, slope - reach, slope + reach, mean)


class Group(NamedTuple):
    """Values of one kind: how many, mean and standard error (infinite of one)."""

    number: int
    mean: float
    sd: float


def by_kind(kinds: Sequence[str], values: ArrayLike) -> dict[str, Group]:
    """Return the mean of values of each kind, such as stiffness by the two bases of a step."""
    numbers, names = np.asarray(values, dtype=float), np.asarray(kinds)
    found = {}
    for kind in dict.fromkeys(kinds):
        mine = numbers[names == kind]
        error = float(mine.std(ddof=1) / np.sqrt(len(mine))) if len(mine) > 1 else np.inf
        found[kind] = Group(len(mine), float(mine.mean()), error)
    return found
