"""What a scene will run, before it runs: its forces, its size, its time and its disk space."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from dnawaves.files import read_netcdf
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.excitations import Periodic, Pulse, Static
from dnawaves.scene.load import load_scene
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.constraints import degrees_of_freedom
from dnawaves.system.steps import built_structure
from dnawaves.trajectory.plan import Plan, plan_of
from dnawaves.trajectory.record import base_atoms
from dnawaves.trajectory.signed_copy import Copy, system_of
from dnawaves.trajectory.steps import first_estimates_in, read_start

PURPOSES = {
    "HarmonicBondForce": "bond lengths",
    "HarmonicAngleForce": "bond angles",
    "PeriodicTorsionForce": "torsions and out-of-plane bending",
    "NonbondedForce": "Coulomb and Lennard-Jones forces",
    "GBSAOBCForce": "implicit solvent, OpenMM's own OBC2",
    "CustomGBForce": "implicit solvent, OBC2 with salt or GBn2",
    "CustomExternalForce": "springs of the restrained ends",
}
PROBE_STEPS = 300
# A probe ends after this time even if it has not done all its steps.
PROBE_S = 5.0
# What is not relaxed yet might explode in steps of its own length.
CAUTIOUS_TIMESTEP_PS = 1e-5
# A base pair's displacement, rotation, velocity and angular velocity in double precision.
BYTES_PER_PAIR = 4 * 3 * 8
# A base atom's position in a DCD file.
BYTES_PER_ATOM = 3 * 4


def explain(config: Path, name: str, results: Path) -> str:
    """Return in words what the scene `name` of a configuration runs.

    The minimum or the first snapshot is taken from the workflow's folder `results` where it is.

    Raises
    ------
    InputError
        When the configuration is refused or has no scene of that name.
    """
    scene = load_scene(config, name)
    duplex, speeds = _duplex_and_speeds(scene, results)
    plans = _plans(scene, duplex, speeds)
    lines = [
        f"scene {name}: {duplex.pair_count} base pairs in {scene.system.environment_name}",
        "forces:",
        *(f"  {force}: {PURPOSES[force]}" for force in force_names(duplex, scene)),
    ]
    if isinstance(scene.excitation, Pulse | Periodic):
        lines.append("  inside the integrator: the drive, a pattern of forces times its course")
    if scene.thermostat is not None:
        lines.append(
            f"  inside the integrator: friction of {scene.thermostat.friction_per_ps:g} /ps and "
            f"noise of {scene.system.environment.temperature_K:g} K"
        )
    lines += [
        _size(scene, duplex),
        f"runs: {len(scene.members)} ({', '.join(scene.members)}) x {len(scene.signs)} signs",
        *_length(scene, plans, started=speeds is not None),
        *_price(scene, duplex, plans, started=speeds is not None),
    ]
    return "\n".join(lines)


def force_names(duplex: SimulatedDuplex, scene: SceneSpec) -> list[str]:
    """Return the classes of the Force objects of a scene's System."""
    return [type(force).__name__ for force in system_of(duplex, scene).getForces()]


def _duplex_and_speeds(
    scene: SceneSpec, results: Path
) -> tuple[SimulatedDuplex, dict[str, float] | None]:
    """Return the duplex that runs start from with its first estimates, or the built one, None."""
    spec = scene.system
    folder = results / "systems" / spec.name
    start = folder / ("equilibrated.nc" if spec.thermal else "relaxed.nc")
    if start.is_file() and (folder / "built.pdb").is_file():
        attributes = read_netcdf(start).attrs
        # As text: another version's may hold what this one does not know.
        if attributes.get("spec") == spec.model_dump_json():
            duplex = read_start(scene, folder / "built.pdb", start, scene.members[0])
            return duplex, first_estimates_in(attributes)
    topology, positions_nm = built_structure(spec)
    box = topology.getUnitCellDimensions()
    built = SimulatedDuplex(
        spec, topology, positions_nm, box_nm=None if box is None else np.array(box._value)
    )
    return built.with_added_mass({added.pair - 1: added.mass_Da for added in scene.masses}), None


