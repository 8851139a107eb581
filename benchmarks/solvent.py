"""What a step costs without solvent, in implicit and in explicit solvent, by length and threads.

python benchmarks/solvent.py PAIRS[,PAIRS...] [THREADS[,THREADS...]] [MODEL...]: milliseconds a step
on the CPU platform (300 K, 1 fs) for duplexes of so many base pairs, the ratio to the first model
of the same run, and ns/day; for several lengths also the power of the number of particles with
which the time grows, from the first to the last. THREADS is 1, 2, ... or `2x1`: two processes of
one thread each at the same time, whose time is that of a step of both, halved. Models, all unless
some are named: none (condensed counterions, reaction field), OBC2, OBC2-custom (the form of
OpenMM's implicit/obc2.xml), GBn2, TIP3P, OPC. Each time is the best of five.
"""

from __future__ import annotations

import sys
import time
from itertools import cycle, islice
from math import log
from multiprocessing import get_context
from multiprocessing.synchronize import Barrier
from typing import Any

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


def ms_per_step(
    system: openmm.System,
    positions_nm: NDArray[np.float64],
    threads: int,
    start_together: Barrier | None = None,
) -> float:
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
        if start_together is not None:
            start_together.wait()
        start = time.perf_counter()
        integrator.step(steps)
        timings.append((time.perf_counter() - start) / steps)
    return 1e3 * min(timings)


def cost(model: str, pairs: int, threads: str) -> tuple[int, float]:
    """Return the number of particles, and milliseconds per step and copy."""
    if "x" not in threads:
        system, positions = prepared(model, pairs)
        return system.getNumParticles(), ms_per_step(system, positions, int(threads))
    copies, each = map(int, threads.split("x"))
    spawn = get_context("spawn")
    together, answers = spawn.Barrier(copies), spawn.SimpleQueue()
    workers = [
        spawn.Process(target=_copy, args=(model, pairs, each, together, answers))
        for _ in range(copies)
    ]
    for worker in workers:
        worker.start()
    found = [answers.get() for _ in workers]
    for worker in workers:
        worker.join()
    return found[0][0], float(np.mean([ms for _, ms in found])) / copies


def _copy(model: str, pairs: int, threads: int, together: Barrier, answers: Any) -> None:
    system, positions = prepared(model, pairs)
    answers.put((system.getNumParticles(), ms_per_step(system, positions, threads, together)))


def main(lengths: list[int], threads: list[str], models: list[str]) -> None:
    print("pairs  threads  model         particles  ms/step    ratio   ns/day")
    found: dict[tuple[str, str], list[tuple[int, float]]] = {}
    for pairs in lengths:
        for many in threads:
            first = None
            for model in models:
                particles, ms = cost(model, pairs, many)
                first = first or ms
                found.setdefault((many, model), []).append((particles, ms))
                print(
                    f"{pairs:5d}  {many:>7s}  {model:12s}  {particles:9d}  {ms:7.2f}"
                    f"  {ms / first:7.2f}  {TIMESTEP_PS * 1e-3 * 86_400e3 / ms:7.3f}",
                    flush=True,
                )
    if len(lengths) > 1:
        print("\nthreads  model         time grows as particles to the power of")
        for (many, model), rows in found.items():
            (few, short), (most, long) = rows[0], rows[-1]
            print(f"{many:>7s}  {model:12s}  {log(long / short) / log(most / few):.2f}")


if __name__ == "__main__":
    if len(sys.argv) < 2 or not set(sys.argv[3:]) <= set(MODELS):
        sys.exit(__doc__)
    main(
        [int(pairs) for pairs in sys.argv[1].split(",")],
        sys.argv[2].split(",") if len(sys.argv) > 2 else ["1"],
        sys.argv[3:] or list(MODELS),
    )
