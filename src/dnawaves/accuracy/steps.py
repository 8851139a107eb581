"""The steps of a study, from files to files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import pandas as pd

from dnawaves.accuracy.row import measure
from dnawaves.accuracy.settings import LoadedStudy, load_study
from dnawaves.accuracy.start import Start, prepare_step, read_start
from dnawaves.accuracy.table import tables, write_csv
from dnawaves.accuracy.truth import (
    converged_answer,
    linear_answer,
    read_answers,
    write_answers,
)
from dnawaves.errors import InputError, SimulationError
from dnawaves.files import read_json, write_json
from dnawaves.trajectory.costs import costs

Known = TypeVar("Known")
COST_COLUMNS = ["system", "effect", "ms_per_step_without", "ms_per_step_whole", "ms_saved"]


def relax_system_step(study: Path, name: str, output: Path, threads: int) -> None:
    """Relax one system of a study."""
    systems = load_study(study).systems
    prepare_step(name, _named(study, "system", name, systems), output, threads)


def truth_step(study: Path, name: str, minimum: Path, output: Path) -> None:
    """Find the known answers of one case; none where its system has no minimum."""
    loaded = load_study(study)
    case = _named(study, "case", name, loaded.cases)
    start = _start(loaded, case.system, minimum)
    answers = {}
    if start is not None:
        truth = loaded.study.truth
        answers["linear"] = linear_answer(start, case, truth.interval_fs / 1e3)
        if case.converged:
            interval_fs = loaded.study.default.interval_fs
            answers["converged"] = converged_answer(start, case, truth, interval_fs)
    write_answers(output, answers)


def setting_step(
    study: Path, name: str, minimum: Path, usual: Path, known: Path, output: Path
) -> None:
    """Measure one setting and write its row."""
    loaded = load_study(study)
    setting = _named(study, "setting", name, loaded.settings)
    start = _start(loaded, setting.case.system, minimum)
    # What time is measured by must run; without its minimum there is no study.
    other = read_start(setting.usual.system, setting.usual_system, usual)
    write_json(output, measure(setting, start, other, read_answers(known)))


def costs_step(study: Path, name: str, minimum: Path, output: Path) -> None:
    """Measure what each effect of a system costs per step; an empty table without a minimum."""
    loaded = load_study(study)
    start = _start(loaded, _named(study, "system", name, {n: n for n in loaded.systems}), minimum)
    table = pd.DataFrame(columns=COST_COLUMNS)
    if start is not None:
        table = costs(start.duplex).assign(system=name)
    write_csv(output, table)


def tables_step(rows: Sequence[Path], settings: Path, models: Path) -> None:
    """Gather rows into the table of settings and that of models."""
    for path, table in zip(
        (settings, models), tables([read_json(row) for row in rows]), strict=True
    ):
        write_csv(path, table)


def _start(loaded: LoadedStudy, system: str, minimum: Path) -> Start | None:
    try:
        return read_start(system, loaded.study.systems[system], minimum)
    except SimulationError:
        return None


def _named(study: Path, kind: str, name: str, known: Mapping[str, Known]) -> Known:
    if name not in known:
        raise InputError(f"{study}: {kind}: found {name!r}; allowed: {', '.join(known)}")
    return known[name]
