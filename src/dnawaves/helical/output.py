"""Files of helical parameters, written block by block: memory does not grow with time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import netCDF4
import xarray as xr

from dnawaves.files import whole_file
from dnawaves.helical.table import PAIR_HEADER, STEP_HEADER

# Frames of time that lie together in the file.
_CHUNK_TIMES = 256


@contextmanager
def netcdf_output(path: Path) -> Iterator[Callable[[xr.Dataset], None]]:
    """Yield a function that appends a block along time to a NetCDF-4 file."""
    with whole_file(path) as temporary:
        yield lambda block: _append(temporary, block)


@contextmanager
def csv_output(path: Path) -> Iterator[Callable[[tuple[bytes, bytes]], None]]:
    """Yield a function that appends rows of steps and of pairs; see `pair_table_path`."""
    with (
        whole_file(pair_table_path(path)) as pairs_path,
        whole_file(path) as steps_path,
        open(pairs_path, "wb") as pairs,
        open(steps_path, "wb") as steps,
    ):
        steps.write(STEP_HEADER.encode())
        pairs.write(PAIR_HEADER.encode())

        def append(rows: tuple[bytes, bytes]) -> None:
            steps.write(rows[0])
            pairs.write(rows[1])

        yield append


def output_paths(path: Path) -> list[Path]:
    """Return all files that are written for an output: a CSV file has another beside it."""
    return [path, pair_table_path(path)] if path.suffix == ".csv" else [path]


def pair_table_path(path: Path) -> Path:
    """Return where the pair table goes, beside a step table: out.csv and out.pairs.csv."""
    return path.with_suffix(f".pairs{path.suffix}")


def _append(path: Path, block: xr.Dataset) -> None:
    if not path.exists():
        # Uncompressed but for the flags: the last digits of a trajectory are noise, which zlib
        # makes no smaller, and it takes ten times as long as all else.
        encoding: dict[str, dict[str, object]] = {}
        for name, variable in block.variables.items():
            if "time" in variable.dims:
                times = min(_CHUNK_TIMES, variable.shape[0])
                encoding[str(name)] = {"chunksizes": (times, *variable.shape[1:])}
                if variable.dtype.kind == "u":
                    encoding[str(name)] |= {"zlib": True, "complevel": 1}
        block.to_netcdf(path, engine="netcdf4", unlimited_dims=["time"], encoding=encoding)
        return
    with netCDF4.Dataset(path, "a") as file:
        begin = file.dimensions["time"].size
        end = begin + block.sizes["time"]
        for name, variable in block.variables.items():
            if "time" in variable.dims:
                file.variables[str(name)][begin:end] = variable.values
