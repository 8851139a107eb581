"""What runs again after an edit: the scene that was edited, what depends on it, the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

LAST = ["Holding all speeds against the theory", "Writing results/report.html"]


@pytest.fixture
def edit(finished: Path) -> Iterator[Callable[[str, str], None]]:
    """Return a function that edits the configuration of a finished run; undone afterwards."""
    path = finished / "config/config.yaml"
    before = path.read_text()

    def replace(old: str, new: str) -> None:
        assert before.count(old) == 1
        path.write_text(before.replace(old, new))

    yield replace
    path.write_text(before)


def test_nothing_runs_a_second_time(scheduled: Any, finished: Path) -> None:
    assert scheduled(finished) == []


def test_a_comment_runs_nothing(scheduled: Any, finished: Path, edit: Any) -> None:
    edit("scenes:\n", "scenes: # all of them\n")
    assert scheduled(finished) == []


def test_the_same_scenes_in_another_file_run_nothing(scheduled: Any, finished: Path) -> None:
    other = finished / "config/other.yaml"
    other.write_text((finished / "config/config.yaml").read_text())
    assert scheduled(finished, "--configfile", str(other)) == []


def test_an_edited_scene_runs_alone(scheduled: Any, finished: Path, edit: Any) -> None:
    edit(
        "excitation: {kind: none}\n    observation: {",
        "excitation: {kind: none}\n    observation: {duration_ps: 1, ",
    )
    assert scheduled(finished) == sorted(
        [
            "Freezing the scene quiet",
            "Simulating quiet, run",
            "Helical parameters of quiet, run, plus",
            "Fitting the speeds of quiet",
            *LAST,
        ]
    )


def test_a_sweep_runs_again_with_the_scene_it_takes_its_speed_from(
    scheduled: Any, finished: Path, edit: Any
) -> None:
    edit("velocity_A_per_ps: 0.2", "velocity_A_per_ps: 0.3")
    jobs = scheduled(finished)
    assert not any("quiet" in job or "Relaxing" in job or "Constants" in job for job in jobs)
    assert "Fitting one rod to all waves of eight-condensed" in jobs
    assert {"Simulating kicked, x1", "Simulating swept, f1", "Simulating swept, f2"} <= set(jobs)
    assert "Freezing the scene swept" not in jobs


def test_an_edited_environment_runs_its_system_and_all_its_scenes(
    scheduled: Any, finished: Path, edit: Any
) -> None:
    everything = 31
    edit("condensed: {}", "condensed: {force_field: OL15}")
    jobs = scheduled(finished)
    assert len(jobs) == everything
    assert "Relaxing eight-condensed" in jobs


def test_a_new_sequence_of_the_same_name_runs_its_system(scheduled: Any, finished: Path) -> None:
    structures = finished / "config/duplexes.yaml"
    before = structures.read_text()
    structures.write_text("eight: CGATCACC\n")
    try:
        assert "Building eight-condensed" in scheduled(finished)
    finally:
        structures.write_text(before)
