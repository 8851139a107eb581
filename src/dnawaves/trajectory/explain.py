"""What a scene will run, before it runs: its forces, its size, its time and its disk space."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from dnawaves.duplex.build import build_duplex
from dnawaves.errors import InputError
from dnawaves.files import read_netcdf
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.excitations import Periodic, Pulse, Static
from dnawaves.scene.load import load_scenes
from dnawaves.scene.models import SceneSpec, SystemSpec
from dnawaves.scene.pairs import held_pairs, span
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import load_force_field
from dnawaves.trajectory.plan import Plan, make_plan
from dnawaves.trajectory.record import base_atoms
from dnawaves.trajectory.signed_copy import Copy

PURPOSES = {
    "HarmonicBondForce": "bond lengths",
    "HarmonicAngleForce": "bond angles",
    "PeriodicTorsionForce": "torsions and out-of-plane bending",
    "NonbondedForce": "Coulomb and Lennard-Jones forces",
    "GBSAOBCForce": "implicit solvent, OpenMM's own OBC2",
    "CustomGBForce": "implicit solvent with salt",
}
PROBE_STEPS = 300
# A base pair's displacement, rotation, velocity and angular velocity in double precision.
BYTES_PER_PAIR = 4 * 3 * 8
# A base atom's position in a DCD file.
BYTES_PER_ATOM = 3 * 4


def explain(config: Path, name: str, results: Path) -> str:
    """Return in words what the scene `name` of a configuration runs.

    The minimum is taken from the workflow's folder `results` where it has been relaxed.

    Raises
    ------
    InputError
        When the configuration is refused or has no scene of that name.
    """
    scenes = load_scenes(config)
    if name not in scenes:
        raise InputError(f"{config}: scene: found {name!r}; allowed: {', '.join(sorted(scenes))}")
    scene = scenes[name]
    duplex, speeds = _duplex_and_speeds(scene, results)
    plans = _plans(scene, duplex, speeds)
    lines = [
        f"scene {name}: {duplex.pair_count} base pairs in {scene.system.environment_name}",
        "forces:",
        *(f"  {force}: {PURPOSES[force]}" for force in force_names(duplex)),
    ]
    if isinstance(scene.excitation, Pulse | Periodic):
        lines.append("  inside the integrator: the drive, a pattern of forces times its course")
    lines += [
        _size(scene, duplex),
        f"runs: {len(scene.members)} ({', '.join(scene.members)}) x {len(scene.signs)} signs",
        *_length(scene, plans, relaxed=speeds is not None),
        *_price(scene, duplex, plans),
    ]
    return "\n".join(lines)


def force_names(duplex: SimulatedDuplex) -> list[str]:
    """Return the classes of the System's Force objects."""
    return [type(force).__name__ for force in duplex.system.getForces()]


def _duplex_and_speeds(
    scene: SceneSpec, results: Path
) -> tuple[SimulatedDuplex, dict[str, float] | None]:
    """Return the relaxed duplex with its first estimates, or the built one with None."""
    spec = scene.system
    built = SimulatedDuplex(
        spec, *build_duplex(spec.duplex.sequence, load_force_field(spec.environment))
    ).with_added_mass({added.pair - 1: added.mass_Da for added in scene.masses})
    relaxed = results / "systems" / spec.name / "relaxed.nc"
    if not relaxed.is_file():
        return built, None
    record = read_netcdf(relaxed, "position_nm")
    if SystemSpec.model_validate_json(record.attrs["spec"]) != spec:
        return built, None
    speeds = {
        wave: float(record.attrs[f"first_estimate_{wave}_A_per_ps"])
        for wave in ("extension", "twist")
    }
    return built.with_positions(record["position_nm"].values), speeds


def _plans(
    scene: SceneSpec, duplex: SimulatedDuplex, speeds: dict[str, float] | None
) -> list[Plan]:
    first, last = span(scene.ends, duplex.pair_count)
    length_A = 10 * float(duplex.heights_nm[last] - duplex.heights_nm[first])
    estimates = speeds or short_wave_speeds_A_per_ps(Rod.paper())
    # Stands in for the fits that a sweep will start from.
    fitted = [estimates[getattr(scene.excitation, "wave", "extension")] for _ in scene.needs]
    return [
        make_plan(scene, member, estimates, length_A, 10 * duplex.spacing_nm, fitted)
        for member in scene.members
    ]


def _size(scene: SceneSpec, duplex: SimulatedDuplex) -> str:
    held = held_pairs(scene.ends, duplex.pair_count)
    moving = int(np.sum(~np.isin(duplex.pairs, held)))
    freedom = 3 * moving
    if scene.ends.last == "guided":
        # The guided pair has one coordinate, its slide or turn.
        freedom += 1 - 3 * int(np.sum(duplex.pairs == duplex.pair_count - 1))
    return f"particles: {len(duplex.pairs)}, of which {moving} move: {freedom} degrees of freedom"


def _length(scene: SceneSpec, plans: list[Plan], relaxed: bool) -> list[str]:
    if isinstance(scene.excitation, Static):
        return ["length: one structure for each sign, relaxed under the load"]
    source = "the relaxed duplex's first estimate" if relaxed else "the paper's speeds for now"
    longest = max(plans, key=lambda plan: plan.steps)
    steps = f"{longest.steps} steps of {1e3 * longest.timestep_ps:g} fs, " * (
        scene.method == "simulated"
    )
    return [
        f"length: {longest.steps * longest.timestep_ps:.1f} ps, {steps}{longest.frames} frames, "
        f"by {source}"
    ]


def _price(scene: SceneSpec, duplex: SimulatedDuplex, plans: list[Plan]) -> list[str]:
    if isinstance(scene.excitation, Static):
        return ["time: that of a few minimisations; disk: less than 1 MB"]
    frames = len(scene.signs) * sum(plan.frames for plan in plans)
    disk = frames * duplex.pair_count * BYTES_PER_PAIR
    if scene.observation.helical:
        disk += frames * len(base_atoms(duplex)) * BYTES_PER_ATOM
    price = [f"disk: at most {disk / 1e6:.1f} MB"]
    if scene.method == "harmonic":
        return ["time: that of the normal modes, once for all scenes with these ends", *price]
    step_s = probe_s(scene, duplex, plans[0])
    steps = len(scene.signs) * sum(plan.steps for plan in plans)
    return [
        f"time: {steps} steps at {1e3 * step_s:.2f} ms, {steps * step_s / 60:.1f} min on one "
        "thread, without the relaxation",
        *price,
    ]


def probe_s(
    scene: SceneSpec, duplex: SimulatedDuplex, plan: Plan, steps: int = PROBE_STEPS
) -> float:
    """Return the time of one step in s, from a few with the scene's own forces and integrator."""
    # Nothing is put in: a structure that is not relaxed yet might explode under it.
    probe = Copy(duplex, scene, plan, 0.0, threads=1)
    probe.step(steps // 10)  # sets up what is reused
    started = time.perf_counter()
    probe.step(steps)
    probe.frame()  # waits for the steps
    return (time.perf_counter() - started) / steps
