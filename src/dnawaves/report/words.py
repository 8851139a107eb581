"""Sentences: what a scene is, and what was found."""

from __future__ import annotations

from dnawaves.report.numbers import counted, listed
from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.models import SceneSpec

AXIS = {
    "extension": "along the axis",
    "twist": "about the axis",
    "bend": "about a transverse axis",
    "shear": "across the axis",
}


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
    if scene.system.thermal:
        return (
            f"No excitation: thermal equilibrium at {scene.system.environment.temperature_K:g} K, "
            f"{counted(len(scene.members), 'run')} from other snapshots."
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
