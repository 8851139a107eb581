"""One scene or system of a configuration file, with all its names resolved, as a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dnawaves.errors import InputError
from dnawaves.files import write_json
from dnawaves.scene.load import load_scenes
from dnawaves.scene.model import Model


def freeze(config: Path, scene: str | None, system: str | None, output: Path) -> None:
    """Write the scene or the system of that name; exactly one of the two is given.

    Raises
    ------
    InputError
        When not exactly one is given, the configuration has none of that name, or is refused.
    """
    if (scene is None) == (system is None):
        raise InputError("give either --scene or --system, not both and not neither")
    if scene is not None:
        freeze_scene(config, scene, output)
    elif system is not None:
        freeze_system(config, system, output)


def freeze_scene(config: Path, name: str, output: Path) -> None:
    """Write the `SceneSpec` of one scene as JSON."""
    _write(output, config, "scene", name, load_scenes(config))


def freeze_system(config: Path, name: str, output: Path) -> None:
    """Write the `SystemSpec` of one system, named `<duplex>-<environment>`, as JSON."""
    systems = {scene.system.name: scene.system for scene in load_scenes(config).values()}
    _write(output, config, "system", name, systems)


def _write(output: Path, config: Path, kind: str, name: str, known: Mapping[str, Model]) -> None:
    if name not in known:
        raise InputError(f"{config}: {kind}: found {name!r}; allowed: {', '.join(sorted(known))}")
    write_json(output, known[name].model_dump(mode="json"))
