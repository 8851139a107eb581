"""Three questions and their answers: the paper's constants, the rod itself, what waves imply."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from dnawaves.comparison.agreement import lowest_first
from dnawaves.comparison.compare import NULL_WORDS, ONE, doubt, sound, speed_of
from dnawaves.comparison.judge import CONFIDENCE, Band, largest_rate
from dnawaves.comparison.predictions import constant
from dnawaves.report.gather import Results, SystemResults
from dnawaves.report.numbers import band, counted, digits, listed, percent
from dnawaves.rod.rod import BEND_1, EXTENSION, SHEAR_1, TWIST, Rod
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.record import AXIAL_WAVES

WAVES = ("extension", "twist", "bend", "shear")
# Which estimate speaks for a wave, the first that there is, and in which words.
HOW = {
    "standing wave": "by the lowest standing wave",
    "thermal spectrum": "by the spectra of thermal motion",
    "thermal": "by thermal motion",
    "resonance": "by the resonance of driven scenes",
    "static, no load": "by the stiffness under a vanishing load",
    "waveform": "by the fit to the long waves of a kick",
    "arrival": "by the arrival of a front",
}
# Of each wave: its constant in words, by which name a table of constants has it, its place in the
# stiffness matrix. Extension is the faster of two coupled waves: the twist has no time to follow,
# as the length has in a wave of twist.
CONSTANTS = {
    "extension": ("stretch modulus at fixed twist, pN", "stretch_modulus_pN", EXTENSION),
    "twist": ("twist rigidity, pN nm²", "twist_rigidity_relaxed_pN_nm2", TWIST),
    "bend": ("bend rigidity, pN nm²", "bend_rigidity_pN_nm2", BEND_1),
    "shear": ("shear stiffness, pN", "shear_stiffness_pN", SHEAR_1),
}


@dataclass(frozen=True)
class Line:
    """What one wave says: the word and number that count, and what else was found."""

    wave: str
    word: str
    number: str
    more: str
    # Shorter waves of the same structure were judged otherwise.
    lowest_alone: bool = False


@dataclass(frozen=True)
class Answer:
    """A question, its answer in a sentence, and the numbers behind it, wave by wave."""

    question: str
    answer: str
    lines: list[Line]


@dataclass(frozen=True)
class Finding:
    """An estimate that has a say: of one structure, of several, or of thermal motion.

    `shorter` are the sound estimates from shorter standing waves beside it.
    """

    where: str
    row: pd.Series
    shorter: tuple[pd.Series, ...] = ()

    def words(self, rod: str) -> list[str]:
        """Return how the shorter waves were judged against a rod."""
        return [str(one[f"verdict_{rod}"]) for one in self.shorter]

    def told(self, rod: str) -> str:
        """Return the ratios of the shorter waves to a rod's; empty where there are none."""
        ratios = (
            f"{_ratio(one, rod)}, {word}"
            for one, word in zip(self.shorter, self.words(rod), strict=True)
        )
        return f"; shorter waves: {'; '.join(ratios)}" if self.shorter else ""


def answers(results: Results) -> list[Answer]:
    """Return the three answers that the verdicts in the table give."""
    found = {wave: list(_findings(results, wave)) for wave in WAVES}
    return [
        _judged(found, "paper", "Are the paper's constants right?", "× the paper's"),
        _judged(
            found, "rod", "Is the rod right, with constants of the same molecule?", "× its rod's"
        ),
        _implied(results, found),
    ]


def lead(rows: pd.DataFrame) -> pd.Series | None:
    """Return the estimate that speaks for one wave in one system, a sound one if there is any."""
    known = sound(rows[rows["speed_A_per_ps"].notna()])
    for estimator in HOW:
        chosen = lowest_first(known[known["estimator"].str.startswith(estimator)])
        if len(chosen):
            found: pd.Series = chosen.iloc[0]
            return found
    return None


