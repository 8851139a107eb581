"""What excitation and recording cost: a run's steps per second over those of a bare OpenMM loop.

python benchmarks/run_overhead.py [ROUNDS]. 24 base pairs on one thread, in processor time; a kicked
run, and a driven one whose ramped force and work are computed on the platform. Each is compared
with a bare loop of its own integrator, of a custom leapfrog without a drive, and of OpenMM's
VerletIntegrator. All take turns, so that whatever else the machine does meets all alike.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import openmm

from dnawaves.duplex.build import build_duplex
from dnawaves.scene.models import Environment, NamedDuplex, SceneSpec, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import load_force_field
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.signed_copy import Copy, hold
from dnawaves.trajectory.verlet import leapfrog

SEQUENCE = "CGATCAGTCAGCTAGCATGCGTAC"
FREQUENCY_GHz = 100.0
STEPS_PER_FRAME = 33  # as in the shipped scenes
FRAMES = 7
EXCITATIONS = {
    "kick": {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.1, "pairs": 3},
    "drive": {
        "kind": "periodic",
        "wave": "extension",
        "force_pN": 20,
        "pairs": 3,
        "frequencies_GHz": [FREQUENCY_GHz],
    },
}
MEMBERS = {"kick": "x1", "drive": "f1"}


def main(rounds: int) -> None:
    duplex = near_minimum()
    scenes = {name: scene_of(duplex, excitation) for name, excitation in EXCITATIONS.items()}
    plan, start = (plan_of(frames) for frames in (FRAMES, 1))
    steps = 2 * (FRAMES - 1) * STEPS_PER_FRAME
    # All from the same start: what has been set in motion needs its neighbours listed more often.
    loops: dict[str, Callable[[], Callable[[int], None]]] = {
        "VerletIntegrator": lambda: bare(duplex, leapfrog(plan.timestep_ps)),
        "custom leapfrog": lambda: bare(duplex, custom_leapfrog(plan.timestep_ps)),
        "driven leapfrog": lambda: Copy(duplex, scenes["drive"], plan, 1.0, threads=1).step,
    }
    times: dict[str, list[float]] = {}
    for _ in range(rounds):
        for name, make in loops.items():
            times.setdefault(name, []).append(seconds(make(), steps) / steps)
        for name, scene in scenes.items():
            # What a run costs before its first step is no part of its speed.
            spent_s = seconds(run, duplex, scene, plan) - seconds(run, duplex, scene, start)
            times.setdefault(f"{name}, recorded", []).append(spent_s / steps)
    print(" " * 18 + "ms/step" + "".join(f"{'of ' + name:>{len(name) + 8}}" for name in loops))
    for name, found in times.items():
        print(f"{name:17s} {1e3 * np.median(found):7.3f}", end="")
        for loop in loops:
            # Of each round by itself: what else the machine does changes slowly.
            ratio = np.array(times[loop]) / np.array(found)
            print(f"{np.median(ratio):{len(loop)}.3f} ± {np.std(ratio) / rounds**0.5:.3f}", end="")
        print()


def near_minimum() -> SimulatedDuplex:
    """Return the duplex after some steps of minimisation: enough to cost as much as any."""
    spec = SystemSpec(
        duplex=NamedDuplex(name="mixed24", sequence=SEQUENCE),
        environment_name="condensed",
        environment=Environment(),
    )
    built = SimulatedDuplex(spec, *build_duplex(SEQUENCE, load_force_field(spec.environment)))
    context = context_of(built.system, openmm.VerletIntegrator(0.001))
    context.setPositions(built.positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 10.0, 300)
    positions = context.getState(positions=True).getPositions(asNumpy=True)
    return built.with_positions(np.array(positions._value))


def scene_of(duplex: SimulatedDuplex, excitation: dict[str, object]) -> SceneSpec:
    return SceneSpec.model_validate(
        {
            "name": excitation["kind"],
            "system": duplex.spec,
            "ends": {"first": "held", "last": "held"},
            "excitation": excitation,
            "observation": {"helical": True},
        }
    )


def plan_of(frames: int) -> Plan:
    return Plan(0.002, STEPS_PER_FRAME, frames, frequency_GHz=FREQUENCY_GHz, ramp_ps=0.5)


def custom_leapfrog(timestep_ps: float) -> openmm.CustomIntegrator:
    """Return the barest leapfrog of the class that the drive needs."""
    integrator = openmm.CustomIntegrator(timestep_ps)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v + dt*f/m")
    integrator.addComputePerDof("x", "x + dt*v")
    return integrator


def bare(duplex: SimulatedDuplex, integrator: openmm.Integrator) -> Callable[[int], None]:
    context = context_of(hold(duplex, [0, duplex.pair_count - 1]), integrator)
    context.setPositions(duplex.positions_nm)

    def step(steps: int, context: openmm.Context = context) -> None:
        context.getIntegrator().step(steps)

    return step


def context_of(system: openmm.System, integrator: openmm.Integrator) -> openmm.Context:
    return openmm.Context(
        system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": "1"}
    )


def run(duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan) -> None:
    with TemporaryDirectory() as folder:
        files = {sign: Path(folder) / f"{sign}.dcd" for sign in (1, -1)}
        member = MEMBERS["kick" if scene.name == "kick" else "drive"]
        run_member(duplex, scene, plan, member, files, 1, Path(folder) / "checkpoint")


def seconds(what: Callable[..., None], *given: Any) -> float:
    """Return the processor's time that a call takes."""
    started = time.process_time()
    what(*given)
    return time.process_time() - started


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 25)
