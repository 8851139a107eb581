"""The step that simulates one member of a scene, from files to files."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import scipy.sparse

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, write_netcdf
from dnawaves.scene.excitations import Static
from dnawaves.scene.load import read_scene
from dnawaves.scene.pairs import held_counts, span
from dnawaves.system.modes_file import read_modes
from dnawaves.system.relax import read_relaxed
from dnawaves.trajectory.checkpoint import checkpoint_folder
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.load import relax_under_load
from dnawaves.trajectory.plan import make_plan
from dnawaves.trajectory.record import SIGNS
from dnawaves.trajectory.run import kick_scale, run_member

# Estimators whose speed a sweep may start from.
FITTED = ("waveform", "standing wave")


def simulate_step(
    scene_json: Path,
    built: Path,
    relaxed: Path,
    hessian: Path,
    member: str,
    output: Path,
    trajectory: Path | None,
    fitted: Sequence[Path],
    threads: int,
    modes: Path | None = None,
) -> None:
    """Simulate one member of a scene; write its motion and, if asked for, its trajectories.

    A run that was killed goes on from the folder of checkpoints beside the output.

    `hessian` is read for a static load only, `modes` for a harmonic scene only. `trajectory` is a
    folder that gets one DCD file of base atoms for each sign; `fitted` are the tables of speeds of
    the scenes that a sweep names.
    """
    scene = read_scene(scene_json)
    duplex = read_relaxed(scene.system, built, relaxed).with_added_mass(
        {added.pair - 1: added.mass_Da for added in scene.masses}
    )
    attributes = read_netcdf(relaxed).attrs
    estimates = {
        wave: float(attributes[f"first_estimate_{wave}_A_per_ps"])
        for wave in ("extension", "twist")
    }
    first, last = span(scene.ends, duplex.pair_count)
    length_A = 10 * float(duplex.heights_nm[last] - duplex.heights_nm[first])
    speeds = [_fitted_speed(one) for one in fitted]
    plan = make_plan(scene, member, estimates, length_A, 10 * duplex.spacing_nm, speeds)
    if scene.method == "harmonic":
        if modes is None:
            raise InputError(f"scene '{scene.name}': method 'harmonic' needs the file of modes")
        shapes = read_modes(modes, duplex, held_counts(scene.ends))
        minimum = float(attributes["energy_kJ_per_mol"])
        scale = kick_scale(scene, member)
        write_netcdf(output, respond(duplex, shapes, scene, plan, scale, minimum))
        return
    if isinstance(scene.excitation, Static):
        matrix = scipy.sparse.load_npz(hessian).toarray()
        write_netcdf(output, relax_under_load(duplex, scene, plan, float(member[1:]), matrix))
        return
    checkpoints, files = checkpoint_folder(output), {}
    if trajectory is not None:
        partial = trajectory.with_name(f".partial.{trajectory.name}")
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        files = {SIGNS[name]: partial / f"{name}.dcd" for name in scene.signs}
    recorder = run_member(duplex, scene, plan, member, files, threads, checkpoints)
    if trajectory is not None:
        shutil.rmtree(trajectory, ignore_errors=True)
        partial.rename(trajectory)
    write_netcdf(output, recorder.dataset())
    # Last: until then a killed run goes on from there.
    shutil.rmtree(checkpoints, ignore_errors=True)


def _fitted_speed(speeds: Path) -> float:
    table = pd.read_csv(speeds)
    fitted = table.loc[table["estimator"].isin(FITTED), "speed_A_per_ps"].dropna()
    if fitted.empty:
        raise InputError(f"{speeds}: found no fitted speed; allowed: one by {' or '.join(FITTED)}")
    return float(fitted.iloc[0])
