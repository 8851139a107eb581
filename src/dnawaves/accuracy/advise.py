"""The cheapest setting for a scene that errs no more than is wanted, from a study's rows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from dnawaves.accuracy.front import SAME_COST
from dnawaves.accuracy.match import family, row_of, unstudied
from dnawaves.accuracy.table import read_csv
from dnawaves.errors import InputError
from dnawaves.scene.excitations import Kick, StandingWave
from dnawaves.scene.load import load_scene
from dnawaves.scene.models import SceneSpec
from dnawaves.trajectory.explain import expected_cost

WHAT = {
    "waveform": "of the worst base pair's waveform, of its own peak",
    "speed": "of the fitted speed",
    "helical": "of the worst helical parameter, of its own largest response",
}


@dataclass(frozen=True)
class Wanted:
    """What is asked: an error (part of 1) of a measure, or a time; exactly one of the two."""

    measure: str
    error: float | None = None
    minutes: float | None = None


def advise(config: Path, name: str, results: Path, study: Path, wanted: Wanted) -> str:
    """Return in words the setting to take for the scene `name`, as YAML, with error and time.

    Raises
    ------
    InputError
        When not exactly one of error and time is asked for, there is no such scene, no study, or
        none that speaks for the scene.
    """
    if (wanted.error is None) == (wanted.minutes is None):
        raise InputError("give either --error or --time, not both and not neither")
    scene, settings = load_scene(config, name), read_csv(study)
    if reason := unstudied(scene):
        raise InputError(f"scene '{name}': found no setting to choose: {reason}")
    rows = family(settings, scene)
    rows = rows[rows[f"{wanted.measure}_error"].notna()]
    if rows.empty:
        raise InputError(
            f"{study}: found no {wanted.measure} error of {scene.excitation.kind} scenes of "
            f"{getattr(scene.excitation, 'wave', 'no wave')}; allowed: a study that has one"
        )
    step_s, steps = expected_cost(scene, results)
    fs_simulated = steps * scene.observation.timestep_fs
    rows = rows.assign(minutes=times(rows, step_s * fs_simulated / 60))
    return in_words(scene, rows, row_of(rows, scene), wanted)


def times(rows: pd.DataFrame, minutes_at_1_fs: float) -> pd.Series:
    """Return the time of the scene under each setting, in minutes.

    `minutes_at_1_fs` is what its steps would take, had the scene steps of 1 fs. Where the study
    has its default among the rows, times go by the measured ratios, else by steps.
    """
    default = rows[rows["is_default"]]
    if default.empty:
        return minutes_at_1_fs / rows["timestep_fs"]
    first = default.iloc[0]
    ratio = rows["relative_cost"] / float(default["relative_cost"].median())
    return minutes_at_1_fs / float(first["timestep_fs"]) * ratio


def choose(rows: pd.DataFrame, wanted: Wanted) -> pd.Series | None:
    """Return the cheapest row within the error, or the one of least error within the time.

    Among rows that cost the same, which times on a busy machine are known to `SAME_COST`, the one
    of least error. None where there is none.
    """
    column = f"{wanted.measure}_error"
    if wanted.minutes is not None:
        rows = rows[rows["minutes"] <= wanted.minutes]
    else:
        rows = rows[rows[column] <= wanted.error]
        rows = rows[rows["minutes"] <= (1 + SAME_COST) * rows["minutes"].min()]
    return rows.sort_values(column).iloc[0] if len(rows) else None


def in_words(scene: SceneSpec, rows: pd.DataFrame, own: pd.Series | None, wanted: Wanted) -> str:
    """Return the advice, with what the scene's own setting does beside it."""
    column = f"{wanted.measure}_error"
    aim = (
        f"an error of {_percent(wanted.error)}"
        if wanted.error is not None
        else f"a time of {_time(wanted.minutes or 0.0)}"
    )
    chosen = choose(rows, wanted)
    lines = []
    if chosen is None:
        lines.append(f"no setting studied meets {aim}; nearest to it is")
        chosen = rows.sort_values(column if wanted.error is not None else "minutes").iloc[0]
    lines += [
        *yaml_lines(scene, chosen),
        f"expected: error {_percent(chosen[column])} {WHAT[wanted.measure]}; "
        f"{_time(chosen['minutes'])} on one thread of this machine",
    ]
    if own is not None:
        lines.append(
            f"as it is: error {_percent(own[column])}, {_time(own['minutes'])} "
            f"(setting {own['setting']})"
        )
    lines.append(
        f"from {len(rows)} settings of {int(rows['base_pairs'].iloc[0])} base pairs, "
        f"case {rows['case'].iloc[0]}; errors are those against the linear answer"
    )
    if not scene.observation.helical:
        lines.append("`method: harmonic` gives the linear answer itself, from the normal modes")
    return "\n".join(lines)


def yaml_lines(scene: SceneSpec, row: pd.Series) -> list[str]:
    """Return the setting as lines to put into the scene."""
    lines, excitation = [], scene.excitation
    if isinstance(excitation, Kick | StandingWave):
        angular = excitation.velocity_A_per_ps is None
        field = "angular_velocity_rad_per_ps" if angular else "velocity_A_per_ps"
        lines.append(f"    excitation: {{{field}: {row['amplitude']:g}}}")
    lines.append(f"    observation: {{timestep_fs: {row['timestep_fs']:g}}}")
    return lines


def _percent(share: float | None) -> str:
    return f"{100 * (share or 0.0):.2g} %"


def _time(minutes: float) -> str:
    return f"{minutes:.2g} min" if minutes >= 1 else f"{60 * minutes:.2g} s"


def parse_error(text: str) -> float:
    """Return an error given as '2%' or '0.02' as a part of 1."""
    number, percent, rest = text.strip().partition("%")
    try:
        value = float(number) / (100 if percent else 1)
    except ValueError:
        value = 0.0
    if not 0 < value < 100 or rest:
        raise InputError(f"--error: found {text!r}; allowed: a positive number such as 2% or 0.02")
    return value


def parse_minutes(text: str) -> float:
    """Return a time given as '30s', '10min' or '2h' in minutes."""
    units = {"min": 1.0, "h": 60.0, "s": 1 / 60}
    for unit, minutes in units.items():
        if text.strip().endswith(unit):
            try:
                value = float(text.strip().removesuffix(unit)) * minutes
            except ValueError:
                break
            if 0 < value < float("inf"):
                return value
            break
    raise InputError(f"--time: found {text!r}; allowed: such as 30s, 10min or 2h")
