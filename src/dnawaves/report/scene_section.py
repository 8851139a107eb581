"""One scene's part of the report: the figures that its kind of excitation calls for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from dnawaves.report.dispersion import branch_GHz, paper_branches_GHz
from dnawaves.report.gather import SceneResults
from dnawaves.report.helical_odd import helical_figure, parameter_of
from dnawaves.report.kymograph import Front, Marks, Moment, kymograph, saturation
from dnawaves.report.load_profile import load_figure
from dnawaves.report.numbers import digits, percent
from dnawaves.report.own_lattice import lattice_velocity, own_rod
from dnawaves.report.resonance import resonance_figure
from dnawaves.report.spectrum import spectrum_figure
from dnawaves.report.standing_wave import projection_figure
from dnawaves.report.style import MEASURED_LINE, PAPER_LINE, Illustration
from dnawaves.report.thermal import thermal_illustrations
from dnawaves.report.words import scene_sentence
from dnawaves.rod.rod import Rod
from dnawaves.scene.excitations import Kick, Nothing, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.pairs import excited_pairs
from dnawaves.units import A_PER_NM
from dnawaves.waves.record import AXIAL_WAVES


@dataclass(frozen=True)
class SceneSection:
    """A scene's heading, sentences and figures."""

    name: str
    kind: str
    sentence: str
    findings: list[str]
    illustrations: list[Illustration]


def scene_section(
    scene: SceneResults, constants: pd.DataFrame | None = None, like: str = ""
) -> SceneSection:
    """Return the part of the report that is about one scene.

    `constants` are those of the rod of its system. `like` names the scene of which this is a
    repetition in another system: its maps are not shown once more.
    """
    excitation = scene.spec.excitation
    wave = getattr(excitation, "wave", None)
    kind = excitation.kind.replace("_", " ")
    return SceneSection(
        scene.spec.name,
        f"{kind}, {wave}" if wave else _without_wave(scene),
        scene_sentence(scene.spec) + (f" The same as {like} otherwise." if like else ""),
        [_finding(row) for _, row in scene.rows.iterrows()],
        _projection(scene) if like else _illustrations(scene, constants),
    )


def _without_wave(scene: SceneResults) -> str:
    kelvin = scene.spec.system.environment.temperature_K
    return f"thermal equilibrium, {kelvin:g} K" if scene.spec.system.thermal else "null"


def _finding(row: pd.Series) -> str:
    if pd.isna(row["speed_A_per_ps"]):
        return f"{row['wave'].capitalize()}: {row['reason'] or row['verdict']}."
    details = [f"misfit {percent(row['misfit'])}"] if pd.notna(row["misfit"]) else []
    details += [row["reason"]] if row["reason"] else []
    return (
        f"{row['estimator'].capitalize()}: {digits(row['speed_A_per_ps'])} Å/ps, "
        f"{row['verdict']}{' (' + '; '.join(details) + ')' if details else ''}."
    )


def _illustrations(scene: SceneResults, constants: pd.DataFrame | None) -> list[Illustration]:
    excitation = scene.spec.excitation
    if isinstance(excitation, Nothing):
        return thermal_illustrations(scene, constants) if scene.spec.system.thermal else []
    if isinstance(excitation, Static):
        return _load(scene, excitation)
    wave = excitation.wave
    shown = _kymographs(scene, wave, _marks(scene, excitation), constants)
    if isinstance(excitation, StandingWave):
        shown += _projection(scene)
    if isinstance(excitation, Periodic):
        shown += _resonance(scene, excitation)
    shown += _spectrum(scene, wave)
    if scene.odd_helical is not None:
        name = parameter_of(scene.odd_helical, wave)
        shown.append(
            Illustration(
                f"{name.capitalize()} of each step",
                helical_figure(scene.odd_helical, name),
                f"Half the difference of {name} between the two signs of the first run, from the "
                "base frames: the same wave through the helical parameters.",
            )
        )
    return shown