def _plans(
    scene: SceneSpec, duplex: SimulatedDuplex, speeds: dict[str, float] | None
) -> list[Plan]:
    estimates = speeds or short_wave_speeds_A_per_ps(Rod.paper())
    # Stands in for the fits that a sweep will start from.
    fitted = [estimates[getattr(scene.excitation, "wave", "extension")] for _ in scene.needs]
    return [plan_of(duplex, scene, member, estimates, fitted) for member in scene.members]


def _size(scene: SceneSpec, duplex: SimulatedDuplex) -> str:
    system = system_of(duplex, scene)
    count, constraints = system.getNumParticles(), system.getNumConstraints()
    moving = sum(system.getParticleMass(index)._value > 0 for index in range(count))
    freedom = degrees_of_freedom(system)
    if scene.ends.last == "guided":
        # The guided pair has one coordinate, its slide or turn.
        freedom += 1 - 3 * int(np.sum(duplex.pairs == duplex.pair_count - 1))
    rigid = f" less {constraints} constraints" if constraints else ""
    return f"particles: {count}, of which {moving} move{rigid}: {freedom} degrees of freedom"


def _length(scene: SceneSpec, plans: list[Plan], started: bool) -> list[str]:
    if isinstance(scene.excitation, Static):
        return ["length: one structure for each sign, relaxed under the load"]
    start = "equilibrated" if scene.system.thermal else "relaxed"
    source = f"the {start} duplex's first estimate" if started else "the paper's speeds for now"
    longest = max(plans, key=lambda plan: plan.steps)
    steps = f"{longest.steps} steps of {1e3 * longest.timestep_ps:g} fs, " * (
        scene.method == "simulated"
    )
    return [
        f"length: {longest.steps * longest.timestep_ps:.1f} ps, {steps}{longest.frames} frames, "
        f"by {source}"
    ]


def _price(
    scene: SceneSpec, duplex: SimulatedDuplex, plans: list[Plan], started: bool
) -> list[str]:
    if isinstance(scene.excitation, Static):
        return ["time: that of a few minimisations; disk: less than 1 MB"]
    frames = len(scene.signs) * sum(plan.frames for plan in plans)
    disk = frames * duplex.pair_count * BYTES_PER_PAIR
    if scene.observation.helical:
        disk += frames * len(base_atoms(duplex)) * BYTES_PER_ATOM
    price = [f"disk: at most {disk / 1e6:.1f} MB"]
    if scene.method == "harmonic":
        return ["time: that of the normal modes, once for all scenes with these ends", *price]
    step_s = probe_s(scene, duplex, plans[0], started)
    steps = len(scene.signs) * sum(plan.steps for plan in plans)
    before = "equilibration" if scene.system.thermal else "relaxation"
    return [
        f"time: {steps} steps at {1e3 * step_s:.2f} ms, {steps * step_s / 60:.1f} min on one "
        f"thread, without the {before}",
        *price,
    ]


def probe_s(scene: SceneSpec, duplex: SimulatedDuplex, plan: Plan, started: bool = True) -> float:
    """Return the time of one step in s, from a few with the scene's own forces and integrator.

    `started` says that the duplex is where runs start from; as built it might explode.
    """
    if not started:
        plan = replace(plan, timestep_ps=CAUTIOUS_TIMESTEP_PS)
    # Nothing is put in.
    probe = Copy(duplex, scene, plan, 0.0, threads=1)
    portion = PROBE_STEPS // 20
    probe.step(2)  # sets up what is reused
    begun, steps = time.perf_counter(), 0
    while steps < PROBE_STEPS and time.perf_counter() - begun < PROBE_S:
        probe.step(portion)
        probe.dynamics.late_velocities()  # waits for the steps
        steps += portion
    return (time.perf_counter() - begun) / steps


def expected_cost(scene: SceneSpec, results: Path) -> tuple[float, int]:
    """Return the time of one step in s, from a probe, and the steps of all the scene's runs."""
    duplex, speeds = _duplex_and_speeds(scene, results)
    plans = _plans(scene, duplex, speeds)
    step_s = probe_s(scene, duplex, plans[0], started=speeds is not None)
    return step_s, len(scene.signs) * sum(plan.steps for plan in plans)
