"""The step from files to files: whole outputs or none."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dnawaves.errors import SimulationError
from dnawaves.files import read_netcdf, write_json
from dnawaves.scene.models import SceneSpec
from dnawaves.trajectory.checkpoint import checkpoint_folder
from dnawaves.trajectory.steps import simulate_step

HELD = {"first": "held", "last": "held"}
Simulate = Callable[..., Path]


@pytest.fixture
def simulate(relaxed: Any, make_scene: Callable[..., SceneSpec], tmp_path: Path) -> Simulate:
    """Return a function that simulates a member and returns the output's path."""

    def run(
        excitation: dict[str, Any],
        ends: dict[str, Any],
        member: str,
        trajectory: Path | None = None,
        fitted: Path | None = None,
        **observation: Any,
    ) -> Path:
        scene = make_scene(relaxed.duplex, excitation, ends, **observation)
        write_json(tmp_path / "scene.json", scene.model_dump(mode="json"))
        simulate_step(
            tmp_path / "scene.json",
            relaxed.built_file,
            relaxed.relaxed_file,
            member,
            tmp_path / "out" / "motion.nc",
            trajectory,
            [fitted] if fitted else [],
            threads=1,
            hessian=relaxed.hessian_file if excitation["kind"] == "static" else None,
        )
        return tmp_path / "out" / "motion.nc"

    return run


def test_a_kick_is_simulated_from_files(simulate: Simulate, tmp_path: Path) -> None:
    excitation = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.2, "pairs": 2}
    trajectory = tmp_path / "trajectory"
    for _ in range(2):  # the second time over the first's files
        output = simulate(excitation, HELD, "x1", trajectory, duration_ps=0.1, interval_fs=20)
    motion = read_netcdf(output)
    assert motion.sizes == {"sign": 2, "time": 6, "pair": 6, "xyz": 3, "abc": 3, "axis": 3}
    axis = motion["direction"].sel(axis="helix").values
    np.testing.assert_allclose(
        motion["velocity"].values[0, 0] @ axis, [0, 0.2, 0.2, 0, 0, 0], atol=1e-12
    )
    assert sorted(path.name for path in trajectory.iterdir()) == ["minus.dcd", "plus.dcd"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "scene.json", "trajectory"]
    assert [path.name for path in output.parent.iterdir()] == ["motion.nc"]


def test_length_and_interval_come_from_the_first_estimate(relaxed: Any, simulate: Simulate) -> None:
    excitation = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.2, "pairs": 2}
    motion = read_netcdf(simulate(excitation, HELD, "x1", crossings=0.5))
    speed = relaxed.record.attrs["first_estimate_extension_A_per_ps"]
    length_A = float(motion["height"][-1] - motion["height"][0])
    interval_ps = float(motion["time"][1])
    # To one interval.
    assert float(motion["time"][-1]) == pytest.approx(
        0.5 * length_A / speed + interval_ps / 2, abs=interval_ps / 2 + 1e-9
    )


def test_a_run_that_explodes_leaves_no_output(simulate: Simulate, tmp_path: Path) -> None:
    excitation = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 20, "pairs": 2}
    excitation["scales"] = [1000]
    trajectory = tmp_path / "trajectory"
    with pytest.raises(SimulationError):
        simulate(excitation, HELD, "x1000", trajectory, duration_ps=0.1)
    assert not (tmp_path / "out" / "motion.nc").exists()
    assert not trajectory.exists()


def test_a_failed_run_leaves_an_earlier_one_as_it_was(simulate: Simulate) -> None:
    excitation = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.2, "pairs": 2}
    output = simulate(excitation, HELD, "x1", duration_ps=0.01, interval_fs=2)
    before = output.read_bytes()
    with pytest.raises(SimulationError):
        simulate({**excitation, "scales": [9999]}, HELD, "x9999", duration_ps=0.1)
    assert output.read_bytes() == before
    # And where it would go on from.
    assert {path.name for path in output.parent.iterdir()} == {"motion.nc", ".motion.checkpoint"}


