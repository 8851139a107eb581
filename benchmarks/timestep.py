"""What a timestep costs and what it does to the speed of the lowest standing wave.

python benchmarks/timestep.py RESULTS SCENE, with RESULTS a folder that `snakemake` has filled and
SCENE one of its standing-wave scenes. Prints one line per timestep.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from dnawaves.files import read_netcdf
from dnawaves.scene.load import read_scene
from dnawaves.system.relax import read_relaxed
from dnawaves.trajectory.plan import plan_of
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.steps import first_estimates_in
from dnawaves.waves.analyse import analyse
from dnawaves.waves.record import Record

TIMESTEPS_FS = (0.5, 1.0, 2.0, 2.5)


def main(results: Path, name: str) -> None:
    scene = read_scene(results / "scenes" / name / "scene.json")
    folder = results / "systems" / scene.system.name
    duplex = read_relaxed(scene.system, folder / "built.pdb", folder / "relaxed.nc")
    estimates = first_estimates_in(read_netcdf(folder / "relaxed.nc").attrs)
    reference = None
    print("timestep_fs  wall_s  speed_A_per_ps  change_from_first")
    for timestep_fs in TIMESTEPS_FS:
        observation = scene.observation.model_copy(
            update={"timestep_fs": timestep_fs, "interval_fs": 60.0}
        )
        one = scene.model_copy(update={"observation": observation})
        plan = plan_of(duplex, one, one.members[0], estimates)
        started = time.perf_counter()
        recorder = run_member(duplex, one, plan, one.members[0], {})
        wall_s = time.perf_counter() - started
        estimate = analyse([Record(one, one.members[0], recorder.dataset())])[0]
        assert estimate.speed_A_per_ps is not None
        reference = reference or estimate.speed_A_per_ps
        change = estimate.speed_A_per_ps / reference - 1
        print(
            f"{timestep_fs:11.1f}  {wall_s:6.1f}  {estimate.speed_A_per_ps:14.4f}  {change:+.1e}",
            flush=True,
        )


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2])