def main_system(results: Results) -> SystemResults:
    """Return the system that has the most scenes, one at T = 0 if there is any."""
    scenes = results.table.groupby("system")["scene"].nunique()
    name = max(
        results.systems,
        key=lambda name: (not results.systems[name].spec.thermal, int(scenes.get(name, 0))),
    )
    return results.systems[name]


def false_alarms(table: pd.DataFrame) -> str:
    """Return how often the estimators saw a wave where none was put in."""
    nulls = table[table["verdict"].isin(NULL_WORDS.values()) & table["speed_A_per_ps"].isna()]
    if nulls.empty:
        return "No null scene was run: how often a wave is seen where there is none is not known."
    nominal = (
        "On 200 synthetic records of noise alone 10 to 15 were seen at a nominal 5 % "
        "(benchmarks/estimators.py)."
    )
    alarms = int(nulls["verdict"].eq("false alarm").sum())
    scenes = nulls["scene"].nunique()
    return (
        f"False alarms: in {counted(scenes, 'null scene')}, in which nothing was put in, "
        f"{alarms} of {len(nulls)} searches saw a wave; that excludes a rate above "
        f"{percent(largest_rate(alarms, len(nulls)))} at {percent(CONFIDENCE)}. "
        f"{nominal}"
    )


def _findings(results: Results, wave: str) -> Iterator[Finding]:
    """Return what has a say about a wave: structures together, one of them, temperatures."""
    table = results.table[results.table["wave"] == wave]
    over = table[table["scope"].str.contains("structures")]
    for _, row in over.iterrows():
        yield Finding(str(row["scope"]), row)
    single = table[table["scope"] == ONE]
    cold, warm = (
        [name for name, its in results.systems.items() if its.spec.thermal == thermal]
        for thermal in (False, True)
    )
    # A system that only widens a spread, with fewer scenes than the largest, does not speak alone.
    main = main_system(results).spec.name
    for name in [*(name for name in cold if name == main), *warm]:
        spoken = lead(single[single["system"] == name])
        if spoken is not None:
            kelvin = results.systems[name].spec.environment.temperature_K
            place = f"{kelvin:g} K" if name in warm else "one structure"
            yield Finding(
                f"{place}, {spoken['estimator']}",
                spoken,
                _shorter(single[single["system"] == name], spoken),
            )


def _shorter(rows: pd.DataFrame, lowest: pd.Series) -> tuple[pd.Series, ...]:
    """Return the sound standing waves above the lowest one, by frequency."""
    if lowest["estimator"] != "standing wave":
        return ()
    standing = rows[(rows["estimator"] == "standing wave") & (rows["method"] == lowest["method"])]
    above = standing[standing["frequency_GHz"] > lowest["frequency_GHz"]]
    sure = [one for _, one in lowest_first(above).iterrows() if not doubt(one)]
    return tuple(sure)


def _judged(found: Mapping[str, Sequence[Finding]], rod: str, question: str, unit: str) -> Answer:
    """Return the answer of the words against one rod.

    Of a wave the first finding that decides has the say: several structures before one.
    """
    lines = []
    for wave, findings in found.items():
        judged = [one for one in findings if one.row[f"verdict_{rod}"]]
        decided = [one for one in judged if one.row[f"verdict_{rod}"] != "undecided"]
        if not judged:
            continue
        chosen = (decided or judged)[0]
        others = [
            f"{one.where}: {_ratio(one.row, rod)}, {one.row[f'verdict_{rod}']}{one.told(rod)}"
            for one in judged
            if one is not chosen
        ]
        why = f" ({chosen.row['why']})" if chosen not in decided and chosen.row["why"] else ""
        lines.append(
            Line(
                wave,
                str(chosen.row[f"verdict_{rod}"]),
                f"{_ratio(chosen.row, rod)} {unit}",
                "; ".join([chosen.where + why + chosen.told(rod), *others]),
                not {"", "undecided", chosen.row[f"verdict_{rod}"]} >= {*chosen.words(rod)},
            )
        )
    return Answer(question, _sentence(lines), lines)


