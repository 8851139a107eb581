"""Read configuration and structures files; refuse what cannot be run, before anything is run."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar, get_args

import yaml
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from dnawaves.errors import InputError
from dnawaves.files import read_json
from dnawaves.scene.contradictions import contradictions
from dnawaves.scene.environment import Environment
from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import Configuration, NamedDuplex, Scene, SceneSpec, SystemSpec
from dnawaves.scene.pairs import held_pairs
from dnawaves.scene.sequence import check_sequence

Spec = TypeVar("Spec", SceneSpec, SystemSpec)


def load_scenes(path: Path) -> dict[str, SceneSpec]:
    """Return every scene of a configuration file with all its names resolved.

    Raises
    ------
    InputError
        Names the file, the scene and the field, what was found and what is allowed.
    """
    raw = _read_yaml(path)
    try:
        configuration = Configuration.model_validate(raw)
    except ValidationError as error:
        raise InputError("\n".join(_explain_one(path, one) for one in error.errors())) from None
    structures = path.parent / configuration.structures
    if not structures.is_file():
        raise InputError(
            f"{path}: structures: found {configuration.structures!r}; allowed: a file of named "
            f"sequences, relative to this one (there is none at {structures})"
        )
    sequences = load_sequences(structures)
    return {
        name: _resolve(path, structures, configuration, sequences, name)
        for name in configuration.scenes
    }


def load_sequences(path: Path) -> dict[str, str]:
    """Return the sequences of a structures file by name; strand I from 5' to 3'."""
    raw = _read_yaml(path)
    if not isinstance(raw, Mapping) or not raw:
        raise InputError(f"{path}: expected a mapping of names to sequences")
    sequences: dict[str, str] = {}
    for name, sequence in raw.items():
        where = f"{path}: duplex '{name}'"
        if not isinstance(sequence, str):
            raise InputError(f"{where}: found {sequence!r}; allowed: a sequence, such as CGCG")
        try:
            check_sequence(sequence)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        sequences[str(name)] = sequence
    return sequences


def read_scene(path: Path) -> SceneSpec:
    """Read a resolved scene as `dnawaves freeze` wrote it."""
    return _read_spec(SceneSpec, path)


def read_system(path: Path) -> SystemSpec:
    """Read a resolved system as `dnawaves freeze` wrote it."""
    return _read_spec(SystemSpec, path)


def _read_spec(model: type[Spec], path: Path) -> Spec:
    try:
        return model.model_validate(read_json(path))
    except ValueError as error:
        raise InputError(f"{path}: is not what `dnawaves freeze` writes: {error}") from None


def _resolve(
    path: Path,
    structures: Path,
    configuration: Configuration,
    sequences: Mapping[str, str],
    name: str,
) -> SceneSpec:
    scene = configuration.scenes[name]

    def refuse(field: str, found: object, allowed: str) -> NoReturn:
        raise InputError(f"{path}: scene '{name}': {field}: found {found!r}; allowed: {allowed}")

    if scene.duplex not in sequences:
        refuse("duplex", scene.duplex, f"{_listed(sequences)} (from {structures})")
    if scene.environment not in configuration.environments:
        refuse("environment", scene.environment, _listed(configuration.environments))
    sequence = sequences[scene.duplex]
    free = _check_room(scene, len(sequence), refuse)
    excitation = scene.excitation
    if isinstance(excitation, Periodic) and excitation.sweep:
        candidates = [
            other
            for other, its in configuration.scenes.items()
            if isinstance(its.excitation, Kick | StandingWave)
            and its.excitation.wave == excitation.wave
            and (its.duplex, its.environment) == (scene.duplex, scene.environment)
        ]
        for source in excitation.sweep.scenes:
            if source not in candidates:
                refuse(
                    "excitation.sweep.scenes",
                    source,
                    "kick or standing-wave scenes of the same wave, duplex and environment: "
                    f"{_listed(candidates)}",
                )
    _check_pairs_of_effects(
        scene, configuration.environments[scene.environment], len(sequence), refuse
    )
    if isinstance(excitation, StandingWave) and excitation.mode > free:
        refuse("excitation.mode", excitation.mode, f"1 to {free}, the number of free base pairs")
    return SceneSpec(
        name=name,
        system=SystemSpec(
            duplex=NamedDuplex(name=scene.duplex, sequence=sequence),
            environment_name=scene.environment,
            environment=configuration.environments[scene.environment],
        ),
        ends=scene.ends,
        excitation=excitation,
        observation=scene.observation,
        method=scene.method,
        masses=scene.masses,
        thermostat=scene.thermostat,
        replicas=scene.replicas,
    )


def _check_pairs_of_effects(
    scene: Scene, environment: Environment, pairs: int, refuse: Any
) -> None:
    heavier = [added.pair for added in scene.masses]
    start = environment.relaxation.start if environment.relaxation else None
    for field, wanted in (
        ("masses.pair", max(heavier, default=1)),
        ("environment.relaxation.start.last", start.last if start else 1),
    ):
        if wanted > pairs:
            refuse(field, wanted, f"1 to {pairs}, the number of base pairs")
    found = contradictions(
        frozen=held_pairs(scene.ends, pairs), heavier=[pair - 1 for pair in heavier]
    )
    if found:
        refuse("masses", heavier, "; ".join(map(str, found)))


def _check_room(scene: Scene, pairs: int, refuse: Any) -> int:
    held = [scene.ends.first, scene.ends.last].count("held") * scene.ends.pairs
    free = pairs - held
    if free < 2:
        refuse("ends.pairs", scene.ends.pairs, f"at least 2 of the {pairs} base pairs stay free")
    excitation = scene.excitation
    if isinstance(excitation, Kick | Pulse | Periodic) and excitation.pairs >= free:
        refuse("excitation.pairs", excitation.pairs, f"fewer than the {free} free base pairs")
    return free


class _UniqueKeys(yaml.SafeLoader):
    """A safe loader that refuses a key given twice instead of dropping the first."""


def _unique_mapping(loader: _UniqueKeys, node: yaml.MappingNode) -> dict[Any, Any]:
    loader.flatten_mapping(node)
    keys = [loader.construct_object(key) for key, _ in node.value]
    for key_node, key in zip((key for key, _ in node.value), keys, strict=True):
        if keys.count(key) > 1:
            raise yaml.constructor.ConstructorError(
                None, None, f"key {key!r} is given twice", key_node.start_mark
            )
    mapping: dict[Any, Any] = loader.construct_mapping(node, deep=True)
    return mapping


_UniqueKeys.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _unique_mapping)


def _read_yaml(path: Path) -> Any:
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        return yaml.load(text, Loader=_UniqueKeys)
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not valid YAML: {error}") from None


def _explain_one(path: Path, error: ErrorDetails) -> str:
    location = [str(part) for part in error["loc"]]
    model, where, field = _locate(location)
    start = f"{path}: {where}{'.'.join(field)}".rstrip(": ")
    message = error["msg"].removeprefix("Value error, ")
    if error["type"] == "extra_forbidden":
        known = list(model.model_fields)
        near = difflib.get_close_matches(field[-1], known, n=1)
        hint = f" (did you mean '{near[0]}'?)" if near else ""
        return f"{start}: found an unknown key{hint}; allowed: {_listed(known)}"
    if error["type"] == "missing":
        return f"{start}: found nothing; allowed: it must be given"
    if error["type"] == "value_error":
        return f"{start}: {message}"
    if error["type"] in ("union_tag_invalid", "union_tag_not_found"):
        found = repr(error["ctx"]["tag"]) if "tag" in error["ctx"] else "nothing"
        kinds = _kinds(_annotation(model, field[-1]))
        return f"{start}.kind: found {found}; allowed: {_listed(kinds)}"
    return f"{start}: found {error['input']!r}; allowed: {message[0].lower()}{message[1:]}"


def _locate(location: list[str]) -> tuple[type[BaseModel], str, list[str]]:
    """Return the innermost model on the way, the entry's name in words, and the field's path."""
    model: type[BaseModel] = Configuration
    where = ""
    field: list[str] = []
    inside: list[type[BaseModel]] = []
    for depth, part in enumerate(location):
        if depth == 1 and location[0] in ("scenes", "environments"):
            where, field = f"{location[0][:-1]} '{part}': ", []
            model = inside[0]
            continue
        tagged = [its for its in inside if part in get_args(_annotation(its, "kind"))]
        if tagged:
            # A tagged union puts its tag into the location; the file has no such level.
            model = tagged[0]
            continue
        # Pydantic's word for a name that is itself refused.
        field.append("name" if part == "[key]" else part)
        inside = list(_models(_annotation(model, part)))
        if len(inside) == 1 and depth + 1 < len(location) and depth > 0:
            model = inside[0]
    return model, where, field


def _annotation(model: type[BaseModel], field: str) -> Any:
    info = model.model_fields.get(field)
    return info.annotation if info else None


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models(part)


def _kinds(annotation: Any) -> Iterator[str]:
    for model in _models(annotation):
        yield from get_args(_annotation(model, "kind"))


def _listed(names: Iterable[str]) -> str:
    return ", ".join(sorted(names)) or "none"
