"""The JSON Schema of a configuration file, by which editors complete and check it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dnawaves.files import write_json
from dnawaves.scene.models import Configuration


def configuration_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a configuration file."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Configuration.model_json_schema(),
    }


def write_schema(output: Path) -> None:
    """Write the schema as JSON."""
    write_json(output, configuration_schema())