def _marks(scene: SceneResults, excitation: Kick | Pulse | StandingWave | Periodic) -> Marks:
    time = scene.waves["time"].values
    usable = int(scene.waves.attrs["usable_frames"])
    window = float(time[max(usable - 1, 0)]) if usable < len(time) else None
    known = scene.rows[scene.rows["speed_A_per_ps"].notna()]
    if isinstance(excitation, StandingWave):
        moments = [
            Moment(f"a quarter period, {name}", 250.0 / float(row[column]), line)
            for _, row in known.iterrows()
            for name, column, line in (
                ("paper", "paper_frequency_GHz", "paper"),
                ("fit", "frequency_GHz", "measured"),
            )
        ]
        return Marks(moments=moments, window_ps=window)
    height = scene.waves["height"].values
    source = height[excited_pairs(excitation, scene.spec.ends)].mean() - height[0]
    paper = float(scene.rows["paper_A_per_ps"].iloc[0])
    fronts = [Front(f"paper, {digits(paper)} Å/ps", paper, "paper")]
    for line, (_, row) in zip(("measured", "measured otherwise"), known.iterrows(), strict=False):
        speed = float(row["speed_A_per_ps"])
        fronts.append(Front(f"{row['estimator']}, {digits(speed)} Å/ps", speed, line))
    return Marks(fronts=fronts, source_A=float(source), window_ps=window)


def _made_by(scene: SceneResults) -> str:
    return "Exact linear answer" if scene.spec.method == "harmonic" else "Simulation"


def _kymographs(
    scene: SceneResults, wave: str, marks: Marks, constants: pd.DataFrame | None
) -> list[Illustration]:
    field = scene.waves[f"{wave}_velocity"]
    units = str(field.attrs["units"])
    theory = scene.waves.get(f"{wave}_paper")
    limit = saturation(field) if theory is None else saturation(field, theory)
    if limit == 0:
        return []
    drives = scene.waves.get("drive")
    which = "" if drives is None else f" driven at {digits(drives.values[0])} GHz"
    whole = (
        "The whole record is usable."
        if marks.window_ps is None
        else f"After {digits(marks.window_ps)} ps the difference of the two signs holds more "
        "energy than was put in, and no fit looks at it."
    )
    lines = (
        "The vertical lines mark a quarter of a period, when a standing wave comes to rest."
        if marks.moments
        else "The lines are fronts that start at the source; where the colours begin, the front "
        "has arrived."
    )
    shown = [
        Illustration(
            f"{_made_by(scene)}{which}",
            kymograph(field, units, limit, marks),
            f"Velocity field of {wave}, half the difference of the two signs. {lines} {whole} "
            "The strongest motion is beyond the colours.",
        )
    ]
    if theory is not None:
        own = None if constants is None else own_rod(constants)
        if own is not None:
            shown.append(_own_lattice(scene, wave, marks, limit, *own))
        theirs = [front for front in marks.fronts if front.line == "paper"]
        ours = [moment for moment in marks.moments if moment.line == "paper"]
        shown.append(
            Illustration(
                "The paper's rod",
                kymograph(theory, units, limit, Marks(theirs, ours, marks.source_A)),
                "A chain with the paper's constants and this duplex's spacing and ends after the "
                "same kick, in the same colours.",
            )
        )
    return shown


def _own_lattice(
    scene: SceneResults, wave: str, marks: Marks, limit: float, rod: Rod, route: str
) -> Illustration:
    rod = replace(rod, spacing_nm=scene.spacing_A / A_PER_NM)
    field = lattice_velocity(scene, wave, rod)
    return Illustration(
        "The lattice with its own constants",
        kymograph(
            field, str(field.attrs["units"]), limit, Marks((), (), marks.source_A, marks.window_ps)
        ),
        "A uniform lattice of rigid base pairs with the constants of this very duplex, extension "
        f"and twist coupled, from its {route}; without friction, after the same kick, in the same "
        "colours. Were the rod right, this would be the simulation's picture.",
    )


