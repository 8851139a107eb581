"""Which rows of a study speak for a scene."""

from __future__ import annotations

import numpy as np
import pandas as pd

from dnawaves.accuracy.table import at_usual_times, succeeded
from dnawaves.scene.excitations import Kick, Nothing, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.models import SceneSpec

# Amplitudes closer than this are the same: what CSV's digits leave.
SAME = 1e-3


def unstudied(scene: SceneSpec) -> str:
    """Return why no setting of a study speaks for a scene, or nothing."""
    if scene.system.thermal:
        return "it is thermal, and the study's runs start at T = 0"
    if scene.method == "harmonic":
        return "method 'harmonic' has no timestep: it is the exact linear answer"
    if isinstance(scene.excitation, Static):
        return "a static load is a minimum, without a timestep"
    if isinstance(scene.excitation, Nothing):
        return "it excites nothing, so that there is no wave to err in"
    return ""


def family(settings: pd.DataFrame, scene: SceneSpec) -> pd.DataFrame:
    """Return the rows for the scene's wave and kind of kick that a scene could declare.

    A pulse and a drive, which are integrated alike, take those of a kick of the same wave and of
    its own size; of standing waves those whose number is nearest, and then those of the duplex
    whose length is nearest.
    """
    excitation = scene.excitation
    assert isinstance(excitation, Kick | StandingWave | Pulse | Periodic)
    kind = "standing_wave" if isinstance(excitation, StandingWave) else "kick"
    rows = succeeded(settings)
    rows = rows[(rows["kind"] == kind) & (rows["wave"] == excitation.wave) & rows["declarable"]]
    rows = rows[(rows["case"] == rows["usual_case"]) & rows["replicas"].isna()]
    rows = rows[at_usual_times(rows)]
    if isinstance(excitation, StandingWave) and len(rows):
        away = np.abs(rows["mode"] - excitation.mode)
        rows = rows[away == away.min()]
    if len(rows):
        away = np.abs(rows["base_pairs"] - len(scene.system.duplex.sequence))
        rows = rows[away == away.min()]
    if isinstance(excitation, Pulse | Periodic):
        rows = rows[rows["scale"] == 1]
    return rows


def row_of(settings: pd.DataFrame, scene: SceneSpec) -> pd.Series | None:
    """Return the row of the scene's own setting, None where it has not been studied."""
    rows = family(settings, scene)
    rows = rows[np.isclose(rows["timestep_fs"], scene.observation.timestep_fs)]
    excitation = scene.excitation
    if isinstance(excitation, Kick | StandingWave):
        rows = rows[np.isclose(rows["amplitude"], excitation.amplitude, rtol=SAME)]
    return rows.iloc[0] if len(rows) else None


def shipped(settings: pd.DataFrame, scenes: dict[str, SceneSpec]) -> pd.DataFrame:
    """Return each scene with its row's `setting`, or in `reason` why there is none."""
    found = []
    for name, scene in scenes.items():
        reason, setting = unstudied(scene), ""
        if not reason:
            row = row_of(settings, scene)
            if row is None:
                reason = "its setting is not among those studied"
            else:
                setting = str(row["setting"])
        found.append({"scene": name, "setting": setting, "reason": reason})
    return pd.DataFrame(found, columns=["scene", "setting", "reason"])
