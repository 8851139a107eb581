"""Response in time of one damped mode, in closed form: impulse, sine, Gaussian and sampled force.

A mode obeys q'' + g q' + w^2 q = f(t). Its responses from rest are divided differences, at the
two roots of s^2 - g s + w^2, of the response of the first-order system y' + s y = f. Written so,
they hold without change for undamped, underdamped, critical, overdamped and zero-frequency modes
and for a drive at resonance. All functions return q and q', (times, modes).
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.special import factorial, wofz

from dnawaves.errors import InputError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Response = tuple[FloatArray, FloatArray]

# n-th term of the series is below 1/(2 n!) for arguments inside the unit circle
SERIES_TERMS = 19
# below this gap a difference quotient of erfcx loses digits; Gauss-Legendre with six points does
# not: its error is of order (gap/2)^12
NEAR_GAP = 0.1
# beyond this modulus 16 terms of the asymptotic series of erfcx' reach round-off
ASYMPTOTIC_MODULUS = 9.0
ASYMPTOTIC_TERMS = 16
# complex division overflows by numbers below 1e-308; the limit at zero is exact long before
SMALLEST_DIVISOR = 1e-150
# a Gaussian force smaller than this neither moves a mode nor is worth a Faddeeva function
NEGLIGIBLE_FORCE = 1e-20


def impulse_response(
    times_ps: ArrayLike, frequencies_rad_per_ps: ArrayLike, friction_per_ps: float
) -> Response:
    """Return q and q' after q(0) = 0, q'(0) = 1, without further force."""
    t = _times_since_start(times_ps)
    slow, fast = _roots(frequencies_rad_per_ps, friction_per_ps)
    position = t * _exp_difference(-slow * t, -fast * t)
    velocity = np.exp(-fast * t) - slow * position
    return position.real, velocity.real


def sine_drive_response(
    times_ps: ArrayLike,
    frequencies_rad_per_ps: ArrayLike,
    friction_per_ps: float,
    drive_rad_per_ps: float,
    ramp_ps: float = 0.0,
) -> Response:
    """Return q and q' from rest under the force sin(drive t), transient included.

    While t < ramp the force is multiplied by (1 - cos(pi t/ramp))/2.
    """
    if not drive_rad_per_ps > 0:
        raise InputError(f"the drive's frequency is {drive_rad_per_ps} rad/ps; it must be positive")
    if not ramp_ps >= 0:
        raise InputError(f"the ramp of the drive lasts {ramp_ps} ps; it must not be negative")
    t = _times_since_start(times_ps)
    roots = _roots(frequencies_rad_per_ps, friction_per_ps)
    if ramp_ps == 0:
        position, velocity = _harmonic_drive(t, *roots, drive_rad_per_ps)
        return position.imag, velocity.imag
    # with r(t) = exp(iWt) (1 - cos(pi t/T))/2 from t = 0 on, the force is
    # Im[r(t) + exp(iWT) r(t - T)]: the second term fills up what the first lacks after the ramp
    rising = _rising_drive(t, *roots, drive_rad_per_ps, np.pi / ramp_ps)
    filling = _rising_drive(np.maximum(t - ramp_ps, 0), *roots, drive_rad_per_ps, np.pi / ramp_ps)
    position, velocity = rising + np.exp(1j * drive_rad_per_ps * ramp_ps) * filling
    return position.imag, velocity.imag


def gaussian_pulse_response(
    times_ps: ArrayLike,
    frequencies_rad_per_ps: ArrayLike,
    friction_per_ps: float,
    centre_ps: float,
    width_ps: float,
) -> Response:
    """Return q and q' under the force exp(-(t - centre)^2/(2 width^2)), at rest long before it.

    Times may lie before, within and after the pulse.
    """
    if not width_ps > 0:
        raise InputError(f"the width of the pulse is {width_ps} ps; it must be positive")
    u = np.asarray(times_ps, dtype=float).reshape(-1, 1) - centre_ps
    slow, fast = _roots(frequencies_rad_per_ps, friction_per_ps)
    of_fast = _gaussian_first_order(u, fast, width_ps)
    of_slow = of_fast.conj()
    near = (np.abs(fast - slow) * width_ps < NEAR_GAP * np.sqrt(2))[0]
    overdamped = (fast.imag == 0)[0] & ~near
    of_slow[:, overdamped] = _gaussian_first_order(u, slow[:, overdamped], width_ps)
    position = np.empty_like(of_fast)
    position[:, ~near] = ((of_slow - of_fast)[:, ~near]) / (fast - slow)[:, ~near]
    position[:, near] = _gaussian_near_roots(u, slow[:, near], fast[:, near], width_ps)
    velocity = of_fast - slow * position
    return position.real, velocity.real


def sampled_force_response(
    force: ArrayLike,
    interval_ps: float,
    frequencies_rad_per_ps: ArrayLike,
    friction_per_ps: float,
) -> Response:
    """Return q and q' at the times of the samples of the force (times,), from rest at the first.

    Exact for the cubic spline through the samples, which misses a smooth force by the fourth
    power of the interval.
    """
    samples = np.asarray(force, dtype=float)
    if samples.ndim != 1 or len(samples) < 2 or not np.isfinite(samples).all():
        raise InputError("a sampled force is a series of at least two finite numbers")
    if not interval_ps > 0:
        raise InputError(f"the interval of the force is {interval_ps} ps; it must be positive")
    _roots(frequencies_rad_per_ps, friction_per_ps)
    w = np.asarray(frequencies_rad_per_ps, dtype=float).ravel()
    # per interval: the force and its derivatives as numbers of the size of the force
    powers = np.arange(4)
    taylor = CubicSpline(np.arange(len(samples)), samples).c[::-1].T * factorial(powers)
    # displacements times `unit` are of the size of velocities: the exponential keeps its digits
    unit = np.maximum(w, 1 / interval_ps)
    generator = np.zeros((len(w), 6, 6))
    generator[:, 0, 1] = unit
    generator[:, 1, 0] = -(w**2) / unit
    generator[:, 1, 1] = -friction_per_ps
    generator[:, 1, 2] = 1.0
    generator[:, powers[:3] + 2, powers[:3] + 3] = 1 / interval_ps
    step = scipy.linalg.expm(generator * interval_ps)[:, :2]
    motion = np.zeros((len(samples), len(w), 2))
    for i, derivatives in enumerate(taylor):
        motion[i + 1] = np.einsum("mij,mj->mi", step[..., :2], motion[i])
        motion[i + 1] += step[..., 2:] @ derivatives
    return motion[..., 0] / unit, motion[..., 1]


def _times_since_start(times_ps: ArrayLike) -> FloatArray:
    """Return times as a column."""
    t = np.asarray(times_ps, dtype=float).reshape(-1, 1)
    if np.any(t < 0):
        raise InputError("times before the start of the motion are asked for")
    return t


def _roots(
    frequencies_rad_per_ps: ArrayLike, friction_per_ps: float
) -> tuple[ComplexArray, ComplexArray]:
    """Return the two roots s of s^2 - g s + w^2 as rows, the slower decay first."""
    if not friction_per_ps >= 0:
        raise InputError(f"the friction is {friction_per_ps} /ps; it must not be negative")
    w = np.asarray(frequencies_rad_per_ps, dtype=float).reshape(1, -1)
    half = friction_per_ps / 2
    # (half - w)(half + w) keeps the digits near critical damping, where the squares nearly cancel
    fast = half + np.sqrt(((half - w) * (half + w)).astype(complex))
    # their product is w^2: half - sqrt(...) would lose the slow root of an overdamped mode
    moving = np.abs(fast) > SMALLEST_DIVISOR
    slow = w * np.divide(w.astype(complex), fast, out=np.zeros_like(fast), where=moving)
    return slow, fast


def _harmonic_drive(
    t: FloatArray, slow: ComplexArray, fast: ComplexArray, drive: float
) -> ComplexArray:
    """Return q and q' from rest under exp(i drive t), stacked."""
    if drive < 0:
        return _harmonic_drive(t, slow, fast, -drive).conj()
    phase = np.asarray(1j * drive * t, dtype=np.complex128)
    position = t**2 * _exp_second_difference(-slow * t, -fast * t, phase)
    velocity = t * _exp_difference(-fast * t, phase) - slow * position
    return np.stack([position, velocity])


