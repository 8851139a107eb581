"""Do the routes to one wave's speed agree with each other, and if not, what is known of why?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from dnawaves.comparison.compare import ONE, doubt, sound, speed_of
from dnawaves.comparison.judge import Band, Word, judge

ANSWERS: dict[Word, str] = {
    "agree": "agrees",
    "disagree": "differs",
    "undecided": "decides nothing",
}


@dataclass(frozen=True)
class Route:
    """One estimate beside the yardstick: its word, and the sentence that says so."""

    word: Word
    sentence: str


@dataclass(frozen=True)
class Agreement:
    """How the routes to one wave in one system agree with its lowest standing wave."""

    system: str
    yardstick: str
    routes: list[Route]

    @property
    def sentence(self) -> str:
        """How many agree, differ and decide nothing."""
        words = [route.word for route in self.routes]
        counts = {word: words.count(word) for word in ANSWERS}
        return (
            f"{self.yardstick} Of {len(words)} other estimates {counts['agree']} agree with it "
            f"within both intervals, {counts['disagree']} differ and {counts['undecided']} decide "
            "nothing."
        )


def agreement(
    table: pd.DataFrame, wave: str, segments: pd.DataFrame | None = None
) -> Agreement | None:
    """Return how the estimates of one wave of one system agree; None without a standing wave.

    The lowest simulated standing wave is the yardstick, of those whose fit is sound. Arrivals count
    by their ratio to the paper's rod, which has the same bias. `segments` is the stiffness by
    length, which may be why.
    """
    rows = table[(table["wave"] == wave) & (table["scope"] == ONE)]
    known = rows[rows["speed_A_per_ps"].notna()]
    standing = lowest_first(sound(known[known["estimator"] == "standing wave"]))
    if standing.empty:
        return None
    yardstick = standing.iloc[0]
    said = (
        f"Yardstick: the lowest standing wave ({yardstick['scene']}), "
        f"{yardstick['speed_A_per_ps']:.1f} Å/ps at {yardstick['frequency_GHz']:.0f} GHz."
    )
    others = known[
        (known["scene"] != yardstick["scene"]) & ~known["estimator"].str.contains("held")
    ]
    routes = [_route(row, yardstick, known, segments) for _, row in others.iterrows()]
    return Agreement(str(yardstick["system"]), said, routes)


def lowest_first(rows: pd.DataFrame) -> pd.DataFrame:
    """Return estimates by frequency, those of simulated scenes before the harmonic ones."""
    return rows.assign(exact=rows["method"] != "simulated").sort_values(
        ["exact", "frequency_GHz"], kind="stable"
    )


def _route(
    row: pd.Series, yardstick: pd.Series, known: pd.DataFrame, segments: pd.DataFrame | None
) -> Route:
    ratio = _unbiased(row).over(_unbiased(yardstick))
    unsure = doubt(yardstick)
    judgement = judge(ratio, doubt(row) or (unsure and f"the yardstick: {unsure}"))
    # Adding zero turns a negative one into a positive one.
    percent = f"{round(ratio.value - 1, 2) + 0.0:+.0%}".replace("-", "−")
    why = judgement.why
    if judgement.word == "disagree":
        why = _why(row, known, yardstick, segments)
    sentence = f"{row['scene']}, {row['estimator']}: {percent}, {ANSWERS[judgement.word]}"
    return Route(judgement.word, f"{sentence} ({why})." if why else f"{sentence}.")


def _unbiased(row: pd.Series) -> Band:
    """Return the ratio to the paper's rod, which has the same bias."""
    speed, paper = speed_of(row), float(row["paper_A_per_ps"])
    return Band(speed.value / paper, speed.low / paper, speed.high / paper)


def _why(
    row: pd.Series, known: pd.DataFrame, yardstick: pd.Series, segments: pd.DataFrame | None
) -> str:
    estimator = str(row["estimator"])
    if estimator.startswith("static"):
        return _why_static(row, known, float(yardstick["speed_A_per_ps"]), segments)
    if estimator == "standing wave":
        said = f"{row['frequency_GHz']:.0f} GHz, with a misfit of {row['misfit']:.0%}"
        same = np.isclose(row["wavenumber_rad_per_A"], yardstick["wavenumber_rad_per_A"], rtol=0.01)
        if same:
            return f"the same wavelength, {row['method']}, {said}"
        return f"another wavelength, {said}{_by_length(row, segments)}"
    if estimator in ("arrival", "correlation"):
        return (
            "a front is made of all wavelengths, of which each has a stiffness of its own"
            f"{_by_length(row, segments)}"
        )
    if pd.notna(row["misfit"]):
        return f"its model leaves a misfit of {row['misfit']:.0%}{_by_length(row, segments)}"
    return "no reason found"


def _why_static(
    row: pd.Series, known: pd.DataFrame, yardstick_A_per_ps: float, segments: pd.DataFrame | None
) -> str:
    if row["wave"] == "twist" and row["speed_A_per_ps"] > yardstick_A_per_ps:
        return (
            "the load turns the duplex at fixed length; the length follows a wave of twist by "
            "their coupling, and slows it"
        )
    held = known.loc[known["estimator"] == "static, held across", "speed_A_per_ps"]
    if len(held) and row["speed_A_per_ps"] < yardstick_A_per_ps < held.iloc[0]:
        return (
            "at rest the base pairs follow the load across the axis as well; with that held it "
            f"gives {held.iloc[0]:.1f} Å/ps, and the wave lies between{_by_length(row, segments)}"
        )
    return "no reason found"


def _by_length(row: pd.Series, segments: pd.DataFrame | None) -> str:
    """Return what the duplex's own stiffness is worth by length, as half a sentence."""
    column = f"{row['wave']}_A_per_ps"
    if segments is None or column not in segments:
        return ""
    short, long = segments.iloc[0], segments.iloc[-1]
    return (
        f"; the duplex's own stiffness is worth {short[column]:.1f} Å/ps over "
        f"{short['steps']:.0f} step and {long[column]:.1f} over {long['steps']:.0f}"
    )
