"""The committed JSON Schema: current, and of one mind with the models."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from dnawaves.files import read_json
from dnawaves.scene.schema import configuration_schema, write_schema

CONFIG = Path(__file__).resolve().parents[2] / "config"
BOTH = ["config.yaml", "smoke.yaml"]


def configuration(name: str) -> Any:
    return yaml.safe_load((CONFIG / name).read_text(encoding="utf-8"))


def test_the_committed_schema_is_current(tmp_path: Path) -> None:
    # If this fails: dnawaves schema --output config/schema.json
    write_schema(tmp_path / "schema.json")
    assert read_json(CONFIG / "schema.json") == read_json(tmp_path / "schema.json")


@pytest.mark.parametrize("name", BOTH)
def test_the_shipped_configurations_fit_the_schema(name: str) -> None:
    jsonschema.validate(configuration(name), configuration_schema())
    first_line = (CONFIG / name).read_text(encoding="utf-8").splitlines()[0]
    assert first_line == "# yaml-language-server: $schema=schema.json"


@pytest.mark.parametrize("name", BOTH)
def test_the_schema_refuses_a_misspelt_key(name: str) -> None:
    content = configuration(name)
    for scene in content["scenes"]:
        spoiled = copy.deepcopy(content)
        spoiled["scenes"][scene]["excitation"]["wavee"] = "extension"
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(spoiled, configuration_schema())


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
