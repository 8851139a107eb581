"""A run that is killed goes on from its last checkpoint and ends as it would have ended."""

from __future__ import annotations

import multiprocessing
import os
import random
import shutil
import signal
import sys
from collections.abc import Callable
from contextlib import redirect_stderr
from dataclasses import replace
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from typing import Any

import numpy as np
import openmm
import pytest
import xarray as xr

from dnawaves.errors import SimulationError
from dnawaves.files import read_netcdf, write_netcdf
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.checkpoint import Checkpoints, checkpoint_folder
from dnawaves.trajectory.dynamics import Dynamics, Saved
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.verlet import leapfrog

HELD = {"first": "held", "last": "held"}
DRIVE = {
    "kind": "periodic",
    "wave": "twist",
    "torque_pN_nm": 100,
    "pairs": 1,
    "frequencies_GHz": [500.0],
}
EVERY = 3
KILLS = 10
FRAMES = 240
# Operations on files after which a run is killed: those of some five checkpoints, a dozen each, so
# that ten such runs do not reach the 80th.
OPERATIONS = 60
PLAN = Plan(0.002, 5, 8, frequency_GHz=500.0)
# A server that has imported what a run needs, from which each run is forked.
PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(["dnawaves.trajectory.run"])


def simulate(
    duplex: SimulatedDuplex, scene: SceneSpec, member: str, output: Path, killed_at: int | None
) -> None:
    """Run a scene from start or last checkpoint to its end; tells the log where it is."""
    with output.with_suffix(".log").open("a") as log, redirect_stderr(log):
        plan = Plan(0.001, 10, FRAMES, frequency_GHz=500.0, ramp_ps=0.5)
        files = {sign: output.with_name(f"{sign}.dcd") for sign in (1, -1)}
        folder = checkpoint_folder(output)
        if killed_at is not None:
            kill_before(killed_at, folder)
        recorder = run_member(duplex, scene, plan, member, files, 1, folder, EVERY)
        write_netcdf(output, recorder.dataset())


def kill_before(operation: int, folder: Path) -> None:
    """Let this process be killed before an operation on the files of a folder of checkpoints.

    Counted from where its first checkpoint appears, and not timed: how fast the machine is, and
    what else it does, decides nothing.
    """
    done = 0

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal done
        if not event.startswith(("open", "os.", "shutil.")):
            return
        if not (arguments and str(arguments[0]).startswith(str(folder))):
            return
        if done or (event == "os.rename" and Path(arguments[1]).name.isdigit()):
            if done == operation:
                os.kill(os.getpid(), signal.SIGKILL)
            done += 1

    sys.addaudithook(watch)


@pytest.fixture(scope="module")
def duplex(near_minimum: Callable[..., SimulatedDuplex]) -> SimulatedDuplex:
    return near_minimum("CGCG", 10.0, 200)


@pytest.fixture(scope="module")
def scene(duplex: SimulatedDuplex, make_scene: Callable[..., SceneSpec]) -> SceneSpec:
    return make_scene(duplex, DRIVE, HELD, helical=True)


def same(one: xr.Dataset, other: xr.Dataset) -> None:
    """Assert that two records are equal to the last bit."""
    assert one.sizes == other.sizes
    for name in one.variables:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=str(name))


def checkpoints_in(folder: Path) -> int:
    """Return the frame of the last checkpoint, 0 where there is none."""
    names = os.listdir(folder) if folder.exists() else []
    return max((int(name) for name in names if name.isdigit()), default=0)


def kill_and_compare(
    duplex: SimulatedDuplex, scene: SceneSpec, member: str, folder: Path, kills: int
) -> None:
    """Kill a run anywhere on its way; assert that it ends as one that nobody disturbed."""
    whole, killed = (folder / name / "motion.nc" for name in ("whole", "killed"))

    def start(output: Path, killed_at: int | None = None) -> ForkServerProcess:
        output.parent.mkdir(exist_ok=True)
        process = PROCESSES.Process(
            target=simulate, args=(duplex, scene, member, output, killed_at)
        )
        process.start()
        return process

    undisturbed = start(whole)
    checkpoints, moments = checkpoint_folder(killed), random.Random(1)
    for _ in range(kills):
        reached = checkpoints_in(checkpoints)
        process = start(killed, moments.randint(1, OPERATIONS))
        process.join()
        # Killed, so not yet at its end.
        assert process.exitcode == -signal.SIGKILL
        assert not killed.exists()
        assert checkpoints_in(checkpoints) >= reached + EVERY
    for process in (start(killed), undisturbed):
        process.join()
        assert process.exitcode == 0
    assert killed.with_suffix(".log").read_text().count("goes on at") == kills
    assert "goes on at" not in whole.with_suffix(".log").read_text()
    same(read_netcdf(killed), read_netcdf(whole))
    assert read_netcdf(killed).sizes["time"] == FRAMES
    for name in ("1.dcd", "-1.dcd"):
        assert killed.with_name(name).read_bytes() == whole.with_name(name).read_bytes()


def test_a_run_killed_ten_times_ends_as_if_it_had_not_been(
    duplex: SimulatedDuplex, scene: SceneSpec, tmp_path: Path
) -> None:
    kill_and_compare(duplex, scene, "f1", tmp_path, KILLS)


KICK = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 1.0, "pairs": 1}


