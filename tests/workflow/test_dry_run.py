"""The whole workflow can be planned; what cannot be run is refused before any job."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", ["config.yaml", "smoke.yaml", "paper.yaml"])
def test_the_shipped_configurations_can_be_planned(
    scheduled: Any, tmp_path: Path, name: str
) -> None:
    jobs = scheduled(tmp_path, "--configfile", str(ROOT / "config" / name))
    assert "Writing results/report.html" in jobs
    assert any(job.startswith("Relaxing ") for job in jobs)


def test_a_bare_call_plans_every_scene_of_the_folder_s_own_configuration(
    scheduled: Any, project: Path
) -> None:
    assert scheduled(project) == [
        "Building eight-condensed",
        "Building eight-warm",
        "Checking that eight-condensed is B-DNA",
        "Checking that eight-warm is B-DNA",
        "Constants of the rod in eight-condensed",
        "Constants of the rod in eight-warm",
        "Equilibrating eight-warm",
        "Fitting one rod to all waves of eight-condensed",
        "Fitting the speeds of exact",
        "Fitting the speeds of kicked",
        "Fitting the speeds of quiet",
        "Fitting the speeds of swept",
        "Fitting the speeds of thermal",
        "Freezing the scene exact",
        "Freezing the scene kicked",
        "Freezing the scene quiet",
        "Freezing the scene swept",
        "Freezing the scene thermal",
        "Freezing the system eight-condensed",
        "Freezing the system eight-warm",
        "Helical parameters of kicked, x0.5, minus",
        "Helical parameters of kicked, x0.5, plus",
        "Helical parameters of kicked, x1, minus",
        "Helical parameters of kicked, x1, plus",
        "Helical parameters of quiet, run, plus",
        "Holding all speeds against the theory",
        "Normal modes of eight-condensed with 0 and 0 held",
        "Normal modes of eight-condensed with 0 and 1 held",
        "Relaxing eight-condensed",
        "Simulating exact, x1",
        "Simulating kicked, x0.5",
        "Simulating kicked, x1",
        "Simulating quiet, run",
        "Simulating swept, f1",
        "Simulating swept, f2",
        "Simulating thermal, r1",
        "Stiffness of the segments of eight-condensed",
        "What each effect of eight-condensed costs per step",
        "What each effect of eight-warm costs per step",
        "Writing results/report.html",
    ]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "wave: extension, velocity",
            "wavee: extension, velocity",
            "scene 'kicked': excitation.wavee: found an unknown key (did you mean 'wave'?)",
        ),
        (
            "structures: duplexes.yaml",
            "structures: nowhere.yaml",
            "structures: found 'nowhere.yaml'; allowed: ",
        ),
        ("duplex: eight", "duplex: nine", "scene 'kicked': duplex: found 'nine'; allowed: eight"),
    ],
)
def test_a_bad_configuration_is_refused_by_file_scene_and_field(
    snakemake: Any, project: Path, old: str, new: str, said: str
) -> None:
    path = project / "config/config.yaml"
    path.write_text(path.read_text().replace(old, new, 1))
    run = snakemake(project)
    assert run.returncode != 0
    assert f"config/config.yaml: {said}" in run.stderr
    assert "Traceback" not in run.stderr
    assert not (project / "results").exists()


def test_values_on_the_command_line_are_refused(snakemake: Any, project: Path) -> None:
    run = snakemake(project, "--config", "structures=other.yaml")
    assert run.returncode != 0
    assert "--config: found {'structures': 'other.yaml'}; allowed: nothing" in run.stderr
    assert not (project / "results").exists()


def test_two_configuration_files_are_refused(snakemake: Any, project: Path) -> None:
    config = project / "config/config.yaml"
    other = config.with_name("other.yaml")
    other.write_text(config.read_text())
    run = snakemake(project, "--configfile", str(config), str(other))
    assert run.returncode != 0
    assert "allowed: one file" in run.stderr
