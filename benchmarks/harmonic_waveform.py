"""How far a simulated wave is from the exact linear answer, against timestep and kick.

python benchmarks/harmonic_waveform.py RESULTS SCENE, with RESULTS a folder that `snakemake` has
filled and SCENE one of its kick or standing-wave scenes. Prints one line per platform, timestep
and kick: over the first crossing, the largest difference of a base pair's waveform from its
harmonic one, as a part of that base pair's own peak and of the largest peak. Scenes themselves
run on the CPU platform, in single precision.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import scipy.sparse
import xarray as xr

from dnawaves.files import read_netcdf
from dnawaves.motion.fields import wave_fields
from dnawaves.scene.load import read_scene
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.modes import normal_modes
from dnawaves.system.relax import read_relaxed
from dnawaves.trajectory.dynamics import Dynamics
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.pattern import kick_pattern
from dnawaves.trajectory.plan import Plan, plan_of
from dnawaves.trajectory.record import Recorder
from dnawaves.trajectory.signed_copy import hold
from dnawaves.trajectory.steps import first_estimates_in
from dnawaves.trajectory.verlet import leapfrog

# Platform, timestep in fs, multiple of the scene's kick.
RUNS = (
    ("CPU", 2.0, 1.0),
    ("CPU", 2.0, 0.1),
    ("CPU", 1.0, 0.1),
    ("CPU", 1.0, 0.01),
    ("Reference", 2.0, 0.1),
    ("Reference", 2.0, 0.01),
    ("Reference", 1.0, 0.01),
)


def simulate(
    duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan, scale: float, platform: str
) -> xr.Dataset:
    """Return the record of a pair of kicks."""
    kick = kick_pattern(scene.excitation, scene.ends, duplex.pair_count)
    system = hold(duplex, held_pairs(scene.ends, duplex.pair_count))
    copies = [Dynamics(system, leapfrog(plan.timestep_ps), platform=platform) for _ in range(2)]
    for sign, one in zip((1, -1), copies, strict=True):
        one.start(duplex.positions_nm, sign * scale * kick.velocities(duplex))
    recorder = Recorder(duplex, scene, plan, (1, -1))
    for index in range(plan.frames):
        for one in copies:
            one.step(plan.steps_per_frame if index else 0)
        frames = [one.frame() for one in copies]
        recorder.add(
            [(one.positions_nm, one.velocities_nm_per_ps, one.energy_kJ_per_mol) for one in frames],
            [0.0, 0.0],
        )
    return recorder.dataset()


def main(results: Path, name: str) -> None:
    scene = read_scene(results / "scenes" / name / "scene.json")
    folder = results / "systems" / scene.system.name
    duplex = read_relaxed(scene.system, folder / "built.pdb", folder / "relaxed.nc")
    attributes = read_netcdf(folder / "relaxed.nc").attrs
    free = ~np.isin(duplex.pairs, held_pairs(scene.ends, duplex.pair_count))
    hessian = scipy.sparse.load_npz(folder / "hessian.npz")
    modes = normal_modes(hessian, duplex.masses_Da, duplex.bodies, free)
    wave = scene.excitation.wave
    print("platform   timestep_fs  kick  wall_s  of_own_peak  of_largest_peak")
    for platform, timestep_fs, scale in RUNS:
        observation = scene.observation.model_copy(
            update={"timestep_fs": timestep_fs, "interval_fs": 60.0, "crossings": 1.0}
        )
        one = scene.model_copy(update={"observation": observation})
        plan = plan_of(duplex, one, one.members[0], first_estimates_in(attributes))
        started = time.perf_counter()
        simulated = simulate(duplex, one, plan, scale, platform)
        wall_s = time.perf_counter() - started
        exact = respond(duplex, modes, one, plan, scale, attributes["energy_kJ_per_mol"])
        found, expected = (
            wave_fields(motion)[f"{wave}_velocity"].values for motion in (simulated, exact)
        )
        moved = np.abs(expected).max(axis=0) > 0
        off = np.abs(found - expected).max(axis=0)[moved]
        peaks = np.abs(expected).max(axis=0)[moved]
        print(
            f"{platform:9s}  {timestep_fs:11.1f}  {scale:4g}  {wall_s:6.1f}  "
            f"{np.max(off / peaks):11.4f}  {off.max() / peaks.max():15.4f}",
            flush=True,
        )


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2])