# The command line with checkpoints of a small run as often as those of a large one.
COMMAND = """
import dnawaves.system.saving as saving
from dnawaves.cli import main
saving.ATOM_STEPS = 1e5
main()
"""
# The same, killed by itself once its first checkpoint is there: no clock decides how far it gets.
KILLED = f"""
import os, signal
from dnawaves.trajectory.checkpoint import Checkpoints
def save(*given, save=Checkpoints.save):
    save(*given)
    os.kill(os.getpid(), signal.SIGKILL)
Checkpoints.save = save
{COMMAND}"""


def test_a_command_that_is_killed_goes_on_and_leaves_no_checkpoints(
    relaxed: Any, make_scene: Callable[..., SceneSpec], tmp_path: Path
) -> None:
    excitation = {"kind": "kick", "wave": "twist", "angular_velocity_rad_per_ps": 0.02, "pairs": 2}
    scene = make_scene(relaxed.duplex, excitation, HELD, duration_ps=4, interval_fs=20)
    write_json(tmp_path / "scene.json", scene.model_dump(mode="json"))

    def run(output: Path, program: str = COMMAND) -> subprocess.CompletedProcess[str]:
        files = (relaxed.built_file, relaxed.relaxed_file)
        arguments = ["simulate", tmp_path / "scene.json", *files, "--member", "x1"]
        command = [sys.executable, "-c", program, *arguments, "--output", output]
        command += ["--trajectory", output.with_name("trajectory")]
        return subprocess.run(
            [str(one) for one in command], stderr=subprocess.PIPE, text=True, check=False
        )

    killed, whole = (tmp_path / name / "motion.nc" for name in ("killed", "whole"))
    assert run(killed, KILLED).returncode == -signal.SIGKILL
    assert any(path.name.isdigit() for path in checkpoint_folder(killed).glob("*"))
    assert not killed.exists()
    said = [run(output).stderr for output in (killed, whole)]
    assert "test x1: goes on at " in said[0] and "goes on" not in said[1]
    for output in (killed, whole):
        assert {path.name for path in output.parent.iterdir()} == {"motion.nc", "trajectory"}
    one, other = read_netcdf(killed), read_netcdf(whole)
    for name in one.variables:
        np.testing.assert_array_equal(one[name], other[name])
    for sign in ("plus", "minus"):
        first, second = (out.with_name("trajectory") / f"{sign}.dcd" for out in (killed, whole))
        assert first.read_bytes() == second.read_bytes()


def test_a_load_is_simulated_from_files(relaxed: Any, simulate: Simulate) -> None:
    excitation = {"kind": "static", "wave": "extension", "force_pN": 5}
    motion = read_netcdf(simulate(excitation, {"first": "held", "last": "guided"}, "x1"))
    assert motion.sizes["time"] == 1
    assert motion.attrs["left_basin"] == ""
    slide_A = motion["displacement"].values[:, 0, -1] @ motion["direction"].values[2]
    assert slide_A[0] > 0 > slide_A[1]


def test_a_sweep_takes_its_frequencies_from_the_fitted_speed(
    simulate: Simulate, tmp_path: Path
) -> None:
    table = tmp_path / "speeds.csv"
    table.write_text("estimator,speed_A_per_ps\narrival,99\nwaveform,12.5\n")
    excitation = {
        "kind": "periodic",
        "wave": "extension",
        "force_pN": 20,
        "pairs": 2,
        "sweep": {"scenes": ["other"], "points": 2},
        "ramp_periods": 0.5,
    }
    motion = read_netcdf(simulate(excitation, HELD, "f2", None, table, duration_ps=0.02))
    length_A = float(motion["height"][-1] - motion["height"][0])
    # 1.3 times V/2L of the fitted rod, which is the faster one here.
    frequency_GHz = 1300 * 12.5 / (2 * length_A)
    assert motion.attrs["frequency_GHz"] == pytest.approx(frequency_GHz, rel=1e-9)
    # Rises over half a period.
    assert motion.attrs["ramp_ps"] == pytest.approx(500 / frequency_GHz, rel=1e-9)
