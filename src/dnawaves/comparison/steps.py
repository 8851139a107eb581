"""The step that puts all scenes' estimates into one table with verdicts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from dnawaves.comparison.compare import ADDED_TEXT, compare
from dnawaves.files import read_netcdf, whole_file
from dnawaves.scene.load import read_scene
from dnawaves.waves.constants.table import read_constants
from dnawaves.waves.table import CSV_FORMAT, TEXT_COLUMNS, read_table


def compare_step(
    speeds: Sequence[Path],
    scenes: Sequence[Path],
    structures: Sequence[Path],
    constants: Sequence[Path],
    output: Path,
) -> None:
    """Write the comparison of all scenes with the paper's rod and with the molecule's own.

    `speeds` are the scenes' tables, `scenes` their specifications, `structures` the inspections of
    their systems, `constants` the tables of their rods' constants, in the folders of the systems.
    """
    specs = [read_scene(path) for path in scenes]
    verdicts = {}
    for path in structures:
        attributes = read_netcdf(path).attrs
        verdicts[str(attributes["system"])] = str(attributes["verdict"])
    table = compare(
        [read_table(path) for path in speeds],
        {spec.name: spec for spec in specs},
        verdicts,
        {path.parent.name: read_constants(path) for path in constants},
    )
    with whole_file(output) as temporary:
        table.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def read_comparison(path: Path) -> pd.DataFrame:
    """Read the comparison; text columns are empty strings where nothing was written."""
    return read_table(path, (*TEXT_COLUMNS, *ADDED_TEXT))
