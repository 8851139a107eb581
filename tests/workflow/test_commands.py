"""The command line: every rule's command exists, errors are messages, imports are lazy."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer
import xarray as xr

from dnawaves.cli import app

ROOT = Path(__file__).resolve().parents[2]


def dnawaves(*arguments: object, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "dnawaves", *map(str, arguments)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_rule_calls_a_command_with_arguments_that_it_takes(
    snakemake: Any, finished: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = snakemake(finished, "--dry-run", "--forceall", "--printshellcmds")
    calls = re.findall(r"^Shell command: dnawaves (.*)$", plan.stdout + plan.stderr, re.MULTILINE)
    monkeypatch.chdir(finished)  # where the files exist that the commands ask for
    group: Any = typer.main.get_command(app)
    used = set()
    for call in calls:
        name, *arguments = shlex.split(call.split(" > ")[0])
        group.commands[name].make_context(name, arguments)  # exits on anything unknown
        used.add(name)
    # The studies of accuracy and stability are no part of `all`.
    others = {"accuracy", "stability"} | {"advise", "check", "explain", "schema", "theory"}
    assert used == set(group.commands) - others


def test_help_imports_nothing_heavy() -> None:
    program = (
        "import sys, dnawaves.cli; "
        "heavy = 'MDAnalysis numpy openmm pandas plotly pydantic scipy xarray'.split(); "
        "print(*{*heavy} & {*sys.modules})"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == ""


def test_check_lists_the_scenes(project: Path) -> None:
    run = dnawaves("check", "config/config.yaml", folder=project)
    assert run.returncode == 0
    assert [line.split()[0] for line in run.stdout.splitlines()] == [
        "scene",
        "kicked",
        "swept",
        "exact",
        "quiet",
        "thermal",
    ]


def test_a_refusal_is_one_message_and_exit_code_2(project: Path) -> None:
    path = project / "config/config.yaml"
    path.write_text(path.read_text().replace("helical: true", "helicall: true", 1))
    run = dnawaves("check", "config/config.yaml", folder=project)
    assert run.returncode == 2
    assert run.stdout == ""
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("dnawaves: config/config.yaml: scene 'kicked': observation.")


def test_a_missing_input_is_a_usage_error(tmp_path: Path) -> None:
    run = dnawaves("build", "nowhere.json", "--output", "built.pdb", folder=tmp_path)
    assert run.returncode == 2
    assert "nowhere.json" in run.stderr
    assert "Traceback" not in run.stderr


def test_a_trajectory_that_does_not_fit_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.pdb").write_text("END\n")
    (tmp_path / "b.dcd").write_text("no trajectory")
    run = dnawaves("helical", "a.pdb", "b.dcd", "--output", "helical.nc", folder=tmp_path)
    assert run.returncode == 2
    assert "b.dcd: cannot be read with a.pdb" in run.stderr
    assert not (tmp_path / "helical.nc").exists()


def test_from_a_sequence_to_helical_parameters_by_hand(project: Path) -> None:
    (project / "config/duplexes.yaml").write_text("eight: AAAAAAAA\n")
    for command in (
        "freeze config/config.yaml --system eight-condensed --output system.json",
        "build system.json --output built.pdb",
        "helical built.pdb built.pdb --output helical.nc",
    ):
        run = dnawaves(*command.split(), folder=project)
        assert run.returncode == 0, run.stderr
    with xr.open_dataset(project / "helical.nc") as helical:
        # The fibre's screw, 36° and 3.375 Å; the rest is the PDB's rounding to 0.001 Å.
        assert abs(helical["twist"] - 36).max() < 0.05
        advance_A = helical["origin"].sel(component="z").diff("pair")
        assert abs(advance_A - 3.375).max() < 0.002
