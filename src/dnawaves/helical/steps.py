"""Helical parameters of structure and trajectory files, as a file."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from MDAnalysis import Universe
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from dnawaves.errors import InputError
from dnawaves.files import provenance
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.blocks import render_blocks
from dnawaves.helical.output import csv_output, netcdf_output
from dnawaves.helical.pair_list import read_pairs
from dnawaves.helical.table import Tables


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
    files that MDAnalysis cannot read (together), for `find_pairs`' reasons, and for a choice of
    frames or an output that there is not.
    """
    if output.suffix not in (".nc", ".csv"):
        raise InputError(f"{output}: found the ending {output.suffix!r}; allowed are .nc and .csv")
    listed = None if pairs is None else read_pairs(pairs)
    universe = _read(topology, trajectories)
    frames = _chosen(universe, start, stop, step)
    with _naming(*(path for path in (topology, pairs) if path is not None)):
        universe.trajectory[frames[0]]
        analysis = HelicalParameters(universe, listed, keep_frames)
    console = Console(stderr=True)
    for note in analysis.precision.values():
        console.print(f"Note: {note}", highlight=False, soft_wrap=True)
    with _naming(*(trajectories or [topology])), _progress(console, len(frames)) as advance:
        if output.suffix == ".csv":
            with csv_output(output) as append_rows:
                tables = Tables(analysis.duplexes)
                for length, rows in render_blocks(analysis, frames, tables, workers):
                    append_rows(rows)
                    advance(length)
        else:
            with netcdf_output(output) as append:
                for length, block in render_blocks(analysis, frames, _with_versions, workers):
                    append(block)
                    advance(length)


def _with_versions(dataset: xr.Dataset) -> xr.Dataset:
    return dataset.assign_attrs(provenance("MDAnalysis", "numpy"))


def _read(topology: Path, trajectories: Sequence[Path]) -> Universe:
    names = [str(path) for path in trajectories]
    try:
        with warnings.catch_warnings():
            # Of MDAnalysis to its programmers; nothing that a user of a command can act on.
            warnings.simplefilter("ignore", DeprecationWarning)
            # A list of one file would be read as a chain, which costs time for nothing.
            universe = Universe(str(topology), *([names] if len(names) > 1 else names))
        universe.trajectory  # noqa: B018 - asks whether there are coordinates
    except AttributeError:
        raise InputError(
            f"{topology}: holds no coordinates; needed is a trajectory beside it"
        ) from None
    except (EOFError, ImportError, LookupError, OSError, TypeError, ValueError) as error:
        if names:
            raise InputError(
                f"{', '.join(names)}: cannot be read with {topology}: {error}"
            ) from error
        raise InputError(f"{topology}: cannot be read: {error}") from error
    return universe


def _chosen(
    universe: Universe, start: int | None, stop: int | None, step: int | None
) -> np.ndarray:
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
