"""Rigid-body parameters of base pairs and base-pair steps.

Source: the CEHS scheme, El Hassan & Calladine (1995) J. Mol. Biol. 251, 648-664, as in 3DNA,
Lu & Olson (2003) Nucleic Acids Res. 31, 5108-5121. Written so that a bend of exactly 0 and a
twist near 180 degrees are ordinary cases.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames
from dnawaves.frames.vectors import Array, cross, dot, norm

PAIR_PARAMETERS = ("shear", "stretch", "stagger", "buckle", "propeller", "opening")
STEP_PARAMETERS = ("shift", "slide", "rise", "tilt", "roll", "twist")

# |z1 + z2| below which the mid-plane's direction is round-off; a bend within 6e-7 deg of 180.
_OPPOSED = 1e-8

_DEGREES = 180 / np.pi


class RigidBodyParameters(NamedTuple):
    """Parameters (6, ...): three in Å, three in degrees; the mid-frames; where a bend is 180°."""

    values: Array
    middle: Frames
    opposed: NDArray[np.bool_]


def rigid_body_parameters(first: Frames, second: Frames) -> RigidBodyParameters:
    """Return the parameters that carry `first` into `second`, seen from their mid-frame.

    Order: along x, y, z; about x, y, z. Where the z axes are opposed (a bend of 180 degrees)
    the mid-frame does not exist: parameters and frame are NaN, `opposed` is True.
    """
    return _between(first.origin, first.axes[1:], second.origin, second.axes[1:])


def _between(first: Array, axes1: Array, second: Array, axes2: Array) -> RigidBodyParameters:
    """Return the parameters between two origins (3, ...) with axes y and z (2, 3, ...)."""
    z1, z2 = axes1[1], axes2[1]
    hinge = cross(z1, z2)
    sine = norm(hinge)
    bend = np.arctan2(sine, dot(z1, z2))
    z = z1 + z2
    length = norm(z)
    opposed = length < _OPPOSED
    with np.errstate(divide="ignore", invalid="ignore"):
        z /= np.where(opposed, np.nan, length)
        # bend/sin(bend) is 1 to round-off where the quotient itself would be 0/0.
        per_sine = np.where(sine > 1e-8, bend / sine, 1.0)
    # The cosine of half the bend, from z1 and from z2 to z.
    half = length / 2
    u = _tip(axes1[0], z1, z, half)
    v = _tip(axes2[0], z2, z, half)
    across = cross(z, u)
    cosine, sine = dot(u, v), dot(across, v)
    cosine_half, sine_half = _half_angle(cosine, sine)
    middle = np.empty((3, *z.shape))
    # From the half angle, not from u + v: that sum vanishes as the twist goes to 180 degrees.
    np.subtract(sine_half * u, cosine_half * across, out=middle[0])
    np.add(cosine_half * u, sine_half * across, out=middle[1])
    middle[2] = z
    shift = second - first
    values = np.empty((6, *bend.shape))
    for i in range(3):
        values[i] = dot(shift, middle[i])
    per_sine *= _DEGREES
    for i in range(2):
        values[3 + i] = per_sine * dot(hinge, middle[i])
    values[5] = _DEGREES * np.arctan2(sine, cosine)
    return RigidBodyParameters(values, Frames((first + second) / 2, middle), opposed)


def pair_parameters(strand_I: Frames, strand_II: Frames) -> RigidBodyParameters:
    """Return shear, stretch, stagger (Å), buckle, propeller, opening (degrees) of base pairs.

    Frames run over (pairs, ...). The mid-frames are the frames of the pairs: z along strand I.
    """
    return _between(strand_II.origin, -strand_II.axes[1:], strand_I.origin, strand_I.axes[1:])


def step_parameters(pairs: Frames) -> RigidBodyParameters:
    """Return shift, slide, rise (Å), tilt, roll, twist (degrees) between successive pairs.

    Frames run over (pairs, ...) in the order of strand I.
    """
    origin, axes = pairs
    return rigid_body_parameters(
        Frames(origin[:, :-1], axes[:, :, :-1]), Frames(origin[:, 1:], axes[:, :, 1:])
    )


def _tip(vector: Array, start: Array, end: Array, cosine: Array) -> Array:
    """Turn a vector normal to the unit vector `start` by the shortest turn of start to end.

    `cosine` is that of the turn.
    """
    return vector - (dot(vector, end) / (1 + cosine)) * (start + end)


def _half_angle(cosine: Array, sine: Array) -> tuple[Array, Array]:
    """Return cosine and sine of half an angle between -180 and 180 degrees."""
    larger = np.sqrt((1 + np.abs(cosine)) / 2)
    smaller = np.abs(sine) / (2 * larger)
    acute = cosine >= 0
    return np.where(acute, larger, smaller), np.copysign(np.where(acute, smaller, larger), sine)
