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
    z1, z2 = first.axes[2], second.axes[2]
    hinge = cross(z1, z2)
    sine = norm(hinge)
    bend = np.arctan2(sine, dot(z1, z2))
    both = z1 + z2
    length = norm(both)
    opposed = length < _OPPOSED
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.where(opposed, np.nan, both / length)
        # bend/sin(bend) is 1 to round-off where the quotient itself would be 0/0.
        per_sine = np.where(sine > 1e-8, bend / sine, 1.0)
    u = _tip(first.axes[1], z1, z)
    v = _tip(second.axes[1], z2, z)
    twist = np.arctan2(dot(cross(u, v), z), dot(u, v))
    # From the half angle, not from u + v: that sum vanishes as the twist goes to 180 degrees.
    y = np.cos(twist / 2) * u + np.sin(twist / 2) * cross(z, u)
    x = cross(y, z)
    shift = second.origin - first.origin
    angles = np.stack([per_sine * dot(hinge, x), per_sine * dot(hinge, y), twist])
    values = np.concatenate(
        [np.stack([dot(shift, axis) for axis in (x, y, z)]), np.degrees(angles)]
    )
    middle = Frames((first.origin + second.origin) / 2, np.stack([x, y, z]))
    return RigidBodyParameters(values, middle, opposed)


def pair_parameters(strand_I: Frames, strand_II: Frames) -> RigidBodyParameters:
    """Return shear, stretch, stagger (Å), buckle, propeller, opening (degrees) of base pairs.

    Frames run over (pairs, ...). The mid-frames are the frames of the pairs: z along strand I.
    """
    x, y, z = strand_II.axes
    return rigid_body_parameters(Frames(strand_II.origin, np.stack([x, -y, -z])), strand_I)


def step_parameters(pairs: Frames) -> RigidBodyParameters:
    """Return shift, slide, rise (Å), tilt, roll, twist (degrees) between successive pairs.

    Frames run over (pairs, ...) in the order of strand I.
    """
    origin, axes = pairs
    return rigid_body_parameters(
        Frames(origin[:, :-1], axes[:, :, :-1]), Frames(origin[:, 1:], axes[:, :, 1:])
    )


def _tip(vector: Array, start: Array, end: Array) -> Array:
    """Turn a vector normal to the unit vector `start` by the shortest turn of start to end."""
    return vector - dot(vector, end) / (1 + dot(start, end)) * (start + end)
