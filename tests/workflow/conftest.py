"""Snakemake, run for real in a folder of its own."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

CONFIGURATION = """\
structures: duplexes.yaml
environments:
  condensed: {}
  warm: {temperature_K: 300}
scenes:
  kicked:
    duplex: eight
    environment: condensed
    excitation: {kind: kick, wave: extension, velocity_A_per_ps: 0.2, scales: [1, 0.5]}
    observation: {helical: true}
  swept:
    duplex: eight
    environment: condensed
    ends: {first: held, last: held}
    excitation:
      {kind: periodic, wave: extension, force_pN: 20, sweep: {scenes: [kicked], points: 2}}
  exact:
    duplex: eight
    environment: condensed
    excitation: {kind: kick, wave: twist, angular_velocity_rad_per_ps: 0.01}
    method: harmonic
  quiet:
    duplex: eight
    environment: condensed
    ends: {first: held, last: held}
    excitation: {kind: none}
    observation: {helical: true}
  thermal:
    duplex: eight
    environment: warm
    ends: {first: free, last: free}
    observation: {duration_ps: 2}
    excitation: {kind: none}
"""

Snakemake = Callable[..., subprocess.CompletedProcess[str]]


def snakemake(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")]
    return subprocess.run(
        [*command, "--cores", "2", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )


def scheduled(folder: Path, *arguments: str) -> list[str]:
    """Return the messages of the jobs that a dry run would start, sorted."""
    run = snakemake(folder, "--dry-run", *arguments)
    assert run.returncode == 0, run.stderr
    return sorted(re.findall(r"^Job \d+: (.*)$", run.stdout + run.stderr, re.MULTILINE))


@pytest.fixture(scope="session", name="snakemake")
def snakemake_fixture() -> Snakemake:
    return snakemake


@pytest.fixture(scope="session", name="scheduled")
def scheduled_fixture() -> Callable[..., list[str]]:
    return scheduled


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return a folder with a small configuration of its own."""
    return write_project(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder in which every output exists and Snakemake knows what made it.

    The outputs are empty: what is scheduled does not depend on what is in them.
    """
    folder = write_project(tmp_path_factory.mktemp("finished"))
    summary = snakemake(folder, "--summary").stdout.splitlines()
    for line in summary[1:]:
        output = folder / line.split("\t")[0]
        output.parent.mkdir(parents=True, exist_ok=True)
        if output.name == "trajectory":
            output.mkdir()
            (output / "plus.dcd").touch()
            (output / "minus.dcd").touch()
        else:
            output.touch()
    run = snakemake(folder, "--touch", "--forceall")
    assert run.returncode == 0, run.stderr
    return folder


def write_project(folder: Path) -> Path:
    (folder / "config").mkdir()
    (folder / "config/config.yaml").write_text(CONFIGURATION)
    (folder / "config/duplexes.yaml").write_text("eight: CGATCACG\n")
    return folder
