"""The settings of a study, one by one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from dnawaves.accuracy.models import Case, Line, Numerics, Study, StudySystem, multiple_of
from dnawaves.errors import InputError
from dnawaves.scene.model import Model
from dnawaves.scene.models import NamedDuplex, SystemSpec
from dnawaves.scene.yaml_file import read_yaml


class Setting(Model):
    """One setting with everything that its names stand for.

    The time of `numerics` on `case` is held against that of `default` on `usual`.
    """

    name: str
    line: str
    title: str
    table: str
    slope: str | None
    label: str
    case_name: str
    case: Case
    system: StudySystem
    numerics: Numerics
    usual_name: str
    usual: Case
    usual_system: StudySystem
    default: Numerics
    converged: bool

    @property
    def is_default(self) -> bool:
        """Whether it is the default on its line's own case."""
        return self.numerics == self.default and self.case_name == self.usual_name


@dataclass(frozen=True)
class LoadedStudy:
    """A study with its settings by name."""

    study: Study
    settings: dict[str, Setting]

    @property
    def cases(self) -> dict[str, Case]:
        """The cases that settings are run on, and no others."""
        used = {setting.case_name for setting in self.settings.values()}
        return {name: case for name, case in self.study.cases.items() if name in used}

    @property
    def systems(self) -> dict[str, StudySystem]:
        """The systems of those cases, and those whose time is the measure."""
        used = {setting.case.system for setting in self.settings.values()}
        used |= {setting.usual.system for setting in self.settings.values()} | {*self.study.costs}
        return {name: system for name, system in self.study.systems.items() if name in used}


def load_study(path: Path) -> LoadedStudy:
    """Return a study file's settings.

    Raises
    ------
    InputError
        Names the file and the field, what was found and what is allowed.
    """
    raw = read_yaml(path)
    try:
        study = Study.model_validate(raw)
    except ValidationError as error:
        raise InputError("\n".join(f"{path}: {_in_words(one)}" for one in error.errors())) from None
    try:
        return LoadedStudy(study, expand(study))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def expand(study: Study) -> dict[str, Setting]:
    """Return the settings of all lines by name."""
    settings: dict[str, Setting] = {}
    for name, line in study.lines.items():
        for index in range(len(next(iter(line.vary.values())))):
            try:
                setting = _setting(study, name, line, index)
            except ValueError as error:
                raise InputError(f"line '{name}': {_message(error)}") from None
            if setting.name in settings:
                raise InputError(f"line '{name}': vary: found {setting.label} twice")
            settings[setting.name] = setting
    return settings


def system_spec(name: str, system: StudySystem) -> SystemSpec:
    """Return what the rest of the library calls a system."""
    return SystemSpec(
        duplex=NamedDuplex(name=name, sequence=system.sequence),
        environment_name="study",
        environment=system.environment,
    )


def _setting(study: Study, name: str, line: Line, index: int) -> Setting:
    changed = {field: values[index] for field, values in line.vary.items()}
    label = ", ".join(_label(value) for value in changed.values())
    file_name = f"{name}-{label}".replace(", ", "-").replace(" ", "_")
    usual_name = line.case or study.case
    case_name = str(changed.pop("case", usual_name))
    numerics = Numerics.model_validate({**study.default.model_dump(), **line.settings, **changed})
    if not multiple_of(numerics.interval_fs, study.truth.interval_fs):
        raise ValueError(
            f"interval_fs must be a multiple of truth.interval_fs "
            f"({study.truth.interval_fs:g}), found {numerics.interval_fs:g}"
        )
    case, usual = study.cases[case_name], study.cases[usual_name]
    return Setting(
        name=file_name,
        line=name,
        title=line.title,
        table=line.table,
        slope=line.slope,
        label=label,
        case_name=case_name,
        case=case,
        system=study.systems[case.system],
        numerics=numerics,
        usual_name=usual_name,
        usual=usual,
        usual_system=study.systems[usual.system],
        default=study.default,
        # The converged answer is that of the case's own kick, run with its own masses and forces.
        converged=case.converged and numerics.scale == 1 and numerics.replicas is None,
    )


def _label(value: object) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def _message(error: ValueError) -> str:
    if isinstance(error, ValidationError):
        return "; ".join(_in_words(one) for one in error.errors())
    return str(error)


def _in_words(error: ErrorDetails) -> str:
    where = ".".join(str(part) for part in error["loc"])
    message = error["msg"].removeprefix("Value error, ")
    if error["type"] == "extra_forbidden":
        message = "found an unknown key"
    elif error["type"] == "missing":
        message = "found nothing; allowed: it must be given"
    elif error["type"] != "value_error":
        message = f"found {error['input']!r}; allowed: {message[0].lower()}{message[1:]}"
    return f"{where}: {message}" if where else message