def _projection(scene: SceneResults) -> list[Illustration]:
    row = scene.row("standing wave")
    if row is None or "projection" not in scene.waves:
        return []
    figure = projection_figure(
        scene.waves["projection"],
        float(row["window_ps"]),
        float(row["frequency_GHz"]),
        float(row["friction_per_ps"]),
        float(row["paper_frequency_GHz"]),
    )
    caption = (
        f"How much of the motion is still in the shape that was kicked. The fit oscillates at "
        f"{digits(row['frequency_GHz'])} GHz with a friction of {digits(row['friction_per_ps'])} "
        f"per ps and misses {percent(row['misfit'])}; the paper's rod would oscillate at "
        f"{digits(row['paper_frequency_GHz'])} GHz."
    )
    return [Illustration("The standing wave in time", figure, caption)]


def _resonance(scene: SceneResults, excitation: Periodic) -> list[Illustration]:
    row = scene.row("resonance")
    if row is None or "response" not in scene.waves:
        return []
    figure = resonance_figure(
        scene.waves["drive"].values,
        scene.waves["response"].values,
        str(scene.waves[f"{excitation.wave}_velocity"].attrs["units"]),
        scene.waves["time"].values,
        (float(row["frequency_GHz"]), float(row["friction_per_ps"])),
        float(row["paper_frequency_GHz"]),
        excitation.ramp_periods,
    )
    caption = (
        f"The largest velocity of the lowest standing wave within the record, for each drive. The "
        f"fitted mode, at {digits(row['frequency_GHz'])} GHz, must pass through the points; the "
        f"paper's, at {digits(row['paper_frequency_GHz'])} GHz and under the same force, would "
        "follow the dashed curve."
    )
    return [Illustration("Resonance", figure, caption)]


def _spectrum(scene: SceneResults, wave: str) -> list[Illustration]:
    power = scene.waves.get(f"{wave}_power")
    if power is None:
        return []
    wavenumber = power["wavenumber"].values
    theory = paper_branches_GHz(wavenumber, scene.spacing_A)
    names = {wave: wave} if wave in AXIAL_WAVES else {"bend": "lower", "shear": "upper"}
    branches: dict[str, tuple[np.ndarray, Mapping[str, object]]] = {
        f"paper, {called} branch": (theory[name], PAPER_LINE) for name, called in names.items()
    }
    known = scene.rows[scene.rows["speed_A_per_ps"].notna()]
    if wave in AXIAL_WAVES and len(known):
        speed = float(known["speed_A_per_ps"].iloc[0])
        fitted = branch_GHz(speed, wavenumber, scene.spacing_A)
        branches[f"rod at {digits(speed)} Å/ps"] = (fitted, MEASURED_LINE)
    top = 1.2 * max(float(frequency.max()) for frequency, _ in branches.values())
    resolution = digits(power.attrs["resolution_GHz"])
    caption = (
        f"How the energy of {wave} is spread over wavenumber and frequency. The record resolves "
        f"{resolution} GHz, so a ridge is at least that wide; look for where it lies, not for "
        "peaks. Finer structure is drawn by zero padding only."
    )
    figure = spectrum_figure(power, branches, top)
    return [
        Illustration(f"Frequency against wavenumber (resolution {resolution} GHz)", figure, caption)
    ]


def _load(scene: SceneResults, excitation: Static) -> list[Illustration]:
    wave = excitation.wave
    load = excitation.amplitude * excitation.scales[0]
    unit = "pN" if wave == "extension" else "pN nm"
    left = scene.rows["estimator"].eq(f"static {scene.spec.members[0]}").any()
    what = (
        "linear response, since the load itself drove the duplex into another minimum"
        if left
        else "half the difference of the two signs"
    )
    caption = (
        f"How far each base pair moves {'along' if wave == 'extension' else 'about'} the axis "
        f"under {load:g} {unit}: {what}. A uniform rod would be a straight line; a "
        "jump is a soft step."
    )
    figure = load_figure(scene.waves[f"{wave}_displacement"].isel(time=0), wave, load)
    return [Illustration("Displacement under the load", figure, caption)]
