"""Scenes that differ in one thing only: in the inherent structure, or in the duplex's length."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from dnawaves.scene.models import SceneSpec

Spec = dict[str, Any]

STRUCTURES, LENGTHS = "inherent structures", "lengths"


@dataclass(frozen=True)
class Group:
    """Scenes that are the same but for `kind`; the first stands for all of them."""

    kind: str
    scenes: tuple[str, ...]


def groups(scenes: Iterable[SceneSpec]) -> list[Group]:
    """Return all groups of two scenes and more, in the scenes' order."""
    specs = list(scenes)
    found = []
    for kind, mask in ((STRUCTURES, _without_seed), (LENGTHS, _without_duplex)):
        alike: dict[str, list[SceneSpec]] = {}
        for spec in specs:
            alike.setdefault(_key(spec, mask), []).append(spec)
        for members in alike.values():
            chosen = members if kind == STRUCTURES else _of_different_length(members)
            if len(chosen) > 1:
                found.append(Group(kind, tuple(spec.name for spec in chosen)))
    return found


def _key(spec: SceneSpec, mask: Callable[[Spec], None]) -> str:
    content = spec.model_dump(mode="json", exclude={"name"})
    mask(content)
    return json.dumps(content, sort_keys=True)


def _without_seed(content: Spec) -> None:
    system = content["system"]
    relaxation = system["environment"]["relaxation"]
    # An equilibrated system has no inherent structure.
    if relaxation is not None:
        del relaxation["seed"], system["environment_name"]


def _without_duplex(content: Spec) -> None:
    del content["system"]["duplex"]


def _of_different_length(members: list[SceneSpec]) -> list[SceneSpec]:
    """Return those whose sequence is part of the longest one's: then only the length differs."""
    longest = max((spec.system.duplex.sequence for spec in members), key=len)
    inside = {spec.system.duplex.sequence: spec for spec in members[::-1]}
    return [
        spec
        for spec in members
        if spec.system.duplex.sequence in longest
        and inside[spec.system.duplex.sequence].name == spec.name
    ]
