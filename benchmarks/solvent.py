"""What a step costs without solvent, in implicit and in explicit solvent.

python benchmarks/solvent.py PAIRS [THREADS] [MODEL...]: milliseconds a step on the CPU platform
(300 K, 1 fs) for a duplex of PAIRS base pairs, and the ratio to the first row of the same run.
Models, all unless some are named: none (condensed counterions, reaction field), OBC2, OBC2-custom
(the form of OpenMM's implicit/obc2.xml), GBn2, TIP3P, OPC. Each time is the best of five.
"""

from __future__ import annotations

import sys
import time
from itertools import cycle, islice

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import app

from dnawaves.duplex.build import build_duplex
from dnawaves.scene.models import Environment
from dnawaves.system.effects.implicit import custom_born, native_obc2
from dnawaves.system.effects.water import WATER_FILES, build_explicit, solvate
from dnawaves.system.forces import FORCE_FIELD_FILES, build_system, charges_e, nonbonded_force
from dnawaves.system.geometry import helix_frame, sugar_anchors

MODELS = ("none", "OBC2", "OBC2-custom", "GBn2", "TIP3P", "OPC")
TEMPERATURE_K, TIMESTEP_PS = 300.0, 0.001
REPEATS, REPEAT_S = 5, 1.0
DNA = FORCE_FIELD_FILES["OL21"]


def sequence_of(pairs: int) -> str:
    """Return a mixed sequence of that length."""
    return "".join(islice(cycle("CGATTAGCACTGATCG"), pairs))


def prepared(model: str, pairs: int) -> tuple[openmm.System, NDArray[np.float64]]:
    """Return the System and positions in nm of a duplex of that length in that solvent."""
    files = (DNA, WATER_FILES[model]) if model in WATER_FILES else (DNA,)
    field = app.ForceField(*files)
    topology, positions = build_duplex(sequence_of(pairs), field)
    if model in WATER_FILES:
        frame = helix_frame(positions[sugar_anchors(topology)])
        box = solvate(topology, positions, frame, field, model, salt_M=0.15)
        return build_explicit(box.topology, field), box.positions_nm
    if model == "none":
        return build_system(topology, Environment()), positions
    system = field.createSystem(topology, nonbondedMethod=app.NoCutoff, removeCMMotion=False)
    if model == "OBC2":
        system.addForce(native_obc2(topology, charges_e(nonbonded_force(system))))
    else:
        system.addForce(custom_born(model.removesuffix("-custom"), topology, DNA))
    return system, positions


def ms_per_step(system: openmm.System, positions_nm: NDArray[np.float64], threads: int) -> float:
    """Return the best of several timings of Verlet steps."""
    integrator = openmm.VerletIntegrator(TIMESTEP_PS)
    platform = openmm.Platform.getPlatformByName("CPU")
    context = openmm.Context(system, integrator, platform, {"Threads": str(threads)})
    context.setPositions(positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 100.0, 20)
    context.setVelocitiesToTemperature(TEMPERATURE_K, 1)
    integrator.step(3)
    start = time.perf_counter()
    integrator.step(3)
    steps = max(3, round(REPEAT_S / (time.perf_counter() - start) * 3))
    timings = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        integrator.step(steps)
        timings.append((time.perf_counter() - start) / steps)
    return 1e3 * min(timings)


def main(pairs: int, threads: int, models: list[str]) -> None:
    print("model         particles  ms/step    ratio   ns/day")
    first = None
    for model in models:
        system, positions = prepared(model, pairs)
        cost = ms_per_step(system, positions, threads)
        first = first or cost
        ns_per_day = TIMESTEP_PS * 1e-3 * 86_400e3 / cost
        print(
            f"{model:12s}  {system.getNumParticles():9d}  {cost:7.2f}  {cost / first:7.2f}"
            f"  {ns_per_day:7.3f}",
            flush=True,
        )


if __name__ == "__main__":
    if len(sys.argv) < 2 or not set(sys.argv[3:]) <= set(MODELS):
        sys.exit(__doc__)
    main(
        int(sys.argv[1]),
        int(sys.argv[2]) if len(sys.argv) > 2 else 1,
        sys.argv[3:] or list(MODELS),
    )
