"""What the minimum and the normal modes cost against the length of the duplex.

python benchmarks/harmonic_cost.py BASE_PAIRS..., such as 6 12 24 48. Each length is built, relaxed
with two threads and diagonalised in a process of its own; prints one line per length. Sequences
repeat the 24 base pairs of the shipped scenes.
"""

from __future__ import annotations

import multiprocessing
import resource
import sys
import time

import numpy as np

from dnawaves.duplex.build import build_duplex
from dnawaves.errors import SimulationError
from dnawaves.scene.models import Environment, NamedDuplex, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import load_force_field
from dnawaves.system.modes import normal_modes
from dnawaves.system.relax import relax

SEQUENCE = "CGATCAGTCAGCTAGCATGCGTAC"


def measure(pairs: int) -> str:
    sequence = (SEQUENCE * (pairs // len(SEQUENCE) + 1))[:pairs]
    spec = SystemSpec(
        duplex=NamedDuplex(name="duplex", sequence=sequence),
        environment_name="condensed",
        environment=Environment(),
    )
    topology, positions = build_duplex(sequence, load_force_field(spec.environment))
    built = SimulatedDuplex(spec, topology, positions)
    started = time.perf_counter()
    try:
        record, hessian = relax(built, threads=2, report=lambda line: None)
    except SimulationError as error:
        return f"{pairs:10d}  {error}"
    relax_s = time.perf_counter() - started
    duplex = built.with_positions(record["position_nm"].values)
    started = time.perf_counter()
    everything = np.ones(len(duplex.masses_Da), dtype=bool)
    modes = normal_modes(hessian, duplex.masses_Da, duplex.bodies, everything)
    modes_s = time.perf_counter() - started
    values = modes.eigenvalues_per_ps2
    softest = values[modes.vibrations].min()
    rigid = np.abs(values[~modes.vibrations]).max()
    memory_MB = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return (
        f"{pairs:10d}  {len(everything):5d}  {relax_s:7.1f}  {modes_s:7.1f}  {memory_MB:9.0f}  "
        f"{record.attrs['force_evaluations']:11d}  {rigid:18.1e}  {softest:20.2e}"
    )


def main(lengths: list[int]) -> None:
    print(
        "base_pairs  atoms  relax_s  modes_s  memory_MB  evaluations  "
        "largest_rigid_ps-2  softest_vibration_ps-2"
    )
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        for line in pool.imap(measure, lengths, chunksize=1):
            print(line, flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main([int(pairs) for pairs in sys.argv[1:]])