def _rising_drive(
    t: FloatArray, slow: ComplexArray, fast: ComplexArray, drive: float, ramp: float
) -> ComplexArray:
    """Return q and q' from rest under exp(i drive t) (1 - cos(ramp t))/2, stacked."""
    sides = [_harmonic_drive(t, slow, fast, drive + shift) for shift in (-ramp, ramp)]
    return _harmonic_drive(t, slow, fast, drive) / 2 - (sides[0] + sides[1]) / 4


def _gaussian_first_order(u: FloatArray, root: ComplexArray, width: float) -> ComplexArray:
    """Return y of y' + root y = exp(-u^2/(2 width^2)), (times, modes).

    y = width sqrt(pi/2) exp(-u^2/(2 width^2)) erfcx(z), z = (root width - u/width)/sqrt(2).
    """
    z = (root * width - u / width) / np.sqrt(2)
    force = np.broadcast_to(np.exp(-((u / width) ** 2) / 2), z.shape)
    # erfcx overflows on the left: there it is 2 exp(z^2) - erfcx(-z), and the first term is the
    # free motion after the pulse
    after = z.real < 0
    side = np.where(after, -1.0, 1.0)
    within = force > NEGLIGIBLE_FORCE
    y = np.zeros(z.shape, dtype=complex)
    y[within] = (side * force)[within] * wofz(1j * (side * z)[within])
    y[after] += 2 * np.exp((root * (root * width**2 / 2 - u))[after])
    return width * np.sqrt(np.pi / 2) * y