def _ratio(row: pd.Series, rod: str) -> str:
    """Return the ratio to a rod's prediction with its interval, of a group its range."""
    return band(Band.of(*(float(row[f"ratio_to_{rod}{end}"]) for end in ("", "_low", "_high"))))


def _sentence(lines: Sequence[Line]) -> str:
    """Return yes, no or what else the words say, wave by wave."""
    if not lines:
        return "Not known: the constants of the same molecule were not derived."
    said = {"agree": "Yes", "disagree": "No", "undecided": "Undecided"}
    parts = []
    for word, start in said.items():
        waves = [
            f"the lowest {line.wave}" if line.lowest_alone else line.wave
            for line in lines
            if line.word == word
        ]
        if len(waves) == len(lines):
            return f"{start}: {listed(waves)}."
        if waves:
            parts.append(f"{start} for {listed(waves)}.")
    return " ".join(parts)


def _implied(results: Results, found: Mapping[str, Sequence[Finding]]) -> Answer:
    """Return the constants that the waves give: all scenes of a system together, or one wave."""
    joint, lines, ratios = main_system(results).joint, [], []
    for wave, findings in found.items():
        name, quantity, index = CONSTANTS[wave]
        label, _, unit = name.partition(", ")
        paper = Rod.paper().stiffness[index, index] / KJ_PER_MOL_PER_PN_NM
        numbers = [
            (f"{one.where}", number)
            for one in findings
            if one.row["scope"] == ONE
            and (number := implied_constant(results.systems[str(one.row["system"])], one.row))
        ]
        together = joint_constant(joint, quantity)
        if together is not None:
            numbers.insert(0, together)
        if not numbers:
            continue
        (where, first), *others = numbers
        more = [f"{label}, {where}"]
        more += [f"{place}: {band(number)}" for place, number in others]
        lines.append(Line(wave, "", f"{band(first)} {unit}", "; ".join(more)))
        ratios.append(f"{digits(first.value / paper, 2)} ({wave})")
    said = f"The paper's times {listed(ratios)}." if ratios else "Not derived."
    if joint is not None and joint["model_class"].astype(str).str.startswith("rejected").any():
        said = f"No one rod fits all waves. The best has the paper's times {listed(ratios)}."
    return Answer("Which constants would the waves give?", said, lines)


def joint_constant(joint: pd.DataFrame | None, quantity: str) -> tuple[str, Band] | None:
    """Return a constant that all waves of a system give together, after what it rests on."""
    rows = None if joint is None else joint[joint["quantity"] == quantity]
    if rows is None or rows.empty:
        return None
    row = rows.iloc[0]
    scenes = len(str(row["source"]).split(", "))
    basis = f"{counted(scenes, 'scene')} together, misfit {percent(row['misfit'])}"
    return f"{basis}, {row['model_class']}", Band.of(
        *(float(row[name]) for name in ("value", "low", "high"))
    )


def implied_constant(system: SystemResults, row: pd.Series) -> Band | None:
    """Return the constant that a wave's speed implies, density or inertia times its square."""
    if row["wave"] not in AXIAL_WAVES:
        return None
    name = "density_Da_per_A" if row["wave"] == "extension" else "inertia_axial_Da_A"
    inertia = constant(system.constants, "topology", name)
    if inertia is None:
        return None
    speed = speed_of(row)
    # Da Å/ps² is 0.1 Da nm/ps², of a torsion 0.001 Da nm³/ps²; 1 kJ/mol is 1 Da nm²/ps².
    factor = (0.1 if row["wave"] == "extension" else 1e-3) / KJ_PER_MOL_PER_PN_NM
    return Band(
        *(factor * inertia.value * part**2 for part in (speed.value, speed.low, speed.high))
    )
