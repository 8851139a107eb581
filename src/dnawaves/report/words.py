"""Sentences: what a scene is, and what was found."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from dnawaves.comparison.steps import agreement, lowest_first
from dnawaves.report.numbers import between, counted, digits, listed
from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.models import SceneSpec
from dnawaves.waves.record import AXIAL_WAVES

AXIS = {
    "extension": "along the axis",
    "twist": "about the axis",
    "bend": "about a transverse axis",
    "shear": "across the axis",
}


# Which estimate speaks for a wave, the first that there is, and in which words.
HOW = {
    "standing wave": "by the lowest standing wave",
    "resonance": "by the resonance of driven scenes",
    "static, no load": "by the stiffness under a vanishing load",
    "waveform": "by the fit to the whole record of a kick",
    "arrival": "by the arrival of a front",
}


@dataclass(frozen=True)
class Headline:
    """What one wave does in one system, in words; `number` is a speed or a frequency."""

    wave: str
    system: str
    number: str
    ratio: str
    sentence: str
    agreement: list[str]


def headlines(table: pd.DataFrame) -> list[Headline]:
    """Return one headline for each wave and system in which a speed was found."""
    found = []
    for (system, wave), rows in table.groupby(["system", "wave"], sort=False):
        known = rows[rows["speed_A_per_ps"].notna()]
        for estimator in HOW:
            chosen = lowest_first(known[known["estimator"] == estimator])
            if len(chosen):
                axial = wave in AXIAL_WAVES
                words = _headline if axial or estimator != "standing wave" else _dispersive
                # Where the speed depends on the wavelength, different ones need not agree.
                sentences = agreement(rows, str(wave)) if axial else []
                found.append(words(str(wave), str(system), chosen.iloc[0], sentences))
                break
    order = list(AXIS)
    return sorted(found, key=lambda headline: order.index(headline.wave))


def _headline(wave: str, system: str, row: pd.Series, sentences: list[str]) -> Headline:
    interval = between(row["low_A_per_ps"], row["high_A_per_ps"])
    spread = (
        f" ({interval} over {counted(row['variations'], 'fit')})"
        if pd.notna(row["low_A_per_ps"])
        else ""
    )
    speed, ratio = f"{digits(row['speed_A_per_ps'])} Å/ps", digits(row["ratio_to_paper"], 2)
    sentence = (
        f"{wave.capitalize()} in this environment: {speed}{spread}, {HOW[row['estimator']]} "
        f"({row['scene']}), {ratio} times the paper's {digits(row['paper_A_per_ps'])}."
    )
    return Headline(wave, system, speed, ratio, sentence, sentences)


def _dispersive(wave: str, system: str, row: pd.Series, sentences: list[str]) -> Headline:
    number, ratio = f"{digits(row['frequency_GHz'])} GHz", digits(row["ratio_to_paper"], 2)
    sentence = (
        f"{wave.capitalize()} in this environment: its lowest standing wave here ({row['scene']}) "
        f"oscillates at {number}, the paper's rod in the same shape at "
        f"{digits(row['paper_frequency_GHz'])} GHz. Its speed depends on the wavelength: see the "
        "dispersion."
    )
    return Headline(wave, system, number, ratio, sentence, sentences)


def scene_sentence(scene: SceneSpec) -> str:
    """Return what a scene is, from its specification."""
    duplex = scene.system.duplex
    return (
        f"{_excitation(scene)} On {duplex.name}, {len(duplex.sequence)} base pairs, in the "
        f"environment '{scene.system.environment_name}'; {_ends(scene)}."
    )


def _ends(scene: SceneSpec) -> str:
    first, last, pairs = scene.ends.first, scene.ends.last, scene.ends.pairs
    held = f" ({pairs} base pairs at each held end)" if pairs > 1 else ""
    if first == last:
        return f"both ends {first}{held}"
    return f"first end {first}, last end {last}{held}"


def _excitation(scene: SceneSpec) -> str:
    what = scene.excitation
    if isinstance(what, Kick):
        end = "held" if scene.ends.first == "held" else "free"
        return (
            f"A kick of {what.wave}, {_velocity(what)} {AXIS[what.wave]}, on the {what.pairs} base "
            f"pairs next to the {end} first end{_scales(what.scales)}."
        )
    if isinstance(what, StandingWave):
        return (
            f"A kick in the shape of standing wave {what.mode} of {what.wave}, at most "
            f"{_velocity(what)} {AXIS[what.wave]}{_scales(what.scales)}."
        )
    if isinstance(what, Pulse):
        return (
            f"A pulse of {what.wave}, at most {_load(what)} {AXIS[what.wave]}, Gaussian in time, "
            f"on the {what.pairs} base pairs next to the first end."
        )
    if isinstance(what, Periodic):
        return (
            f"A sinusoidal drive of {what.wave}, {_load(what)} {AXIS[what.wave]}, on the "
            f"{what.pairs} base pairs next to the first end, at {len(scene.members)} frequencies."
        )
    if isinstance(what, Static):
        return (
            f"A static load of {what.wave}, {_load(what)} {AXIS[what.wave]} on the last base pair, "
            f"relaxed{_scales(what.scales)}."
        )
    return "No excitation: the null that shows what the estimators make of no wave."


def _velocity(what: Kick | StandingWave) -> str:
    return f"{what.amplitude:g} {'Å/ps' if what.velocity_A_per_ps is not None else 'rad/ps'}"


def _load(what: Pulse | Periodic | Static) -> str:
    return f"{what.amplitude:g} {'pN' if what.force_pN is not None else 'pN nm'}"


def _scales(scales: tuple[float, ...]) -> str:
    if len(scales) == 1:
        return ", with both signs"
    return f"; at {listed([f'{scale:g}' for scale in scales])} times this, with both signs"
