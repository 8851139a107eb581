"""All rows of a study as two tables: settings of one model, and other models."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from dnawaves.accuracy.front import excess, on_front
from dnawaves.accuracy.row import OK, Row
from dnawaves.errors import InputError
from dnawaves.files import whole_file

MEASURES = ("speed", "waveform", "helical")
CSV_FORMAT = "%.5g"
COLUMNS = (
    *("setting", "line", "title", "label", "status", "slope", "case", "usual_case", "is_default"),
    *("declarable", "base_pairs", "atoms", "kind", "wave", "mode", "kicked_pairs", "amplitude"),
    *("record_ps", "platform", "precision", "integrator", "timestep_fs", "inner_steps"),
    *("friction_per_ps", "constraints", "hydrogen_mass_Da", "cutoff", "scale", "interval_fs"),
    "replicas",
    *(f"{name}_error" for name in (*MEASURES, "waveform_rms", "between_frames")),
    "helical_worst",
    *(f"{name}_integration_error" for name in (*MEASURES, "waveform_rms")),
    "helical_integration_worst",
    *("rate", "rise_A", "roll_deg", "twist_deg"),
    *("relative_cost", "relative_cost_low", "relative_cost_high", "cpu_s", "wall_s"),
    *("threads", "processor", "cores", "openmm"),
    *(f"{prefix}_{name}" for name in MEASURES for prefix in ("front", "excess")),
)


def tables(rows: Sequence[Row]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the table of settings, with its fronts, and that of models, with differences."""
    frame = pd.DataFrame(rows)
    frame = frame.reindex(columns=[*COLUMNS, "table"])
    settings = frame[frame["table"] == "settings"].drop(columns="table").reset_index(drop=True)
    models = frame[frame["table"] == "models"].drop(columns="table").reset_index(drop=True)
    return with_fronts(settings), with_differences(models)


def with_fronts(settings: pd.DataFrame) -> pd.DataFrame:
    """Return the settings with front and excess for each measure of error.

    A front is that of one case. Averages of thermal runs answer another question and stand apart,
    and so do settings that record at other times than the default does.
    """
    settings = settings.copy()
    comparable = settings["replicas"].isna() & at_usual_times(settings)
    for name in MEASURES:
        settings[f"front_{name}"] = False
        error = settings[f"{name}_error"]
        judged = (error > 0) & (settings["relative_cost"] > 0) & comparable
        for _, group in settings[judged].groupby("case"):
            costs, errors = group["relative_cost"], group[f"{name}_error"]
            beyond = excess(costs, errors)
            settings.loc[group.index, f"excess_{name}"] = beyond
            # Of settings that cost the same, the clock's noise must not put the worse on the front.
            settings.loc[group.index, f"front_{name}"] = on_front(costs, errors) & (beyond <= 0)
    return settings


def at_usual_times(settings: pd.DataFrame) -> pd.Series:
    """Return which settings record as often as the default, all where there is none."""
    usual = settings.loc[settings["is_default"].eq(True), "interval_fs"]
    return settings["interval_fs"].isin(usual) | (len(usual) == 0)


def with_differences(models: pd.DataFrame) -> pd.DataFrame:
    """Return the models with what differs from the default one's minimum and speed."""
    models = models.copy()
    default = models[models["is_default"].eq(True)]
    models["rate_change"] = float("nan")
    if len(default):
        first = default.iloc[0]
        models["rate_change"] = models["rate"] / first["rate"] - 1
        for name, unit in (("rise", "A"), ("roll", "deg"), ("twist", "deg")):
            models[f"{name}_change_{unit}"] = models[f"{name}_{unit}"] - first[f"{name}_{unit}"]
    return models


def write_csv(path: Path, table: pd.DataFrame) -> None:
    """Write a table, whole or not at all."""
    with whole_file(path) as temporary:
        table.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def read_csv(path: Path) -> pd.DataFrame:
    """Read a table of settings or models.

    Raises `InputError`, with the command to run, where it is not there.
    """
    if not path.is_file():
        raise InputError(f"{path}: not found; `snakemake --cores 2 accuracy` makes it")
    text = ("setting", "line", "title", "label", "status", "slope", "case", "usual_case")
    return pd.read_csv(path, dtype=dict.fromkeys(text, str))


def succeeded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that could be run."""
    return table[table["status"] == OK]
