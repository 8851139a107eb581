"""Positions of a few atoms out of a trajectory, in chunks of frames."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from MDAnalysis.coordinates.base import ProtoReader
from MDAnalysis.coordinates.chain import ChainReader
from MDAnalysis.coordinates.DCD import DCDReader
from MDAnalysis.lib.mdamath import triclinic_box
from numpy.typing import NDArray

from dnawaves.helical.dcd import open_plain


class Chunk(NamedTuple):
    """Positions (frames, atoms, 3) in Å, boxes (frames, 6) or None, and times (frames,) in ps."""

    positions_A: NDArray[np.float32]
    boxes: NDArray[np.floating] | None
    times_ps: NDArray[np.float64]


def read_chunks(
    trajectory: ProtoReader, frames: NDArray[np.int64], indices: NDArray[np.int64], size: int
) -> Iterator[Chunk]:
    """Yield the atoms `indices` at `frames`, at most `size` frames at once.

    DCD files, alone or chained, are read many frames at once; the loop over frames, ten times as
    slow, serves every other format, unusual DCD files and trajectories with transformations.
    """
    parts = _dcd_parts(trajectory)
    files = [open_plain(Path(part.filename)) for part in parts]
    begins = np.cumsum([0] + [part.n_frames for part in parts])
    for begin in range(0, len(frames), size):
        now = frames[begin : begin + size]
        number = int(np.searchsorted(begins, now[0], side="right")) - 1
        ascending = bool(np.all(np.diff(now) > 0))
        if ascending and number < len(files) and now[-1] < begins[number + 1]:
            file, local = files[number], now - begins[number]
            if file is not None:
                positions_A, cells = file.read(local, indices)
                boxes = None if cells is None or not cells.any() else _boxes(cells)
                times_ps = _start_ps(trajectory, number) + local * parts[number].dt
                yield Chunk(positions_A, boxes, times_ps)
                continue
        yield _read_frames(trajectory, now, indices)


def _dcd_parts(trajectory: ProtoReader) -> list[DCDReader]:
    """Return the DCD files one after the other, none where anything else is to be done."""
    parts = trajectory.readers if isinstance(trajectory, ChainReader) else [trajectory]
    plain = all(type(part) is DCDReader and not part.transformations for part in parts)
    whole = sum(part.n_frames for part in parts) == trajectory.n_frames
    return list(parts) if plain and whole and not trajectory.transformations else []


def _start_ps(trajectory: ProtoReader, part: int) -> float:
    """Return the time of the first frame of a part, as its reader or the chain counts it."""
    if isinstance(trajectory, ChainReader):
        return float(trajectory.total_times[:part].sum())
    present = trajectory.ts
    return float(present.time - present.frame * trajectory.dt)


def _boxes(cells: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return lengths and angles of unit cells as DCD files of NAMD and CHARMM hold them.

    A, gamma, B, beta, alpha, C with angles in degrees or their cosines; or, told by a negative
    number or an angle above 180, the symmetric box matrix.
    """
    boxes = cells[:, [0, 2, 5, 4, 3, 1]].copy()
    cosines = np.all(np.abs(boxes[:, 3:]) <= 1, axis=1)
    boxes[cosines, 3:] = 90 - np.degrees(np.arcsin(boxes[cosines, 3:]))
    matrices = ~cosines & ((boxes < 0).any(axis=1) | (boxes[:, 3:] > 180).any(axis=1))
    for number in np.flatnonzero(matrices):
        cell = cells[number]
        boxes[number] = triclinic_box(cell[[0, 1, 3]], cell[[1, 2, 4]], cell[[3, 4, 5]])
    return boxes


def _read_frames(
    trajectory: ProtoReader, frames: NDArray[np.int64], indices: NDArray[np.int64]
) -> Chunk:
    positions_A = np.empty((len(frames), len(indices), 3), dtype=np.float32)
    boxes = np.zeros((len(frames), 6))
    times_ps = np.empty(len(frames))
    for number, timestep in enumerate(trajectory[frames]):
        positions_A[number] = timestep.positions[indices]
        if timestep.dimensions is not None:
            boxes[number] = timestep.dimensions
        times_ps[number] = trajectory.time
    return Chunk(positions_A, boxes if boxes.any() else None, times_ps)
