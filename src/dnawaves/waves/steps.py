"""The step that analyses a scene, from files to files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, write_netcdf
from dnawaves.motion.fields import WAVE_COMPONENTS
from dnawaves.scene.excitations import Kick, Nothing, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.load import read_scene
from dnawaves.scene.models import SceneSpec
from dnawaves.waves.analyse import analyse
from dnawaves.waves.analyse_periodic import driven_mode
from dnawaves.waves.estimators.spectrum import frequency_wavenumber
from dnawaves.waves.paper_answer import paper_velocity
from dnawaves.waves.projections import mode_projection, standing_projection
from dnawaves.waves.record import Record
from dnawaves.waves.table import Estimate, write_table
from dnawaves.waves.thermal import averaged_records, thermal_maps


def analyse_step(scene_json: Path, motions: Sequence[Path], output: Path, waves: Path) -> None:
    """Analyse a scene: write its table of speeds and the data of its figures.

    `motions` are the members' records in the scene's order.
    """
    scene = read_scene(scene_json)
    if len(motions) != len(scene.members):
        raise InputError(
            f"scene '{scene.name}': found {len(motions)} records; "
            f"allowed: one for each of {', '.join(scene.members)}"
        )
    records = [
        Record(scene, member, _read_motion(motion, scene))
        for member, motion in zip(scene.members, motions, strict=True)
    ]
    write_netcdf(waves, figure_data(records))
    write_table(output, _labelled(scene, analyse(records)))


def _labelled(scene: SceneSpec, rows: Iterable[Estimate]) -> list[Estimate]:
    return [replace(row, system=scene.system.name, method=scene.method) for row in rows]


def _read_motion(path: Path, scene: SceneSpec) -> xr.Dataset:
    motion = read_netcdf(path, "displacement", "rotation", "velocity", "angular_velocity")
    if SceneSpec.model_validate_json(motion.attrs["scene"]) != scene:
        raise InputError(
            f"{path}: found a record of {motion.attrs['scene']}; "
            f"allowed: one of {scene.model_dump_json()}"
        )
    return motion


def figure_data(records: Sequence[Record]) -> xr.Dataset:
    """Return what a scene's figures show: fields, maps and projections of one member.

    That is the first; of a periodic scene the one with the largest response.
    """
    thermal = records[0].scene.system.thermal
    members, records = records, averaged_records(records) if thermal else records
    first = records[0]
    excitation = first.scene.excitation
    if isinstance(excitation, Periodic):
        peaks = [
            np.abs(
                mode_projection(record, excitation.wave, driven_mode(record))[: record.usable]
            ).max(initial=0.0)
            for record in records
        ]
        first = records[int(np.argmax(peaks))]
    dataset = first.fields.copy()
    dataset.attrs = {
        "scene": first.scene.model_dump_json(),
        "usable_frames": first.usable,
        "length_A": first.length_A,
        "member": first.member,
    }
    if isinstance(excitation, Static):
        return dataset
    start, stop = first.span
    held = [end for end, pair in ((0, start), (-1, stop)) if pair in first.held]
    for wave in WAVE_COMPONENTS:
        velocity = first.velocity(wave)[: first.usable, start : stop + 1]
        if np.any(velocity) and first.usable > 1:
            power = frequency_wavenumber(
                first.times_ps[: first.usable], velocity, first.spacing_nm, tuple(held)
            )
            dataset[f"{wave}_power"] = power
            dataset.attrs["resolution_GHz"] = power.attrs["resolution_GHz"]
    if isinstance(excitation, Kick | StandingWave | Pulse):
        dataset[f"{excitation.wave}_paper"] = (
            ("time", "pair"),
            paper_velocity(first, excitation.wave, first.times_ps),
        )
    if isinstance(excitation, StandingWave):
        dataset["projection"] = ("time", standing_projection(first, excitation.wave))
    if isinstance(excitation, Periodic):
        drives = [float(record.motion.attrs["frequency_GHz"]) for record in records]
        dataset["response"] = ("drive", peaks)
        dataset = dataset.assign_coords(drive=("drive", drives, {"units": "GHz"}))
    if isinstance(excitation, Nothing):
        dataset.attrs["usable_frames"] = 0
        if thermal:
            dataset = dataset.assign(thermal_maps(members))
            dataset.attrs["resolution_GHz"] = dataset["extension_power"].attrs["resolution_GHz"]
    return dataset
