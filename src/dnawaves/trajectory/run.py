"""Run one member of a scene: two copies of opposite sign, in step, recorded as they go."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import openmm

from dnawaves.files import digest, provenance
from dnawaves.scene.excitations import Kick, StandingWave, Static
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.saving import parts_between_checkpoints
from dnawaves.trajectory.checkpoint import Checkpoints
from dnawaves.trajectory.dynamics import Frame, Saved
from dnawaves.trajectory.guard import Guard
from dnawaves.trajectory.integrator import integrator_of
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.progress import progress
from dnawaves.trajectory.record import SIGNS, Recorder
from dnawaves.trajectory.signed_copy import Copy
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K


def run_member(
    duplex: SimulatedDuplex,
    scene: SceneSpec,
    plan: Plan,
    member: str,
    trajectories: dict[int, Path],
    threads: int = 1,
    checkpoints: Path | None = None,
    frames_per_checkpoint: int | None = None,
    platform: str = "CPU",
) -> Recorder:
    """Simulate one member and return what was recorded.

    `trajectories` maps a sign to the file that its base atoms go to; empty for none. With a folder
    `checkpoints`, a run that was killed goes on from its last checkpoint and ends as it would have
    ended; the caller removes the folder once the result is on disk. `frames_per_checkpoint`, left
    out, follows from the size of the run.

    Raises
    ------
    SimulationError
        When a copy's velocities are not finite or have exploded; names the step, the atoms and
        the forces on them.
    """
    signs = tuple(SIGNS[name] for name in scene.signs)
    scale = kick_scale(scene, member)
    snapshot = snapshot_of(member)
    copies = [
        Copy(duplex, scene, plan, sign * scale, threads, platform, snapshot) for sign in signs
    ]
    title = f"{scene.name} {member}"
    every = frames_per_checkpoint or parts_between_checkpoints(
        duplex.spec.environment, len(duplex.masses_Da), plan.steps_per_frame, len(copies)
    )
    recorder = Recorder(
        duplex, scene, plan, signs, keep_atoms=bool(trajectories), platform=platform
    )
    good: list[Saved | None] = [None for _ in copies]
    store = None
    if checkpoints is not None:
        run = _description(duplex, scene, plan) | {
            "member": member,
            "platform": platform,
            "threads": threads,
            "base_atoms": bool(trajectories),
            "frames_per_checkpoint": every,
        }
        store = Checkpoints(checkpoints, run)
        if saved := store.latest():
            good = list(saved.states)
            recorder.extend(saved.frames)
            for which, one in enumerate(copies):
                one.restore(saved.states[which], saved.frames["momenta"][-1, which])
            time_ps = (len(recorder) - 1) * plan.interval_ps
            print(f"{title}: goes on at {time_ps:.3f} ps", file=sys.stderr, flush=True)
    guard = Guard(duplex, title, store.last_good if store else None)
    first = saved_until = len(recorder)
    interval_ps = plan.interval_ps * len(copies)
    total_ps, done_ps = (plan.frames - 1) * interval_ps, max(first - 1, 0) * interval_ps
    with progress(title, total_ps, done_ps) as advance:
        for index in range(first, plan.frames):
            steps = plan.steps_per_frame if index else 0
            found = [
                guard.advance(one, state, steps) for one, state in zip(copies, good, strict=True)
            ]
            moments = [frame.saved for frame, _ in found]
            good = list(moments)
            recorder.add(
                [(f.positions_nm, f.velocities_nm_per_ps, f.energy_kJ_per_mol) for f, _ in found],
                [injected.work_kJ_per_mol for _, injected in found],
                [injected.momenta for _, injected in found],
                _temperatures_K(scene, copies, [frame for frame, _ in found]),
            )
            if index:
                advance(index * interval_ps)
            if index and index % every == 0:
                if store:
                    store.save(index, recorder.frames(saved_until), moments)
                    saved_until = len(recorder)
                # Also without a folder: where checkpoints are kept must not change the result.
                for one, (frame, injected) in zip(copies, found, strict=True):
                    one.restore(frame.saved, injected.momenta)
    recorder.write_trajectories(trajectories)
    return recorder


def kick_scale(scene: SceneSpec, member: str) -> float:
    """Return the multiple of the kick or load that a member stands for; 1 where nothing scales."""
    if not isinstance(scene.excitation, Kick | StandingWave | Static):
        return 1.0
    return float(member[1:].split("r")[0])


def snapshot_of(member: str) -> int:
    """Return the number of the equilibrated snapshot that a member starts from, as 2 in `x0.5r2`.

    0 at T = 0, where there is none.
    """
    _, _, number = member.rpartition("r")
    return int(number) if number.isdigit() else 0


def _temperatures_K(
    scene: SceneSpec, copies: Sequence[Copy], frames: Sequence[Frame]
) -> list[float] | None:
    if not scene.system.thermal:
        return None
    return [
        2
        * frame.late_kinetic_kJ_per_mol
        / (one.dynamics.degrees_of_freedom * BOLTZMANN_KJ_PER_MOL_K)
        for one, frame in zip(copies, frames, strict=True)
    ]


def _description(duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan) -> dict[str, Any]:
    """Return what defines a run, by nothing that another machine would round differently."""
    serialize = openmm.XmlSerializer.serialize
    velocities = duplex.velocities_nm_per_ps
    return {
        "scene": digest(scene.model_dump_json()),
        "plan": asdict(plan),
        "positions": digest(duplex.positions_nm.tobytes()),
        "velocities": "" if velocities is None else digest(velocities.tobytes()),
        "system": digest(serialize(duplex.system)),
        "integrator": digest(serialize(integrator_of(scene, plan))),
        **provenance("openmm", "numpy"),
    }
