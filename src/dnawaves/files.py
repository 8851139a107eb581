"""Output files that appear whole or not at all, and the record of what made them."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dnawaves.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` only if the block succeeds.

    Makes the folders on the way. Raises `InputError`, before the block, where no file can be made.
    """
    temporary = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.touch()
        temporary.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error}") from error
    if path.is_dir():
        raise InputError(f"{path}: cannot be written: it is a folder")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write `text` to `path`, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a mapping as indented JSON; NaN is refused (it is no JSON)."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON mapping."""
    content = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(content, dict):
        raise ValueError(f"{path}: expected a JSON object, found {type(content).__name__}")
    return content


def write_netcdf(path: Path, dataset: xr.Dataset) -> None:
    """Write a dataset as compressed NetCDF-4, whole or not at all."""
    encoding = {
        str(name): {"zlib": True, "complevel": 1}
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind == "f" and variable.ndim
    }
    with whole_file(path) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", encoding=encoding)


def read_netcdf(path: Path, *needed: str) -> xr.Dataset:
    """Read a NetCDF file into memory and close it.

    Raises `InputError` where it is no NetCDF file or lacks a needed variable.
    """
    import xarray as xr

    try:
        dataset = xr.load_dataset(path, engine="netcdf4")
    except OSError as error:
        raise InputError(f"{path}: cannot be read as NetCDF: {error}") from None
    missing = [name for name in needed if name not in dataset]
    if missing:
        raise InputError(
            f"{path}: found {', '.join(map(str, dataset.data_vars))}; "
            f"allowed: a file that holds {', '.join(missing)}"
        )
    return dataset


def digest(content: str | bytes) -> str:
    """Return the SHA-256 of a text or of bytes."""
    data = content.encode() if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()


def provenance(*packages: str) -> dict[str, str]:
    """Return the versions of dnawaves and of `packages`, for the attributes of an output."""
    return {f"version_{name}": version(name) for name in ("dnawaves", *packages)}
