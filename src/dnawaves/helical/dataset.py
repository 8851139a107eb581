"""Helical parameters of a duplex over time, as a labelled data set."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.parameters import (
    PAIR_PARAMETERS,
    STEP_PARAMETERS,
    RigidBodyParameters,
    pair_parameters,
    step_parameters,
)
from dnawaves.frames.standard import standard_ring
from dnawaves.frames.vectors import Array
from dnawaves.helical.frames import base_frames
from dnawaves.helical.pairs import BasePair

# Frames of time worked on together: their arrays stay in the processor's cache.
_CHUNK = 200

NO_FRAME, OPPOSED = 1, 2
_FLAG_ATTRS = {
    "flag_values": [0, NO_FRAME, OPPOSED],
    "flag_meanings": "defined no_frame bend_of_180_degrees",
}
_CONVENTION = (
    "standard reference frame (Olson et al. 2001), mid-step parameters (El Hassan & Calladine"
    " 1995), as in 3DNA"
)


def helical_dataset(
    positions_A: NDArray[np.floating],
    pairs: Sequence[BasePair],
    time_ps: NDArray[np.floating] | None = None,
) -> xr.Dataset:
    """Return all base-pair and step parameters of one duplex.

    `positions_A` is (times, atoms, 3), indexed by the bases' `indices`; `pairs` go along
    strand I, 5' to 3'; without `time_ps` (times,) time has no coordinate. Variables: the six pair
    parameters (time, pair), the six step parameters (time, step), `origin` (time, pair,
    component) in Å, `axes` (time, pair, axis, component), `pair_flag` and `step_flag`: where
    these are not 0 a value is undefined, and NaN. Warns of bases with missing ring atoms.
    Raises `InputError` for arrays of the wrong shape.
    """
    if positions_A.ndim != 3 or positions_A.shape[2] != 3:
        raise InputError(f"positions are (times, atoms, 3), not {positions_A.shape}")
    if not pairs:
        raise InputError("no base pairs were given")
    times, count = len(positions_A), len(pairs)
    bases = [pair.first for pair in pairs] + [pair.second for pair in pairs]
    _warn_of_missing_atoms(pairs)
    pair_values = np.empty((6, times, count))
    step_values = np.empty((6, times, count - 1))
    origin = np.empty((times, count, 3))
    axes = np.empty((times, count, 3, 3))
    pair_flag = np.empty((times, count), dtype=np.int8)
    step_flag = np.empty((times, count - 1), dtype=np.int8)
    for begin in range(0, times, _CHUNK):
        now = slice(begin, begin + _CHUNK)
        frames = base_frames(positions_A[now], bases)
        in_pairs = pair_parameters(_part(frames, slice(count)), _part(frames, slice(count, None)))
        in_steps = step_parameters(in_pairs.middle)
        pair_values[:, now] = in_pairs.values.swapaxes(1, 2)
        step_values[:, now] = in_steps.values.swapaxes(1, 2)
        origin[now] = in_pairs.middle.origin.T
        axes[now] = in_pairs.middle.axes.transpose(3, 2, 0, 1)
        pair_flag[now] = _flags(in_pairs).T
        step_flag[now] = _flags(in_steps).T
    variables = {
        **_variables(PAIR_PARAMETERS, pair_values, "pair"),
        **_variables(STEP_PARAMETERS, step_values, "step"),
        "origin": (("time", "pair", "component"), origin, {"units": "angstrom"}),
        "axes": (("time", "pair", "axis", "component"), axes, {"units": "1"}),
        "pair_flag": (("time", "pair"), pair_flag, _FLAG_ATTRS),
        "step_flag": (("time", "step"), step_flag, _FLAG_ATTRS),
    }
    dataset = xr.Dataset(variables, _coordinates(pairs), {"convention": _CONVENTION})
    if time_ps is None:
        return dataset
    return dataset.assign_coords(time=("time", np.asarray(time_ps), {"units": "ps"}))


def _part(frames: Frames, bases: slice) -> Frames:
    return Frames(frames.origin[:, bases], frames.axes[:, :, bases])


def _flags(parameters: RigidBodyParameters) -> NDArray[np.int8]:
    undefined = np.isnan(parameters.values).any(axis=0)
    return np.where(parameters.opposed, OPPOSED, np.where(undefined, NO_FRAME, 0)).astype(np.int8)


def _variables(
    names: Sequence[str], values: Array, dimension: str
) -> dict[str, tuple[tuple[str, str], Array, dict[str, str]]]:
    units = ["angstrom"] * 3 + ["degree"] * 3
    return {
        name: (("time", dimension), value, {"units": unit})
        for name, value, unit in zip(names, values, units, strict=True)
    }


def _coordinates(pairs: Sequence[BasePair]) -> dict[str, object]:
    steps = list(pairwise(pairs))
    return {
        "pair": [pair.label for pair in pairs],
        "step": [f"{here.label}/{there.label}" for here, there in steps],
        "axis": ["x", "y", "z"],
        "component": ["x", "y", "z"],
        "pair_sequence": ("pair", [pair.sequence for pair in pairs]),
        "step_sequence": (
            "step",
            [
                f"{here.first.letter}{there.first.letter}/{there.second.letter}{here.second.letter}"
                for here, there in steps
            ],
        ),
    }


def _warn_of_missing_atoms(pairs: Sequence[BasePair]) -> None:
    for pair in pairs:
        for base in (pair.first, pair.second):
            missing = set(standard_ring(base.letter)) - set(base.atoms)
            if missing:
                outcome = "fitted to the rest" if len(base.atoms) >= 3 else "undefined"
                warnings.warn(
                    f"base {base.letter} {base.label} lacks {', '.join(sorted(missing))}:"
                    f" its frame is {outcome}",
                    stacklevel=3,
                )
