"""Helical parameters over time, as a labelled data set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.helix import HELIX_PARAMETERS
from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.compute import Arrays, Duplexes
from dnawaves.helical.flags import FLAG_ATTRIBUTES
from dnawaves.helical.form import BasePair

_CONVENTION = (
    "standard reference frame (Olson et al. 2001), mid-step parameters (El Hassan & Calladine"
    " 1995), as in 3DNA (Lu & Olson 2003)"
)


def helical_dataset(
    positions_A: NDArray[np.floating],
    pairs: Sequence[BasePair],
    time_ps: NDArray[np.floating] | None = None,
) -> xr.Dataset:
    """Return all parameters and frames of base pairs whose coordinates are in memory.

    `positions_A` is (times, atoms, 3), indexed by the bases' `indices`, whole in one periodic
    image; without `time_ps` (times,) time has no coordinate. See `make_dataset` for what comes.
    Warns of bases with missing ring atoms. Raises `InputError` for arrays of the wrong shape.
    """
    if positions_A.ndim != 3 or positions_A.shape[2] != 3:
        raise InputError(f"positions are (times, atoms, 3), not {positions_A.shape}")
    duplexes = Duplexes(pairs)
    arrays = allocate(duplexes, len(positions_A))
    for begin in range(0, len(positions_A), duplexes.chunk):
        now = slice(begin, begin + duplexes.chunk)
        fill(arrays, now, duplexes(positions_A[now][:, duplexes.indices]))
    return make_dataset(arrays, duplexes, time_ps)


def allocate(duplexes: Duplexes, times: int) -> Arrays:
    """Return empty arrays for the result over so many times."""
    # In one piece: the kernel maps a large one in large pages, which is sooner done.
    return duplexes.views(np.empty(duplexes.bytes_per_time() * times, dtype=np.uint8), times)


def fill(arrays: Arrays, times: slice, chunk: Mapping[str, NDArray[np.generic]]) -> None:
    """Copy the result of a chunk to its times."""
    for name, values in arrays.items():
        values[..., times] = chunk[name]


def make_dataset(
    arrays: Arrays,
    duplexes: Duplexes,
    time_ps: NDArray[np.floating] | None = None,
    frame: NDArray[np.int64] | None = None,
    attributes: Mapping[str, str] | None = None,
) -> xr.Dataset:
    """Return the labelled data set of arrays as `Duplexes` gives them, without copying them.

    The six pair parameters (time, pair), the six step and six helical-axis parameters
    (time, step); `base_origin` and `base_axes` (time, strand, pair, ...), `origin` and `axes` of
    the pairs (time, pair, ...), `step_origin` and `step_axes` of the mid-steps, origins in Å,
    axes as (axis, component); `pair_flag` and `step_flag`, bits that `flag_meanings` names.
    What is undefined is NaN, and flagged.
    """
    count = len(duplexes.pairs)
    times = arrays["pair_flag"].shape[-1]
    bases = {
        name: values.reshape((*values.shape[:-2], 2, count, times))
        for name, values in arrays.items()
        if name.startswith("base_")
    }
    variables: dict[str, tuple[tuple[str, ...], NDArray[np.generic], Mapping[str, object]]] = {}
    for array, names, dimension in (
        ("pair_parameters", PAIR_PARAMETERS, "pair"),
        ("step_parameters", STEP_PARAMETERS, "step"),
        ("helix_parameters", HELIX_PARAMETERS, "step"),
    ):
        for number, name in enumerate(names):
            units = {"units": "angstrom" if number < 3 else "degree"}
            variables[name] = (("time", dimension), arrays[array][number].T, units)
    for name, what, along in (
        ("base_", bases, ("strand", "pair")),
        ("", arrays, ("pair",)),
        ("step_", arrays, ("step",)),
    ):
        if f"{name}origin" not in what:
            continue
        origin, axes = what[f"{name}origin"], what[f"{name}axes"]
        variables[f"{name}origin"] = (
            ("time", *along, "component"),
            np.moveaxis(origin, (-1, 0), (0, -1)),
            {"units": "angstrom"},
        )
        variables[f"{name}axes"] = (
            ("time", *along, "axis", "component"),
            np.moveaxis(axes, (-1, 0, 1), (0, -2, -1)),
            {"units": "1"},
        )
    for dimension in ("pair", "step"):
        name = f"{dimension}_flag"
        variables[name] = (("time", dimension), arrays[name].T, dict(FLAG_ATTRIBUTES))
    coordinates = _coordinates(duplexes)
    if bases:
        xyz = ["x", "y", "z"]
        coordinates |= {"strand": ["I", "II"], "axis": xyz, "component": xyz}
    if frame is not None:
        coordinates["frame"] = ("time", frame)
    if time_ps is not None:
        coordinates["time"] = ("time", np.asarray(time_ps), {"units": "ps"})
    return xr.Dataset(variables, coordinates, {"convention": _CONVENTION, **(attributes or {})})


def pair_frames(dataset: xr.Dataset, duplex: int = 1) -> Frames:
    """Return the base-pair frames of one duplex of a data set, over (pairs, times).

    `origin` (3, pairs, times) in Å and `axes` (axis, component, pairs, times), as `dnawaves.frames`
    takes them. Raises `InputError` for a data set without frames or without that duplex.
    """
    if "axes" not in dataset:
        raise InputError("the data set was made without frames: keep_frames=False, --no-frames")
    chosen = dataset["pair_duplex"].values == duplex
    if not chosen.any():
        raise InputError(
            f"duplex {duplex}: there are 1 to {int(dataset['pair_duplex'].max())} in the data set"
        )
    return Frames(
        dataset["origin"].transpose("component", "pair", "time").values[:, chosen],
        dataset["axes"].transpose("axis", "component", "pair", "time").values[:, :, chosen],
    )


def _coordinates(duplexes: Duplexes) -> dict[str, object]:
    pairs = duplexes.pairs
    steps = [(pairs[step], pairs[step + 1]) for step in duplexes.steps]
    return {
        "pair": [pair.label for pair in pairs],
        "step": [f"{here.label}/{there.label}" for here, there in steps],
        "pair_sequence": ("pair", [pair.sequence for pair in pairs]),
        "step_sequence": (
            "step",
            [
                f"{here.first.letter}{there.first.letter}/{there.second.letter}{here.second.letter}"
                for here, there in steps
            ],
        ),
        "pair_duplex": ("pair", [pair.duplex + 1 for pair in pairs]),
        "step_duplex": ("step", [here.duplex + 1 for here, _ in steps]),
    }
