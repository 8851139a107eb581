"""A few atoms out of a DCD file, many frames at once.

The format (CHARMM, NAMD, OpenMM): Fortran records of a unit cell of six doubles (if there is one),
then of x, y and z of all atoms in single precision, the same in each frame. Three times as fast
as the general reader of MDAnalysis.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from MDAnalysis.lib.formats.libdcd import DCDFile
from numpy.typing import NDArray

_MARKER = np.dtype("=i4")
# Read at once: small enough to be in the cache still when the atoms are picked.
_BUFFER_BYTES = 4 * 2**20


class PlainDcd:
    """A DCD file of plain layout and this machine's byte order; see `open_plain`."""

    def __init__(self, path: Path, atoms: int, frames: int, cells: bool) -> None:
        self._path, self._frames, self._cells = path, frames, cells
        record = [("begin", _MARKER), ("values", "=f4", (atoms,)), ("end", _MARKER)]
        cell = [("begin", _MARKER), ("values", "=f8", (6,)), ("end", _MARKER)]
        components = [(component, record) for component in "xyz"]
        self._frame = np.dtype([("cell", cell), *components] if cells else components)
        self._header = path.stat().st_size - frames * self._frame.itemsize

    def is_plain(self) -> bool:
        """Whether the records of the first and the last frame have the lengths they should."""
        if self._frames < 1 or self._header < 0:
            return False
        with open(self._path, "rb", buffering=0) as file:
            for number in (0, self._frames - 1):
                file.seek(self._header + number * self._frame.itemsize)
                (frame,) = np.fromfile(file, self._frame, 1)
                for name in self._frame.names or ():
                    record = frame[name]
                    if not record["begin"] == record["end"] == record["values"].nbytes:
                        return False
        return True

    def read(
        self, frames: NDArray[np.int64], indices: NDArray[np.int64]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64] | None]:
        """Return positions (frames, atoms, 3) in Å and unit cells (frames, 6) as in the file.

        `frames` ascend. In memory the component comes first.
        """
        values = np.empty((3, len(frames), len(indices)), dtype=np.float32)
        cells = np.empty((len(frames), 6)) if self._cells else None
        with open(self._path, "rb", buffering=0) as file:
            for now in self._runs(frames):
                file.seek(self._header + int(frames[now.start]) * self._frame.itemsize)
                read = np.fromfile(file, self._frame, now.stop - now.start)
                for number, component in enumerate("xyz"):
                    # "clip" only spares a copy: the indices are those of atoms.
                    atoms = read[component]["values"]
                    np.take(atoms, indices, axis=1, out=values[number, now], mode="clip")
                if cells is not None:
                    cells[now] = read["cell"]["values"]
        return values.transpose(1, 2, 0), cells

    def _runs(self, frames: NDArray[np.int64]) -> list[slice]:
        """Return stretches of successive frames, at most a buffer long."""
        most = max(1, _BUFFER_BYTES // self._frame.itemsize)
        begins = [0, *(np.flatnonzero(np.diff(frames) != 1) + 1).tolist(), len(frames)]
        return [
            slice(part, min(part + most, end))
            for begin, end in pairwise(begins)
            for part in range(begin, end, most)
        ]


def open_plain(path: Path) -> PlainDcd | None:
    """Return a DCD file of plain layout, or None where the layout is another."""
    with DCDFile(str(path)) as file:
        header = file.header
        plain = PlainDcd(path, header["natoms"], len(file), bool(header["is_periodic"]))
    return plain if plain.is_plain() else None
