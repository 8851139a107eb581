"""What each effect saves and what it loses, from a study's two tables."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from dnawaves.accuracy.row import OK

# Effects of numerics by their lines, and the setting that stands for each.
NUMERIC = {
    "hbonds": "constraints",
    "heavy_hydrogen": "hydrogen mass",
    "hbonds_heavy": "constraints and hydrogen mass",
    "friction": "thermostat",
    "multiple_timestep": "multiple timestep",
    "double": "double precision",
    "cutoff": "smooth cutoff, given up",
}
# Effects that change the molecule, by the systems that have them.
MOLECULAR = {
    "cutoff_": "cutoff",
    "counterions": "condensed counterions",
    "OBC": "implicit solvent",
    "OL": "force field",
    "bsc": "force field",
    "another_minimum": "none: another minimum",
    "third_minimum": "none: another minimum",
}


# The effect's name in the table of costs per step.
PER_STEP = {
    "constraints": "constraints",
    "thermostat": "thermostat",
    "implicit solvent": "implicit solvent",
    "cutoff": "nonbonded",
    "none: as shipped": "nonbonded",
}


@dataclass(frozen=True)
class Effect:
    """One line of the table: what is changed, what it costs, what it does to the answer.

    `cost` is in parts of the default's time; `per_step` names the force or effect behind it and
    its part of a step, where it has been measured by leaving it out. Changes and errors are parts
    of 1; errors are those of the integration where the effect leaves the molecule alone, None
    where it has none.
    """

    effect: str
    setting: str
    cost: float | None
    per_step: str
    speed: float | None
    waveform: float | None
    helical: float | None
    note: str


def effects(settings: pd.DataFrame, models: pd.DataFrame, costs: pd.DataFrame) -> list[Effect]:
    """Return the table 'what you save, what you lose': numerics first, then other molecules.

    `costs` holds what each effect costs per step, for the study's own system first.
    """
    own = costs["system"].iloc[0] if len(costs) else ""
    found = []
    for _, row in settings[settings["line"].isin(NUMERIC)].iterrows():
        found.append(
            Effect(
                NUMERIC[row["line"]],
                f"{row['title']}: {row['label']}",
                _number(row["relative_cost"]),
                _per_step(costs, own, NUMERIC[row["line"]]),
                _number(row["speed_integration_error"]),
                _number(row["waveform_integration_error"]),
                _number(row["helical_integration_error"]),
                "" if row["status"] == OK else str(row["status"]),
            )
        )
    for _, row in models.iterrows():
        name = str(row["label"])
        effect = next(
            (what for start, what in MOLECULAR.items() if name.startswith(start)),
            "none: as shipped",
        )
        note = "" if row["status"] == OK else str(row["status"])
        found.append(
            Effect(
                effect,
                name.replace("_", " "),
                _number(row["relative_cost"]),
                _per_step(costs, own if row["is_default"] else name, effect),
                _number(row["rate_change"]),
                None,
                None,
                note
                or f"rise {row['rise_A']:.2f} Å, roll {row['roll_deg']:.1f}°, "
                f"twist {row['twist_deg']:.1f}°",
            )
        )
    return found


def _per_step(costs: pd.DataFrame, system: str, effect: str) -> str:
    name = PER_STEP.get(effect, "")
    row = costs[(costs["system"] == system) & (costs["effect"] == name)]
    if row.empty:
        return ""
    part = row["ms_saved"].iloc[0] / row["ms_per_step_whole"].iloc[0]
    return f"{name}: {100 * part:.0f} % of a step"


def _number(value: float) -> float | None:
    return None if pd.isna(value) else float(value)
