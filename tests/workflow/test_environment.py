"""What is declared twice, for pip and for conda, says the same."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]


def normal(requirement: str) -> str:
    return requirement.lower().replace(" ", "").replace("_", "-")


def test_the_conda_environment_holds_the_package_s_dependencies() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    conda = yaml.safe_load((ROOT / "workflow/envs/dnawaves.yaml").read_text())["dependencies"]
    wanted = {*project["dependencies"], f"python{project['requires-python']}"}
    assert {normal(one) for one in conda} == {normal(one) for one in wanted}


def test_the_lock_holds_every_dependency_and_no_host_name() -> None:
    lock = (ROOT / "requirements.lock").read_text()
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text())
    groups = pyproject["dependency-groups"].values()
    wanted = pyproject["project"]["dependencies"] + [
        one for group in groups for one in group if isinstance(one, str)
    ]
    locked = set(re.findall(r"^([\w.-]+)==", lock, re.MULTILINE))
    names = {re.split(r"[<>=\[ ]", one)[0].lower() for one in wanted}
    assert names <= locked
    assert "://" not in lock
