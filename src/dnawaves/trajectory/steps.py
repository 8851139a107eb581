"""The step that simulates one member of a scene, from files to files."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import scipy.sparse

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, write_netcdf
from dnawaves.scene.excitations import Static
from dnawaves.scene.load import read_scene
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import held_counts
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.guided import STATIC_WAVES
from dnawaves.system.modes_file import read_modes
from dnawaves.system.relax import read_relaxed
from dnawaves.system.snapshots import read_equilibrated, read_mean
from dnawaves.trajectory.checkpoint import checkpoint_folder
from dnawaves.trajectory.dynamics import find_platform
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.load import relax_under_load
from dnawaves.trajectory.plan import plan_of
from dnawaves.trajectory.record import SIGNS
from dnawaves.trajectory.run import kick_scale, run_member, snapshot_of

# Estimators whose speed a sweep may start from.
FITTED = ("waveform", "standing wave")


def simulate_step(
    scene_json: Path,
    built: Path,
    start: Path,
    member: str,
    output: Path,
    trajectory: Path | None,
    fitted: Sequence[Path],
    threads: int,
    hessian: Path | None = None,
    modes: Path | None = None,
    platform: str = "CPU",
) -> None:
    """Simulate one member of a scene; write its motion and, if asked for, its trajectories.

    A run that was killed goes on from the folder of checkpoints beside the output.

    `start` is the relaxed minimum, or above 0 K the equilibrated snapshots. `hessian` is read for a
    static load only, `modes` for a harmonic scene only. `trajectory` is a folder that gets one DCD
    file of base atoms for each sign; `fitted` are the tables of speeds of the scenes that a sweep
    names.
    """
    scene = read_scene(scene_json)
    find_platform(platform)
    duplex = read_start(scene, built, start, member)
    attributes = read_netcdf(start).attrs
    # The same for every snapshot, so that replicas can be averaged frame by frame.
    typical = read_mean(scene.system, built, start) if scene.system.thermal else duplex
    speeds = [_fitted_speed(one) for one in fitted]
    plan = plan_of(typical, scene, member, first_estimates_in(attributes), speeds)
    if scene.method == "harmonic":
        if modes is None:
            raise InputError(f"scene '{scene.name}': method 'harmonic' needs the file of modes")
        shapes = read_modes(modes, duplex, held_counts(scene.ends))
        minimum = float(attributes["energy_kJ_per_mol"])
        scale = kick_scale(scene, member)
        write_netcdf(output, respond(duplex, shapes, scene, plan, scale, minimum))
        return
    if isinstance(scene.excitation, Static):
        if hessian is None:
            raise InputError(f"scene '{scene.name}': a static load needs the file of the Hessian")
        matrix = scipy.sparse.load_npz(hessian).toarray()
        write_netcdf(
            output, relax_under_load(duplex, scene, plan, kick_scale(scene, member), matrix)
        )
        return
    checkpoints, files = checkpoint_folder(output), {}
    if trajectory is not None:
        partial = trajectory.with_name(f".partial.{trajectory.name}")
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        files = {SIGNS[name]: partial / f"{name}.dcd" for name in scene.signs}
    recorder = run_member(
        duplex, scene, plan, member, files, threads, checkpoints, platform=platform
    )
    if trajectory is not None:
        shutil.rmtree(trajectory, ignore_errors=True)
        partial.rename(trajectory)
    write_netcdf(output, recorder.dataset())
    # Last: until then a killed run goes on from there.
    shutil.rmtree(checkpoints, ignore_errors=True)


def read_start(scene: SceneSpec, built: Path, start: Path, member: str) -> SimulatedDuplex:
    """Return the duplex that a member starts from: at its minimum, or in the member's snapshot."""
    if scene.system.thermal:
        duplex = read_equilibrated(scene.system, built, start, snapshot_of(member))
    else:
        duplex = read_relaxed(scene.system, built, start)
    if not scene.masses:
        return duplex
    loaded = duplex.with_added_mass({added.pair - 1: added.mass_Da for added in scene.masses})
    if duplex.velocities_nm_per_ps is None:
        return loaded
    # At the same temperature what is heavier is slower.
    velocities, atoms = duplex.velocities_nm_per_ps.copy(), slice(duplex.solute)
    velocities[atoms] *= np.sqrt(duplex.masses_Da[atoms] / loaded.masses_Da[atoms])[:, None]
    return replace(loaded, velocities_nm_per_ps=velocities)


def first_estimates_in(attributes: Mapping[str, Any]) -> dict[str, float]:
    """Return a system's first estimates of its speeds, Å/ps, from its file's attributes."""
    return {wave: float(attributes[f"first_estimate_{wave}_A_per_ps"]) for wave in STATIC_WAVES}


def _fitted_speed(speeds: Path) -> float:
    table = pd.read_csv(speeds)
    fitted = table.loc[table["estimator"].isin(FITTED), "speed_A_per_ps"].dropna()
    if fitted.empty:
        raise InputError(f"{speeds}: found no fitted speed; allowed: one by {' or '.join(FITTED)}")
    return float(fitted.iloc[0])
