"""What a study file may say, and how a wrong one is refused."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from dnawaves.accuracy.settings import load_study
from dnawaves.errors import InputError

CONFIG = Path(__file__).parents[2] / "config"


def study() -> dict[str, object]:
    return {
        "systems": {"six": {"sequence": "CGATCG", "environment": {"relaxation": {"anneal_ps": 1}}}},
        "cases": {
            "kick": {
                "system": "six",
                "excitation": {
                    "kind": "kick",
                    "wave": "extension",
                    "velocity_A_per_ps": 0.1,
                    "pairs": 2,
                },
                "duration_ps": 0.72,
            }
        },
        "case": "kick",
        "lines": {"leapfrog": {"title": "leapfrog", "vary": {"timestep_fs": [1, 2]}}},
    }


def test_the_shipped_studies_are_accepted_and_large_enough() -> None:
    full = load_study(CONFIG / "accuracy.yaml")
    own = [
        setting
        for setting in full.settings.values()
        if setting.table == "settings" and setting.case_name == full.study.case
    ]
    # Issue: a front within one model of at least 20 settings.
    assert len(own) >= 20
    assert any(setting.is_default for setting in own)
    assert len(load_study(CONFIG / "accuracy_smoke.yaml").settings) < 12


def test_settings_are_the_values_of_a_line(tmp_path: Path) -> None:
    file = tmp_path / "study.yaml"
    file.write_text(yaml.safe_dump(study()))
    settings = load_study(file).settings
    assert list(settings) == ["leapfrog-1", "leapfrog-2"]
    assert settings["leapfrog-2"].is_default
    assert not settings["leapfrog-1"].is_default


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ({"vary": {"timestep": [1]}}, "vary: found 'timestep'; allowed: platform"),
        ({"vary": {"timestep_fs": [7]}}, "interval_fs must be a multiple of timestep_fs"),
        ({"vary": {"timestep_fs": [2, 2]}}, "found 2 twice"),
        ({"vary": {"timestep_fs": []}}, "at least one value"),
        ({"vary": {"interval_fs": [50]}}, "multiple of truth.interval_fs"),
        ({"vary": {"case": ["pull"]}}, "found 'pull'; allowed: kick"),
        ({"vary": {"friction_per_ps": [1]}}, "goes with integrator 'Langevin middle'"),
        ({"vary": {"precision": ["double"]}}, "precision goes with platform"),
        ({"vary": {"constraints": ["all"]}}, "input should be 'none' or 'hbonds'"),
        ({"settings": {"speed": 1}, "vary": {"scale": [1]}}, "settings: found 'speed'"),
    ],
)
def test_a_wrong_line_is_refused_by_name(
    tmp_path: Path, line: dict[str, object], message: str
) -> None:
    wrong = study()
    wrong["lines"] = {"wrong": {"title": "wrong", **line}}
    file = tmp_path / "study.yaml"
    file.write_text(yaml.safe_dump(wrong))
    with pytest.raises(InputError) as error:
        load_study(file)
    assert str(error.value).startswith(f"{file}: ")
    assert message in str(error.value)


def test_a_wrong_sequence_and_an_unknown_key_are_refused(tmp_path: Path) -> None:
    wrong = study()
    wrong["systems"] = {"six": {"sequence": "CGAXCG"}}
    wrong["speed"] = 3
    file = tmp_path / "study.yaml"
    file.write_text(yaml.safe_dump(wrong))
    with pytest.raises(InputError) as error:
        load_study(file)
    assert "systems.six.sequence" in str(error.value)
    assert "speed: found an unknown key" in str(error.value)
