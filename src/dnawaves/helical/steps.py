"""Helical parameters of structure and trajectory files, as a file."""

from __future__ import annotations

import os
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from MDAnalysis import Universe
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from dnawaves.errors import InputError
from dnawaves.files import provenance
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.blocks import render_blocks
from dnawaves.helical.output import csv_output, netcdf_output, output_paths
from dnawaves.helical.pair_list import read_pairs
from dnawaves.helical.table import Tables

# What MDAnalysis warns of and a user of the command cannot or need not act on.
_NOISE = (
    r"1 A\^3 CRYST1 record",
    "Element information is missing",
    "Empty box",
    # The reader of coordinates says the same.
    "MMCIF model",
)


def helical_step(
    topology: Path,
    trajectories: Sequence[Path],
    output: Path,
    pairs: Path | None = None,
    start: int | None = None,
    stop: int | None = None,
    step: int | None = None,
    workers: int = 1,
    keep_frames: bool = True,
) -> None:
    """Write the helical parameters of every frame as NetCDF (.nc) or as two tables (.csv).

    Without a trajectory, those of the structure that `topology` holds. Raises `InputError` for
    files that MDAnalysis cannot read (together), for `find_pairs`' reasons, for a choice of
    frames that there are not, and for an output that cannot be written or is one of the inputs.
    """
    if output.suffix not in (".nc", ".csv"):
        raise InputError(f"{output}: found the ending {output.suffix!r}; allowed are .nc and .csv")
    told = [path for path in (topology, pairs) if path is not None]
    _refuse_overwriting([*told, *trajectories], output_paths(output))
    listed = None if pairs is None else read_pairs(pairs)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=DeprecationWarning, module="MDAnalysis")
        # Structures have no time.
        for message in _NOISE if trajectories else (*_NOISE, "Reader has no dt"):
            warnings.filterwarnings("ignore", message, UserWarning, "MDAnalysis")
        universe = _read(topology, trajectories)
        frames = _chosen(universe, start, stop, step)
        with _naming(*told):
            universe.trajectory[frames[0]]
            analysis = HelicalParameters(universe, listed, keep_frames)
        console = Console(stderr=True)
        for note in analysis.precision.values():
            console.print(f"Note: {note}", highlight=False, soft_wrap=True)
        _write(analysis, frames, output, workers, console, trajectories or [topology])


def _write(
    analysis: HelicalParameters,
    frames: NDArray[np.int64],
    output: Path,
    workers: int,
    console: Console,
    read: Sequence[Path],
) -> None:
    tables = output.suffix == ".csv"
    render: Callable[[xr.Dataset], Any] = Tables(analysis.duplexes) if tables else _with_versions
    opened: AbstractContextManager[Callable[[Any], None]] = (
        csv_output(output) if tables else netcdf_output(output)
    )
    with opened as append, _naming(*read), _progress(console, len(frames)) as advance:
        for length, part in render_blocks(analysis, frames, render, workers):
            append(part)
            advance(length)


def _refuse_overwriting(inputs: Sequence[Path], outputs: Sequence[Path]) -> None:
    for written in outputs:
        for read in inputs:
            both_exist = os.path.exists(written) and os.path.exists(read)
            if both_exist and os.path.samefile(written, read):
                raise InputError(
                    f"{written}: would be written, but it is read as {read}; choose another"
                    " --output (a table .csv has .pairs.csv beside it)"
                )


def _with_versions(dataset: xr.Dataset) -> xr.Dataset:
    return dataset.assign_attrs(provenance("MDAnalysis", "numpy"))


def _read(topology: Path, trajectories: Sequence[Path]) -> Universe:
    names = [str(path) for path in trajectories]
    try:
        # A list of one file would be read as a chain, which costs time for nothing.
        universe = Universe(str(topology), *([names] if len(names) > 1 else names))
        universe.trajectory  # noqa: B018 - asks whether there are coordinates
    except AttributeError:
        raise InputError(
            f"{topology}: holds no coordinates; needed is a trajectory beside it"
        ) from None
    except (EOFError, ImportError, LookupError, OSError, TypeError, ValueError) as error:
        _delete_quietly(error)
        if names:
            raise InputError(
                f"{', '.join(names)}: cannot be read with {topology}: {error}"
            ) from error
        raise InputError(f"{topology}: cannot be read: {error}") from error
    return universe


def _delete_quietly(error: Exception) -> None:
    """Delete the reader that failed to open its file: its `__del__` fails too, and says so."""
    hook, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        traceback.clear_frames(error.__traceback__)
    finally:
        sys.unraisablehook = hook


def _chosen(
    universe: Universe, start: int | None, stop: int | None, step: int | None
) -> NDArray[np.int64]:
    try:
        chosen = range(*universe.trajectory.check_slice_indices(start, stop, step))
    except (TypeError, ValueError) as error:
        raise InputError(f"--start, --stop, --step: {error}") from None
    if not chosen:
        raise InputError(
            f"--start {start}, --stop {stop}, --step {step} choose none of the"
            f" {universe.trajectory.n_frames} frames"
        )
    return np.array(chosen)


@contextmanager
def _naming(*files: Path) -> Iterator[None]:
    """Say in an error's message which files it is about."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{', '.join(map(str, files))}: {error}") from error


@contextmanager
def _progress(console: Console, frames: int) -> Iterator[Any]:
    """Yield a function that moves a progress bar, which is shown on terminals only."""
    columns = (TextColumn("{task.completed}/{task.total} frames"), BarColumn())
    with Progress(
        *columns, TimeRemainingColumn(), console=console, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task("frames", total=frames)
        yield lambda done: bar.advance(task, done)
