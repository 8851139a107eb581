"""Read configuration and structures files; refuse what cannot be run, before anything is run."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from dnawaves.errors import InputError
from dnawaves.files import read_json
from dnawaves.scene.contradictions import contradictions
from dnawaves.scene.duplexes import load_duplexes
from dnawaves.scene.environment import Environment
from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.models import Configuration, NamedDuplex, Scene, SceneSpec, SystemSpec
from dnawaves.scene.pairs import excited_pairs, fixed_counts, held_pairs
from dnawaves.scene.yaml_file import read_yaml

Spec = TypeVar("Spec", SceneSpec, SystemSpec)


def load_scenes(path: Path) -> dict[str, SceneSpec]:
    """Return every scene of a configuration file with all its names resolved.

    Raises
    ------
    InputError
        Names the file, the scene and the field, what was found and what is allowed.
    """
    raw = read_yaml(path)
    try:
        configuration = Configuration.model_validate(raw)
    except ValidationError as error:
        raise InputError("\n".join(_explain_one(path, one) for one in _told(error))) from None
    structures = path.parent / configuration.structures
    if not structures.is_file():
        raise InputError(
            f"{path}: structures: found {configuration.structures!r}; allowed: a file of named "
            f"sequences, relative to this one (there is none at {structures})"
        )
    duplexes = load_duplexes(structures)
    return {
        name: _resolve(path, structures, configuration, duplexes, name)
        for name in configuration.scenes
    }


def load_scene(path: Path, name: str) -> SceneSpec:
    """Return one scene of a configuration file; raises `InputError` where there is none."""
    return named(path, "scene", name, load_scenes(path))


def named(path: Path, kind: str, name: str, known: Mapping[str, Spec]) -> Spec:
    """Return the scene or system of that name; raises `InputError` with all names there are."""
    if name not in known:
        hint = _hint(name, known)
        raise InputError(
            f"{path}: {kind}: found {name!r}{hint}; allowed: {', '.join(sorted(known))}"
        )
    return known[name]


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
    duplexes: Mapping[str, NamedDuplex],
    name: str,
) -> SceneSpec:
    scene = configuration.scenes[name]

    def refuse(field: str, found: object, allowed: str) -> NoReturn:
        raise InputError(f"{path}: scene '{name}': {field}: found {found!r}; allowed: {allowed}")

    if scene.duplex not in duplexes:
        refuse("duplex", scene.duplex, f"{_listed(duplexes)} (from {structures})")
    if scene.environment not in configuration.environments:
        refuse("environment", scene.environment, _listed(configuration.environments))
    duplex = duplexes[scene.duplex]
    environment = configuration.environments[scene.environment]
    pairs = len(duplex.sequence)
    _check_room(scene, pairs, refuse)
    _check_numbers(scene, environment, pairs, refuse)
    _check_sweep(scene, configuration, refuse)
    if found := _contradictions(scene, environment, pairs):
        raise InputError(f"{path}: scene '{name}': {'; '.join(found)}")
    return SceneSpec(
        name=name,
        system=SystemSpec(
            duplex=duplex,
            environment_name=scene.environment,
            environment=environment,
        ),
        ends=scene.ends,
        excitation=scene.excitation,
        observation=scene.observation,
        method=scene.method,
        masses=scene.masses,
        thermostat=scene.thermostat,
        replicas=scene.replicas,
    )


def _check_room(scene: Scene, pairs: int, refuse: Any) -> None:
    free = pairs - sum(fixed_counts(scene.ends))
    if free < 2:
        refuse("ends.pairs", scene.ends.pairs, f"at least 2 of the {pairs} base pairs stay free")
    excitation = scene.excitation
    if isinstance(excitation, Kick | Pulse | Periodic):
        if excitation.pairs >= free:
            refuse("excitation.pairs", excitation.pairs, f"fewer than the {free} free base pairs")
        last = pairs - excitation.pairs + 1
        if excitation.first_pair is not None and excitation.first_pair > last:
            refuse(
                "excitation.first_pair",
                excitation.first_pair,
                f"1 to {last}, from which on {excitation.pairs} of the {pairs} base pairs follow",
            )
    if isinstance(excitation, StandingWave) and excitation.mode > free:
        refuse("excitation.mode", excitation.mode, f"1 to {free}, the number of free base pairs")
    if isinstance(excitation, Periodic) and max(excitation.modes or (1,)) > free:
        refuse(
            "excitation.modes",
            list(excitation.modes or ()),
            f"1 to {free}, the number of free base pairs",
        )


def _check_numbers(scene: Scene, environment: Environment, pairs: int, refuse: Any) -> None:
    start = environment.relaxation.start if environment.relaxation else None
    for field, wanted in (
        ("masses.pair", max((added.pair for added in scene.masses), default=1)),
        ("environment.relaxation.start.last", start.last if start else 1),
    ):
        if wanted > pairs:
            refuse(field, wanted, f"1 to {pairs}, the number of base pairs")


def _check_sweep(scene: Scene, configuration: Configuration, refuse: Any) -> None:
    excitation = scene.excitation
    if not isinstance(excitation, Periodic) or excitation.sweep is None:
        return
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


def _contradictions(scene: Scene, environment: Environment, pairs: int) -> list[str]:
    """Return the contradictions of a scene's effects with each other and its environment's."""
    excitation = scene.excitation
    steady = environment.equilibration
    excited: list[int] = []
    if isinstance(excitation, Kick | Pulse | Periodic):
        excited = excited_pairs(excitation, scene.ends)
    found = contradictions(
        frozen=held_pairs(scene.ends, pairs),
        heavier=[added.pair - 1 for added in scene.masses],
        excited=excited,
        constraints=environment.constraints,
        thermostat=scene.thermostat is not None,
        temperature_K=environment.temperature_K,
        harmonic=scene.method == "harmonic",
        static=isinstance(excitation, Static),
        replicas=scene.replicas,
        snapshots=steady.snapshots if steady else None,
        periods=excitation.periods if isinstance(excitation, Periodic) else None,
        duration_ps=scene.observation.duration_ps,
    )
    return [str(one) for one in found]


def _told(error: ValidationError) -> list[ErrorDetails]:
    """Return the mistakes, without that a list is too short because its items are refused."""
    found = error.errors()
    return [
        one
        for one in found
        if one["type"] != "too_short" or not any(other["loc"][:-1] == one["loc"] for other in found)
    ]


def _hint(found: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(found, known, n=1)
    return f" (did you mean '{near[0]}'?)" if near else ""


def _explain_one(path: Path, error: ErrorDetails) -> str:
    location = [str(part) for part in error["loc"]]
    model, where, field = _locate(location)
    start = f"{path}: {where}{'.'.join(field)}".rstrip(": ")
    message = error["msg"].removeprefix("Value error, ")
    if error["type"] == "extra_forbidden":
        known = [its.alias or name for name, its in model.model_fields.items()]
        return f"{start}: found an unknown key{_hint(field[-1], known)}; allowed: {_listed(known)}"
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
