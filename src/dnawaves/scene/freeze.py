"""One scene or system of a configuration file, with all its names resolved, as a file."""

from __future__ import annotations

from pathlib import Path

from dnawaves.errors import InputError
from dnawaves.files import write_json
from dnawaves.scene.load import load_scene, load_scenes, named


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
    write_json(output, load_scene(config, name).model_dump(mode="json"))


def freeze_system(config: Path, name: str, output: Path) -> None:
    """Write the `SystemSpec` of one system, named `<duplex>-<environment>`, as JSON."""
    systems = {scene.system.name: scene.system for scene in load_scenes(config).values()}
    write_json(output, named(config, "system", name, systems).model_dump(mode="json"))
