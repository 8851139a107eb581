"""The step that writes what the theory says of a rod, from file to files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from dnawaves.errors import InputError
from dnawaves.files import provenance, whole_file, write_netcdf
from dnawaves.rod.constants import read_rod
from dnawaves.rod.dispersion_dataset import dispersion_dataset
from dnawaves.rod.rod import Rod
from dnawaves.rod.summary import (
    Duplex,
    constants_table,
    dispersion_table,
    modes_table,
    speeds_table,
    standing_table,
    travel_table,
)

WAVENUMBERS = 201
STANDING_MODES = 3
FORMATS = (".csv", ".nc")


def theory_step(
    rod_file: Path | None,
    duplex: Duplex,
    count: int,
    continuous: bool,
    dispersion: Path | None,
    modes: Path | None,
) -> str:
    """Return all tables as text; write the dispersion relation (CSV or NetCDF) and modes (CSV).

    `rod_file` is a YAML file of constants (see `dnawaves.rod.constants.RodConstants`); without one
    the rod is the paper's, with its intrinsic twist. Raises `InputError` for a bad file, a duplex
    of fewer than 2 base pairs, or an output of another format.
    """
    for path, allowed in ((dispersion, FORMATS), (modes, FORMATS[:1])):
        if path is not None and path.suffix not in allowed:
            raise InputError(f"{path}: found {path.suffix!r}; allowed: {' or '.join(allowed)}")
    rod = Rod.paper(twisted=True) if rod_file is None else read_rod(rod_file)
    vibrations = modes_table(rod, duplex, count)
    text = _text(rod, duplex, vibrations)
    if dispersion is not None:
        k = np.linspace(0, np.pi / rod.spacing_nm, WAVENUMBERS)
        dataset = dispersion_dataset(rod, k, lattice=not continuous)
        if dispersion.suffix == ".nc":
            write_netcdf(dispersion, dataset.assign_attrs(provenance("numpy")))
        else:
            _write_csv(dispersion_table(dataset), dispersion)
    if modes is not None:
        _write_csv(vibrations, modes)
    return text


def _text(rod: Rod, duplex: Duplex, vibrations: pd.DataFrame) -> str:
    what = f"{duplex.pairs} base pairs, {duplex.ends[0]}-{duplex.ends[1]}"
    parts = {
        "Rod": constants_table(rod),
        "Speeds": speeds_table(rod),
        f"Travel along {duplex.pairs} base pairs, long waves": travel_table(rod, duplex.pairs),
        f"Standing waves of the continuous rod averaged about its axis, {what}": standing_table(
            rod, duplex, STANDING_MODES
        ),
        f"Lowest modes of the lattice with all couplings, {what}": vibrations,
    }
    return "\n\n".join(f"{title}\n{_aligned(table)}" for title, table in parts.items())


def _aligned(table: pd.DataFrame) -> str:
    return str(table.to_string(index=False, float_format=lambda x: f"{x:.4g}", na_rep="-"))


def _write_csv(table: pd.DataFrame, path: Path) -> None:
    with whole_file(path) as temporary:
        table.to_csv(temporary, index=False, float_format="%.10g")
