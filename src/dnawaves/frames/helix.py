"""Local helical parameters: the screw that carries one base pair into the next.

Source: 3DNA, Lu & Olson (2003) Nucleic Acids Res. 31, 5108-5121; inclination and tip as in
Lu, El Hassan & Hunter (1997) J. Mol. Biol. 273, 668-680; the axis by Chasles' theorem, Babcock
et al. (1994) J. Mol. Biol. 237, 125-156.

In the mid-step frame of the rotation vector all six are closed forms of the step's strains: the
axis h has the same components in both frames and between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames
from dnawaves.frames.rotation import sum_of_axes
from dnawaves.frames.strain import strains_between
from dnawaves.frames.vectors import Array, cross, dot, norm

HELIX_PARAMETERS = (
    "x_displacement",
    "y_displacement",
    "helical_rise",
    "inclination",
    "tip",
    "helical_twist",
)

# Rotation in rad below which the direction of its axis is round-off: 6e-7 deg.
_NO_ROTATION = 1e-8

_DEGREES = 180 / np.pi


class HelixParameters(NamedTuple):
    """Parameters (6, ...): three in Å, three in degrees; the axes; where there is no rotation.

    `middle` is the middle helical frame: its origin lies on the helical axis, its z runs along it.
    """

    values: Array
    middle: Frames
    unrotated: NDArray[np.bool_]


def helix_parameters(pairs: Frames) -> HelixParameters:
    """Return `HELIX_PARAMETERS` of the screws between successive pairs.

    Frames run over (pairs, ...) in the order of strand I.
    """
    origin, axes = pairs
    return screw_parameters(
        Frames(origin[:, :-1], axes[:, :, :-1]), Frames(origin[:, 1:], axes[:, :, 1:])
    )


def screw_parameters(first: Frames, second: Frames) -> HelixParameters:
    """Return the parameters of the screw that carries `first` into `second`.

    The axis is directed along the frames' z, so that the twist has a sign; an axis in the plane
    of x and y (inclination, tip or a mixture of 90 degrees) has two directions, of which the one
    with a positive twist is taken. Where nothing is rotated there is no axis: parameters and
    frame are NaN, `unrotated` is True.
    """
    strains, step_middle = strains_between(first, second)
    gamma, omega = strains[:3], strains[3:]
    angle = norm(omega)
    unrotated = angle < _NO_ROTATION
    twist = np.where(unrotated, np.nan, np.where(omega[2] < 0, -angle, angle))
    h = omega / twist
    # From the axis to the first pair's origin, in that pair's frame: d = (exp(twist [h]) - 1) r.
    r = cross(gamma, h) / (2 * np.sin(twist / 2))
    x, y = _tipped_axes(h)
    sine = np.hypot(h[0], h[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        # angle/sin(angle) is 1 to round-off where the quotient itself would be 0/0.
        per_sine = np.where(sine > 1e-8, np.arctan2(sine, h[2]) / sine, 1.0)
    values = np.stack(
        [
            dot(r, x),
            dot(r, y),
            dot(h, gamma),
            np.degrees(per_sine * h[1]),
            np.degrees(-per_sine * h[0]),
            np.degrees(twist),
        ]
    )
    middle = Frames(
        step_middle.origin - sum_of_axes(step_middle.axes, np.cos(twist / 2) * r),
        np.stack([sum_of_axes(step_middle.axes, axis) for axis in (x, y, h)]),
    )
    return HelixParameters(values, middle, unrotated)


def helix_of_steps(values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return values and `unrotated` of `screw_parameters` from step parameters (6, ...).

    Shift to twist tell the screw: in the mid-step frame the turn is that of the bend (tilt, roll)
    halved, twist, and the other half, whose quaternion is
    (cos(G/2) cos(T/2), cos(T/2) sin(G/2) n, sin(T/2) z). Two and a half times as fast as by way of
    the frames.
    """
    along = values[:3]
    # Not np.hypot, which is ten times as slow: no square of an angle overflows.
    half_bend = np.sqrt(values[3] ** 2 + values[4] ** 2) / (2 * _DEGREES)
    half_twist = values[5] / (2 * _DEGREES)
    cosine_bend = np.cos(half_bend)
    cosine, sine = np.cos(half_twist), np.sin(half_twist)
    with np.errstate(divide="ignore", invalid="ignore"):
        per_angle = np.where(half_bend > 1e-8, np.sin(half_bend) / half_bend, 1.0)
    per_angle /= 2 * _DEGREES
    tilt, roll = per_angle * values[3], per_angle * values[4]
    h = np.empty_like(along)
    h[0], h[1], h[2] = cosine * tilt, cosine * roll, sine
    angle = norm(h)
    unrotated = angle < _NO_ROTATION / 2
    sine_half = np.where(unrotated, np.nan, np.copysign(angle, sine))
    cosine_half = cosine_bend * cosine
    h /= sine_half
    rise = dot(along, h)
    # From the axis to the first pair's origin: the way to half the screw, half the screw back.
    r = cross(along, h)
    r *= cosine_half / (2 * sine_half)
    r += (rise / 2) * h - along / 2
    # Along the axes of the first pair: half the bend forth, half the twist back.
    share = (tilt * r[0] + roll * r[1]) / (1 + cosine_bend)
    x = cosine_bend * r[0] + roll * r[2] + tilt * share
    y = cosine_bend * r[1] - tilt * r[2] + roll * share
    z = tilt * r[1] - roll * r[0] + cosine_bend * r[2]
    h_x, h_y, h_z = tilt / sine_half, roll / sine_half, cosine_bend * sine / sine_half
    lean = np.sqrt(h_x**2 + h_y**2)
    with np.errstate(divide="ignore", invalid="ignore"):
        per_sine = np.where(lean > 1e-8, np.arctan2(lean, h_z) / lean, 1.0)
    per_sine *= _DEGREES
    tipped = z / (1 + h_z)
    result = np.empty_like(values)
    result[0] = cosine * x - sine * y - h_x * tipped
    result[1] = sine * x + cosine * y - h_y * tipped
    result[2] = rise
    result[3] = per_sine * h_y
    result[4] = -per_sine * h_x
    result[5] = 2 * _DEGREES * np.arctan2(sine_half, cosine_half)
    return result, unrotated


def _tipped_axes(h: Array) -> tuple[Array, Array]:
    """Return the unit vectors along x and y after the shortest turn of z into the unit vector h."""
    share = 1 / (1 + h[2])
    mixed = -share * h[0] * h[1]
    x = np.stack([1 - share * h[0] ** 2, mixed, -h[0]])
    y = np.stack([mixed, 1 - share * h[1] ** 2, -h[1]])
    return x, y
