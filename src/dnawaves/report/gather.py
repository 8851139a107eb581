"""All that the report shows, read from the folder of results."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from dnawaves.comparison.compare import ONE
from dnawaves.comparison.steps import read_comparison
from dnawaves.errors import InputError
from dnawaves.files import read_netcdf
from dnawaves.scene.load import load_scenes
from dnawaves.scene.models import SceneSpec, SystemSpec
from dnawaves.waves.constants.table import read_constants

MODES = "velocity_structure_factor"


@dataclass(frozen=True)
class SystemResults:
    """A duplex: its inspection, what its start is like, its harmonic reference, its constants.

    `start` are the attributes of its minimum or of its equilibration. `segments` is the minimum's
    stiffness by length, `structure_factor` S(q, f) of its base pairs. `constants` are the rod's by
    route, `joint` those that the waves give, `costs` what each effect costs per step. What was
    not made is None.
    """

    spec: SystemSpec
    structure: xr.Dataset
    start: Mapping[str, Any]
    segments: pd.DataFrame | None
    structure_factor: xr.DataArray | None
    constants: pd.DataFrame
    joint: pd.DataFrame | None
    costs: pd.DataFrame | None


@dataclass(frozen=True)
class SceneResults:
    """A scene: its fields and spectra, its rows of the comparison, its helical parameters.

    `odd_helical` is half the difference of the two signs' helical parameters in the first run.
    """

    spec: SceneSpec
    waves: xr.Dataset
    rows: pd.DataFrame
    odd_helical: xr.Dataset | None

    @property
    def pairs(self) -> int:
        """Number of base pairs."""
        return int(self.waves.sizes["pair"])

    @property
    def spacing_A(self) -> float:
        """Mean distance of base pairs along the axis."""
        return float(self.waves.attrs["length_A"]) / (self.pairs - 1)

    def row(self, estimator: str) -> pd.Series | None:
        """Return the row of one estimator if it found a speed."""
        found = self.rows[
            (self.rows["estimator"] == estimator) & self.rows["speed_A_per_ps"].notna()
        ]
        return None if found.empty else found.iloc[0]


@dataclass(frozen=True)
class Job:
    """What one job of the workflow cost, as Snakemake measured it; None where it did not."""

    rule: str
    target: str
    run: str
    wall_s: float | None
    cpu_s: float | None
    memory_MB: float | None


@dataclass(frozen=True)
class Results:
    """Everything in the report, scenes in the configuration's order."""

    config: Path
    systems: Mapping[str, SystemResults]
    scenes: Mapping[str, SceneResults]
    table: pd.DataFrame
    jobs: list[Job]
    folder: Path

    def single(self, system: str) -> pd.DataFrame:
        """Return the estimates of one system by itself, without those of groups."""
        return self.table[(self.table["system"] == system) & (self.table["scope"] == ONE)]

    def spacing_A(self, system: str) -> float:
        """Return the spacing of base pairs of a system, as its scenes have it."""
        return next(
            scene.spacing_A for scene in self.scenes.values() if scene.spec.system.name == system
        )


def gather(config: Path, results: Path) -> Results:
    """Read the results of every scene of a configuration.

    Raises
    ------
    InputError
        When the results of a scene or system are not there.
    """
    specs = load_scenes(config)
    systems = {spec.system.name: spec.system for spec in specs.values()}
    table = read_comparison(_existing(results / "comparison.csv"))
    absent = [name for name in specs if name not in set(table["scene"])]
    if absent:
        raise InputError(
            f"{results / 'comparison.csv'}: found no rows of {', '.join(absent)}; "
            f"allowed: rows of every scene of {config}"
        )
    table = table[table["scene"].isin(list(specs))]
    return Results(
        config,
        {name: _system(results, spec) for name, spec in systems.items()},
        {name: _scene(results, spec, table) for name, spec in specs.items()},
        table,
        read_jobs(results / "benchmarks", [*specs, *systems]),
        results,
    )


def read_jobs(folder: Path, targets: Iterable[str]) -> list[Job]:
    """Return the costs of all jobs that concern these scenes and systems, in this order.

    That of an earlier report is none of them: this page's own comes later. A file is
    `<rule>/<target>.<run>.tsv`, `<rule>/<target>.tsv` or `<rule>.tsv`. What lies deeper belongs to
    a study, whose cases may be called as scenes are.
    """
    known = [*targets, ""]
    files = {*folder.glob("*.tsv"), *folder.glob("*/*.tsv")} - {folder / "report.tsv"}
    jobs = []
    for path in sorted(files):
        inside = path.parent != folder
        target, _, run = path.stem.partition(".") if inside else ("", "", "")
        if target not in known:
            continue
        with path.open(encoding="utf-8") as file:
            # A benchmark may be repeated: each line below the header is one run of the job.
            for line in csv.DictReader(file, delimiter="\t"):
                jobs.append(
                    Job(
                        path.parent.name if inside else path.stem,
                        target,
                        run,
                        *(_number(line.get(column)) for column in ("s", "cpu_time", "max_rss")),
                    )
                )
    return sorted(jobs, key=lambda job: (known.index(job.target), job.rule))


def _number(text: str | None) -> float | None:
    """Return a benchmark's number; Snakemake writes '-' or 'NA' for a job too short to measure."""
    return None if text in (None, "", "-", "NA") else float(str(text))


def _system(results: Path, spec: SystemSpec) -> SystemResults:
    folder = results / "systems" / spec.name
    structure = read_netcdf(_existing(folder / "structure.nc"))
    start = folder / ("equilibrated.nc" if spec.thermal else "relaxed.nc")
    modes = folder / "modes" / "0-0.nc"
    harmonic = None if spec.thermal else read_netcdf(_existing(modes), MODES)
    return SystemResults(
        spec,
        structure,
        read_netcdf(_existing(start)).attrs,
        _table(folder / "segments.csv"),
        None if harmonic is None else harmonic[MODES],
        read_constants(_existing(folder / "constants.csv")),
        _table(folder / "joint.csv"),
        _table(folder / "costs.csv"),
    )


def _table(path: Path) -> pd.DataFrame | None:
    return pd.read_csv(path) if path.is_file() else None


def _scene(results: Path, spec: SceneSpec, table: pd.DataFrame) -> SceneResults:
    folder = results / "scenes" / spec.name
    return SceneResults(
        spec,
        read_netcdf(_existing(folder / "waves.nc")),
        table[(table["scene"] == spec.name) & (table["scope"] == ONE)],
        _odd_helical(folder / spec.members[0]) if spec.observation.helical else None,
    )


def _odd_helical(run: Path) -> xr.Dataset | None:
    files = [run / f"{sign}.helical.nc" for sign in ("plus", "minus")]
    if not files[1].parent.is_dir() or not all(file.is_file() for file in files):
        return None
    plus, minus = (read_netcdf(file) for file in files)
    names = [str(name) for name, value in plus.items() if value.dims == ("time", "step")]
    values = [name for name in names if plus[name].dtype.kind == "f"]
    odd: xr.Dataset = 0.5 * (plus[values] - minus[values])
    for name in values:
        odd[name].attrs = plus[name].attrs
    return odd


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise InputError(f"{path}: not found; the report needs it: run the workflow first")
    return path
