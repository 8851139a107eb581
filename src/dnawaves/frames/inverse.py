"""Frames from rigid-body parameters: the inverse of `dnawaves.frames.parameters`.

Source: El Hassan & Calladine (1995) J. Mol. Biol. 251, 648-664. With the mid-frame M and the
bend b = (tilt, roll, 0) as a rotation vector in it, the two frames are M exp(-b/2) Rz(-twist/2)
and M exp(b/2) Rz(twist/2): no hinge, so that a bend of 0 is an ordinary case.
"""

from __future__ import annotations

import numpy as np

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.rotation import sum_of_axes, turned
from dnawaves.frames.vectors import Array


def pairs_from_steps(step_values: Array, first: Frames | None = None) -> Frames:
    """Return the frames (pairs, ...) of base pairs from the parameters of their steps.

    `step_values` is (6, steps, ...): shift, slide, rise (Å), tilt, roll, twist (degrees);
    `first` (...) is the frame of the first pair, by default origin and axes of the coordinates.
    Raises `InputError` for the wrong shape, for NaN, and for a bend of 180 degrees or more or a
    twist beyond 180, which no two frames give back.
    """
    _check(step_values, dimensions=2)
    here = _identity(step_values.shape[2:]) if first is None else first
    listed = [here]
    for step in range(step_values.shape[1]):
        tilt, roll, twist = np.radians(step_values[3:, step])
        zero = np.zeros_like(twist)
        half_twist = np.stack([zero, zero, twist / 2])
        half_bend = np.stack([tilt, roll, zero]) / 2
        middle = turned(turned(here.axes, half_twist), half_bend)
        origin = here.origin + sum_of_axes(middle, step_values[:3, step])
        here = Frames(origin, turned(turned(middle, half_bend), half_twist))
        listed.append(here)
    return Frames(
        np.stack([frame.origin for frame in listed], axis=1),
        np.stack([frame.axes for frame in listed], axis=2),
    )


def bases_from_pairs(pair_values: Array, pairs: Frames) -> tuple[Frames, Frames]:
    """Return the frames (pairs, ...) of the bases of strand I and of strand II.

    `pair_values` is (6, pairs, ...): shear, stretch, stagger (Å), buckle, propeller, opening
    (degrees), of the base pairs with the frames `pairs`. Raises `InputError` as `pairs_from_steps`.
    """
    _check(pair_values, dimensions=1)
    if pair_values.shape[1:] != pairs.origin.shape[1:]:
        raise InputError(
            f"pair parameters have shape {pair_values.shape}; "
            f"allowed: (6, {', '.join(map(str, pairs.origin.shape[1:]))}), one set for each frame"
        )
    buckle, propeller, opening = np.radians(pair_values[3:])
    zero = np.zeros_like(opening)
    half_bend = np.stack([buckle, propeller, zero]) / 2
    half_twist = np.stack([zero, zero, opening / 2])
    half_way = sum_of_axes(pairs.axes, pair_values[:3] / 2)
    strand_I = turned(turned(pairs.axes, half_bend), half_twist)
    x, y, z = turned(turned(pairs.axes, -half_bend), -half_twist)
    # The frame of strand II's own base: its y and z point the other way.
    strand_II = np.stack([x, -y, -z])
    return Frames(pairs.origin + half_way, strand_I), Frames(pairs.origin - half_way, strand_II)


def _identity(shape: tuple[int, ...]) -> Frames:
    identity = np.eye(3).reshape(3, 3, *np.ones(len(shape), dtype=int))
    return Frames(np.zeros((3, *shape)), np.broadcast_to(identity, (3, 3, *shape)).copy())


def _check(values: Array, dimensions: int) -> None:
    if values.ndim < dimensions or values.shape[0] != 6:
        what = "(6, steps)" if dimensions == 2 else "(6, pairs)"
        raise InputError(
            f"rigid-body parameters have shape {values.shape}; allowed: {what}, component first"
        )
    bend, turn = np.hypot(values[3], values[4]), np.abs(values[5])
    if not (np.all(bend < 180) and np.all(turn <= 180)):
        raise InputError(
            f"rigid-body parameters: found a bend up to {np.max(bend):.4g} and a turn up to"
            f" {np.max(turn):.4g} degrees; allowed: a bend (of tilt and roll, or of buckle and"
            " propeller, squares added) below 180 and a twist or opening of -180 to 180"
        )
