"""The step that writes what the theory says of a rod, from file to files."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

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
NOTHING_MOVES = "none: every base pair is held; --first free frees one"


def theory_step(
    rod_file: Path | None,
    duplex: Duplex,
    count: int,
    continuous: bool,
    dispersion: Path | None,
    modes: Path | None,
    tables: Path | None = None,
) -> str:
    """Return all tables as text; write the dispersion relation (CSV or NetCDF) and modes (CSV).

    The folder `tables` receives every printed table as CSV.

    `rod_file` is a YAML file of constants (see `dnawaves.rod.constants.RodConstants`); without one
    the rod is the paper's, with its intrinsic twist. Raises `InputError` for a bad file, a duplex
    of fewer than 2 base pairs, or an output of another format.
    """
    for path, allowed in ((dispersion, FORMATS), (modes, FORMATS[:1])):
        if path is not None and path.suffix not in allowed:
            raise InputError(f"{path}: found {path.suffix!r}; allowed: {' or '.join(allowed)}")
    rod = Rod.paper(twisted=True) if rod_file is None else read_rod(rod_file)
    printed = _tables(rod, duplex, count)
    if dispersion is not None:
        k = np.linspace(0, np.pi / rod.spacing_nm, WAVENUMBERS)
        dataset = dispersion_dataset(rod, k, lattice=not continuous)
        if dispersion.suffix == ".nc":
            write_netcdf(dispersion, dataset.assign_attrs(provenance("numpy")))
        else:
            _write_csv(dispersion_table(dataset), dispersion)
    if modes is not None:
        _write_csv(printed["modes"].table, modes)
    if tables is not None:
        for name, one in printed.items():
            _write_csv(one.table, tables / f"{name}.csv")
    return "\n\n".join(f"{one.title}\n{_aligned(one.table)}" for one in printed.values())


class _Printed(NamedTuple):
    title: str
    table: pd.DataFrame


def _tables(rod: Rod, duplex: Duplex, count: int) -> dict[str, _Printed]:
    what = f"{duplex.pairs} base pairs, {duplex.ends[0]}-{duplex.ends[1]}"
    length = f"{duplex.cells:g} spacings"
    kind = "averaged about its axis" if rod.omega0_rad_per_nm.any() else "without couplings"
    vibrations = modes_table(rod, duplex, count)
    shares = "shares of the kinetic energy" if len(vibrations) else NOTHING_MOVES
    return {
        "constants": _Printed("Rod", constants_table(rod)),
        "speeds": _Printed("Speeds; share of the elastic energy in the strain", speeds_table(rod)),
        "travel": _Printed(
            f"Travel along {duplex.pairs} base pairs, long waves", travel_table(rod, duplex.pairs)
        ),
        "standing": _Printed(
            f"Standing waves of the continuous rod {kind}, {what}: {length} long",
            standing_table(rod, duplex, STANDING_MODES),
        ),
        "modes": _Printed(
            f"Lowest modes of the lattice with all couplings, {what}; {shares}", vibrations
        ),
    }


def _aligned(table: pd.DataFrame) -> str:
    if table.empty:
        return "-"
    return str(table.to_string(index=False, float_format=lambda x: f"{x:.4g}", na_rep="-"))


def _write_csv(table: pd.DataFrame, path: Path) -> None:
    with whole_file(path) as temporary:
        table.to_csv(temporary, index=False, float_format="%.10g")