@pytest.mark.parametrize(("excitation", "member"), [(KICK, "x1r2"), (DRIVE, "f1r2")])
def test_so_does_one_with_a_thermostats_noise(
    equilibrated: Any,
    make_scene: Callable[..., SceneSpec],
    excitation: dict[str, Any],
    member: str,
    tmp_path: Path,
) -> None:
    snapshot = equilibrated()[2]
    thermostat = {"friction_per_ps": 5.0}
    scene = make_scene(snapshot, excitation, HELD, thermostat, helical=True)
    kill_and_compare(snapshot, scene, member, tmp_path, 3)


def test_where_checkpoints_are_kept_does_not_change_the_result(
    duplex: SimulatedDuplex, scene: SceneSpec, tmp_path: Path
) -> None:
    with_folder, without = (
        run_member(duplex, scene, PLAN, "f1", {}, 1, folder, EVERY).dataset()
        for folder in (tmp_path / "here", None)
    )
    same(with_folder, without)


@pytest.mark.parametrize("threads", [1, 2])
def test_going_on_is_exact_only_where_the_undisturbed_run_starts_anew_too(
    duplex: SimulatedDuplex, threads: int
) -> None:
    undisturbed, anew, resumed = (
        Dynamics(duplex.system, leapfrog(0.002), threads=threads) for _ in range(3)
    )
    undisturbed.start(duplex.positions_nm, np.zeros_like(duplex.positions_nm))
    undisturbed.step(300)
    saved = undisturbed.frame().saved
    text = openmm.XmlSerializer.serialize(saved.state)
    anew.restore(saved)
    resumed.restore(Saved(openmm.XmlSerializer.deserialize(text), {}))
    for dynamics in (undisturbed, anew, resumed):
        dynamics.step(300)
    first, second, third = (one.frame().positions_nm for one in (undisturbed, anew, resumed))
    if threads == 1:
        np.testing.assert_array_equal(second, third)
        assert (first != second).any()
    # Forces are rounded to 24 bits, 1e-4 kJ/mol/nm, in an order that the threads' and the list of
    # neighbours' past decides: 1e-9 nm after a step, and it grows.
    for other in (second, third):
        np.testing.assert_allclose(other, first, atol=1e-5)


def test_an_explosion_after_a_checkpoint_keeps_a_state_from_after_it(
    duplex: SimulatedDuplex, make_scene: Callable[..., SceneSpec], tmp_path: Path
) -> None:
    kick = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.2, "pairs": 1}
    # 3 fs is beyond the stability limit of the O-H stretch at the chains' free ends.
    plan = Plan(0.003, 2, 200)
    messages = []
    for _ in range(2):  # the second time from the last checkpoint
        with pytest.raises(SimulationError) as error:
            run_member(duplex, make_scene(duplex, kick), plan, "x1", {}, 1, tmp_path, EVERY)
        messages.append(str(error.value))
    assert messages[0] == messages[1]
    step = openmm.XmlSerializer.deserialize((tmp_path / "last_good.xml").read_text()).getStepCount()
    assert f"in step {step + 1}, atom" in messages[0]
    assert step >= 2 * checkpoints_in(tmp_path) > 0


def test_checkpoints_of_another_run_are_not_used(
    duplex: SimulatedDuplex,
    scene: SceneSpec,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def run(plan: Plan, duplex: SimulatedDuplex = duplex, threads: int = 1) -> str:
        run_member(duplex, scene, plan, "f1", {}, threads, tmp_path, EVERY)
        return capsys.readouterr().err

    assert "goes on" not in run(PLAN)
    assert "goes on at 0.060 ps" in run(PLAN)
    faster = replace(PLAN, frequency_GHz=600.0)
    moved = duplex.with_positions(duplex.positions_nm + 1e-9)
    for differing, other in (
        ("plan, integrator", lambda: run(faster)),
        ("positions", lambda: run(faster, moved)),
        ("threads", lambda: run(faster, moved, 2)),
    ):
        report = other()
        assert f"of another run (other {differing}), so removed" in report
        assert "goes on" not in report
        # And its own are; also with two threads, which do not round alike twice.
        assert "goes on at 0.060 ps" in other()


def test_what_a_kill_leaves_unfinished_is_not_used(tmp_path: Path) -> None:
    system = openmm.System()
    system.addParticle(1.0)
    dynamics = Dynamics(system, leapfrog(0.001), platform="Reference")
    dynamics.start(np.zeros((1, 3)), np.ones((1, 3)))
    store = Checkpoints(tmp_path, {"run": 1})
    assert store.latest() is None
    for frame in (2, 4, 6):
        dynamics.step(10)
        first = frame - 1 if frame > 2 else 0
        frames = {"time": np.arange(first, frame + 1)}
        store.save(frame, frames, [dynamics.frame().saved])
    # What is there before the last rename, and a second State XML of a checkpoint passed.
    (tmp_path / ".partial").mkdir()
    (tmp_path / ".partial" / "frames.npz").write_bytes(b"half")
    (tmp_path / "000000002" / "state0.xml").write_text("old")
    found = Checkpoints(tmp_path, {"run": 1}).latest()
    assert found is not None
    assert found.frames["time"].tolist() == list(range(7))
    assert [saved.state.getStepCount() for saved in found.states] == [30]
    # A checkpoint that somebody removed by hand.
    shutil.rmtree(tmp_path / "000000004")
    with pytest.raises(SimulationError, match=r"found 5 frames, expected 7; remove the folder"):
        store.latest()
