"""The committed JSON Schema: current, and of one mind with the models."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from dnawaves.files import read_json
from dnawaves.scene.load import load_scenes
from dnawaves.scene.schema import configuration_schema, write_schema

CONFIG = Path(__file__).resolve().parents[2] / "config"
SHIPPED = ["config.yaml", "smoke.yaml", "paper.yaml"]


def configuration(name: str) -> Any:
    return yaml.safe_load((CONFIG / name).read_text(encoding="utf-8"))


def test_the_committed_schema_is_current(tmp_path: Path) -> None:
    # If this fails: dnawaves schema --output config/schema.json
    write_schema(tmp_path / "schema.json")
    assert read_json(CONFIG / "schema.json") == read_json(tmp_path / "schema.json")


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_configurations_fit_the_schema(name: str) -> None:
    jsonschema.validate(configuration(name), configuration_schema())
    first_line = (CONFIG / name).read_text(encoding="utf-8").splitlines()[0]
    assert first_line == "# yaml-language-server: $schema=schema.json"


@pytest.mark.parametrize("name", SHIPPED)
def test_the_schema_refuses_a_misspelt_key(name: str) -> None:
    content = configuration(name)
    validator = jsonschema.Draft202012Validator(configuration_schema())
    for scene, its in content["scenes"].items():
        spoiled = {**its, "excitation": {**its["excitation"], "wavee": "extension"}}
        assert not validator.is_valid({**content, "scenes": {scene: spoiled}})
        assert validator.is_valid({**content, "scenes": {scene: its}})


def test_scenes_of_one_name_are_one_scene_in_all_shipped_configurations() -> None:
    # They share the folder of results.
    loaded = [load_scenes(CONFIG / name) for name in SHIPPED]
    for one, other in combinations(loaded, 2):
        assert [name for name in one.keys() & other.keys() if one[name] != other[name]] == []
    assert loaded[0].keys() <= loaded[2].keys(), "the whole set holds the selection"


def test_the_whole_set_covers_the_papers_waves_lengths_and_environments() -> None:
    scenes = load_scenes(CONFIG / "paper.yaml").values()

    def covered(kind: str) -> set[tuple[str, int, bool]]:
        return {
            (
                getattr(its.excitation, "wave", ""),
                len(its.system.duplex.sequence),
                its.system.thermal,
            )
            for its in scenes
            if its.excitation.kind == kind
        }

    for wave in ("extension", "twist", "bend", "shear"):
        for length in (12, 24, 36, 48):
            assert (wave, length, False) in covered("kick")
        assert (wave, 24, False) in covered("periodic")
    assert ("", 24, False) in covered("none")
    assert ("", 24, True) in covered("none")
    in_water = {its.excitation.wave for its in scenes if its.system.explicit}
    assert in_water == {"extension", "twist"}
    driven = [its.excitation.modes for its in scenes if getattr(its.excitation, "modes", None)]
    assert driven == [(1, 2, 3)] * 8


def test_every_key_of_the_schema_is_described() -> None:
    models = configuration_schema()["$defs"]
    bare = [
        f"{model}.{key}"
        for model, its in models.items()
        for key, value in its["properties"].items()
        # Parts that are models of their own carry their description there.
        if "description" not in value and "$ref" not in value and "discriminator" not in value
    ]
    assert [key for key in bare if not key.endswith(".kind")] == []