def _gaussian_near_roots(
    u: FloatArray, slow: ComplexArray, fast: ComplexArray, width: float
) -> ComplexArray:
    """Return the difference quotient of the first-order responses at two roots that nearly agree.

    The two parts of `_gaussian_first_order`, each divided by the gap before it can cancel.
    """
    z = (slow * width - u / width) / np.sqrt(2)
    gap = np.broadcast_to((fast - slow) * width / np.sqrt(2), z.shape)
    force = np.broadcast_to(np.exp(-((u / width) ** 2) / 2), z.shape)
    after = (z + gap / 2).real < 0
    side = np.where(after, -1.0, 1.0)
    within = force > NEGLIGIBLE_FORCE
    y = np.zeros(z.shape, dtype=complex)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    inside = [(side * (z + gap * (1 + node) / 2))[within] for node in nodes]
    slope = sum(weight / 2 * _erfcx_slope(x) for x, weight in zip(inside, weights, strict=True))
    y[within] = -width / np.sqrt(2) * force[within] * slope
    exponents = [np.where(after, root * (root * width**2 / 2 - u), 0) for root in (slow, fast)]
    free = (u - (slow + fast) * width**2 / 2) * _exp_difference(*exponents)
    return width * np.sqrt(np.pi / 2) * (y + np.where(after, 2 * free, 0))


def _erfcx_slope(z: ComplexArray) -> ComplexArray:
    """Return erfcx'(z) = 2 z erfcx(z) - 2/sqrt(pi), for Re z not far below 0."""
    slope = 2 * z * wofz(1j * z) - 2 / np.sqrt(np.pi)
    far = np.abs(z) > ASYMPTOTIC_MODULUS
    k = np.arange(1, ASYMPTOTIC_TERMS)
    # (-1)^k (2k + 1)!!/2^k
    terms = np.concatenate([[1.0], np.cumprod(-(2 * k + 1) / 2)])
    inverse_square = 1 / z[far] ** 2
    slope[far] = -inverse_square / np.sqrt(np.pi) * np.polyval(terms[::-1], inverse_square)
    return slope


def _exp_difference(x: ComplexArray, y: ComplexArray) -> ComplexArray:
    """Return (e^y - e^x)/(y - x), also where x = y."""
    x, y = np.broadcast_arrays(x, y)
    # the larger exponential is taken out, so that expm1 never overflows
    swapped = y.real > x.real
    largest = np.where(swapped, y, x)
    z = np.where(swapped, x, y) - largest
    ratio = np.divide(np.expm1(z), z, out=np.ones_like(z), where=np.abs(z) > SMALLEST_DIVISOR)
    return np.exp(largest) * ratio


def _exp_second_difference(x: ComplexArray, y: ComplexArray, z: ComplexArray) -> ComplexArray:
    """Return the divided difference of exp at x, y, z, where |z - y| >= |x|, |y|, |z|."""
    gap = np.broadcast_to(z - y, np.broadcast_shapes(x.shape, y.shape, z.shape))
    near = np.abs(gap) < 1.0
    difference = _exp_difference(x, z) - _exp_difference(x, y)
    result = np.divide(difference, gap, out=np.zeros_like(difference), where=~near)
    points = [np.broadcast_to(point, gap.shape)[near] for point in (x, y, z)]
    result[near] = _exp_second_difference_series(*points)
    return result


def _exp_second_difference_series(
    x: ComplexArray, y: ComplexArray, z: ComplexArray
) -> ComplexArray:
    """Return the same for points inside the unit circle, where the difference would cancel.

    Sum of h_n(x, y, z)/(n + 2)! with the complete homogeneous symmetric polynomials h_n.
    """
    one = two = three = np.ones_like(x)
    factor = 2.0
    total = three / factor
    for n in range(1, SERIES_TERMS):
        one = one * x
        two = one + y * two
        three = two + z * three
        factor *= n + 2
        total = total + three / factor
    return total
