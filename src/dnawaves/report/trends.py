"""How the speed depends on sequence and temperature, and whether a lag measures a distance."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import pandas as pd
from scipy import stats

from dnawaves.comparison.predictions import constant
from dnawaves.report.answers import lead
from dnawaves.report.gather import Results, SceneResults, SystemResults
from dnawaves.report.numbers import counted, digits
from dnawaves.report.style import INK, PAPER_LINE, WAVE_COLOURS, Illustration, blank_figure
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.excitations import Kick
from dnawaves.scene.pairs import excited_pairs, held_pairs
from dnawaves.waves.derived import Group, Measured, by_kind, front_lags, lag_ruler, trend
from dnawaves.waves.estimators.intervals import LEVEL
from dnawaves.waves.record import AXIAL_WAVES

# Of a normal distribution's 95 % interval, half its width over the standard deviation.
NORMAL = float(stats.norm.ppf((1 + LEVEL) / 2))
# Of the range of distances. A guess of the middle, without any lag, is wrong by 1/√12 = 0.29 of it.
TELLS_DISTANCE = 0.25


def by_sequence(results: Results) -> tuple[Illustration | None, str]:
    """Return the speed that the stiffness of single steps is worth, by their two bases."""
    known = [
        (kind, *speeds)
        for system in results.systems.values()
        for kind, *speeds in _kinds(system.constants)
    ]
    if not known:
        return None, "Sequence: the stiffness of single steps was not derived."
    table = pd.DataFrame(known, columns=["kind", *AXIAL_WAVES])
    figure = blank_figure("", "speed that the step is worth (Å/ps)")
    said = []
    for wave in AXIAL_WAVES:
        groups = by_kind(list(table["kind"]), table[wave].to_numpy())
        ranked = sorted(groups.items(), key=lambda item: item[1].mean)
        if wave == "extension":
            order = [kind for kind, _ in ranked]
        figure.add_scatter(
            x=[kind for kind, _ in ranked],
            y=[group.mean for _, group in ranked],
            error_y={
                "type": "data",
                "array": [_reach(group) for _, group in ranked],
                "thickness": 1.5,
            },
            mode="markers",
            marker={"color": WAVE_COLOURS[wave], "size": 9},
            name=wave,
            text=[counted(group.number, "structure") for _, group in ranked],
            hovertemplate="%{x}: %{y:.1f} Å/ps, %{text}<extra></extra>",
        )
        (soft, low), (stiff, high) = ranked[0], ranked[-1]
        said.append(
            f"{wave} from {digits(low.mean)} ({soft}) to {digits(high.mean)} Å/ps ({stiff})"
        )
    figure.update_layout(xaxis={"categoryorder": "array", "categoryarray": order})
    line = (
        "By sequence, what the stiffness of single steps is worth, read along either strand: "
        f"{'; '.join(said)}. Bars: 95 % of the mean over the structures, of the mean step in each."
    )
    return Illustration("Speed by the two bases of a step", figure, line), line


def _reach(group: Group) -> float:
    """Return half of the mean's 95 % interval, Student's t; 0 of one structure, which has none."""
    if group.number < 2:
        return 0.0
    return float(stats.t.ppf((1 + LEVEL) / 2, group.number - 1)) * group.sd


def _kinds(constants: pd.DataFrame) -> Iterator[tuple[str, float, float]]:
    """Yield each kind of step with the speeds of extension and of twist."""
    for route in map(str, constants["route"].unique()):
        found = re.fullmatch(r"(hessian|thermal), steps ([ACGT]{2})", route)
        speeds = [constant(constants, route, f"speed_{wave}_A_per_ps") for wave in AXIAL_WAVES]
        if found and speeds[0] and speeds[1]:
            yield found[2], speeds[0].value, speeds[1].value


def by_temperature(results: Results) -> tuple[Illustration | None, str]:
    """Return the speeds by temperature, of duplexes that were run at two and more."""
    figure = blank_figure("temperature (K)", "speed (Å/ps)")
    said = []
    for wave in AXIAL_WAVES:
        points: list[tuple[float, Measured]] = []
        for name, system in _at_temperatures(results).items():
            single = results.single(name)
            row = lead(single[single["wave"] == wave])
            if row is not None and pd.notna(row["low_A_per_ps"]):
                half = float(row["high_A_per_ps"] - row["low_A_per_ps"]) / 2 / NORMAL
                speed = Measured(float(row["speed_A_per_ps"]), half)
                points.append((float(system.spec.environment.temperature_K), speed))
        points = [(kelvin, speed) for kelvin, speed in points if 0 < speed.sd < np.inf]
        if len({kelvin for kelvin, _ in points}) < 2:
            continue
        found = trend([kelvin for kelvin, _ in points], [speed for _, speed in points])
        figure.add_scatter(
            x=[kelvin for kelvin, _ in points],
            y=[speed.value for _, speed in points],
            error_y={"type": "data", "array": [NORMAL * speed.sd for _, speed in points]},
            mode="markers",
            marker={"color": WAVE_COLOURS[wave], "size": 9},
            name=wave,
        )
        ends = [digits(100 * value, 2) for value in (found.slope, found.low, found.high)]
        said.append(f"{wave} {ends[0]} ({ends[1]} to {ends[2]}) Å/ps per 100 K")
    if not said:
        return None, (
            "Temperature: no duplex has speeds at two temperatures. Add an environment with "
            "temperature_K: 300 and a scene of kind none in it."
        )
    line = f"By temperature: {'; '.join(said)}; each point is one system, in its own environment."
    return Illustration("Speed by temperature", figure, line), line


def _at_temperatures(results: Results) -> dict[str, SystemResults]:
    """Return the systems of duplexes at two temperatures and more: lengths differ in speed too."""
    kelvins: dict[str, set[float]] = {}
    for system in results.systems.values():
        known = kelvins.setdefault(system.spec.duplex.sequence, set())
        known.add(float(system.spec.environment.temperature_K))
    return {
        name: system
        for name, system in results.systems.items()
        if len(kelvins[system.spec.duplex.sequence]) > 1
    }


def lag_distance(results: Results) -> tuple[Illustration | None, str]:
    """Return whether the lag between extension and twist tells how far two points are apart."""
    scenes = _kicks(results)
    if scenes is None:
        return None, (
            "Lag: there is no kick of extension and one of twist with the same ends and base pairs."
        )
    extension, twist = scenes
    fields = [_field(scene) for scene in scenes]
    excited = excited_pairs(extension.spec.excitation, extension.spec.ends)  # type: ignore[arg-type]
    held = held_pairs(extension.spec.ends, extension.pairs)
    # Beside a held pair the reflection meets the front.
    free = [p for p in range(excited[-1] + 1, extension.pairs) if not {p, p + 1} & set(held)]
    found = front_lags(fields[0], fields[1], free)
    height = extension.waves["height"].values
    start = height[excited].mean()
    if len(found) < 3:
        return None, "Lag: the fronts of extension and twist pass fewer than three base pairs both."
    distances = np.array([height[pair] - start for pair in found])
    lags = np.array([late.value - early.value for early, late in found.values()])
    blur = np.array([np.hypot(early.sd, late.sd) for early, late in found.values()])
    ruler = lag_ruler(distances, lags)
    figure = blank_figure("lag of twist behind extension (ps)", "distance (Å)")
    figure.add_scatter(
        x=lags,
        y=distances,
        error_x={"type": "data", "array": blur, "thickness": 1},
        mode="markers",
        marker={"color": INK, "size": 7},
        name="base pairs",
    )
    ends = np.array([lags.min(), lags.max()])
    best = {"color": WAVE_COLOURS["bend"], "width": 2}
    figure.add_scatter(
        x=ends, y=[ruler.distance_A(lag) for lag in ends], mode="lines", line=best, name="best line"
    )
    paper = short_wave_speeds_A_per_ps(Rod.paper())
    slope = 1 / (1 / paper["twist"] - 1 / paper["extension"])
    figure.add_scatter(
        x=[0, ends[1]], y=[0, slope * ends[1]], mode="lines", line=PAPER_LINE, name="paper's rod"
    )
    spacing = extension.spacing_A
    verdict = "a distance" if ruler.error_A < TELLS_DISTANCE * np.ptp(distances) else "no distance"
    line = (
        f"The lag between the fronts of extension and twist measures {verdict} here: read off the "
        f"best line of {len(found)} base pairs it is wrong by ± {digits(ruler.error_A, 2)} Å "
        f"({digits(ruler.error_A / spacing, 2)} bp), one standard error, over "
        f"{digits(np.ptp(distances), 2)} Å. Slope {digits(ruler.A_per_ps, 2)} Å/ps, "
        f"of the paper's rod {digits(slope, 2)}. Scenes {extension.spec.name} and "
        f"{twist.spec.name}; bars are half the difference of two picks."
    )
    return Illustration("Does the lag measure the distance?", figure, line), line


def _kicks(results: Results) -> tuple[SceneResults, SceneResults] | None:
    """Return the first kicks of extension and of twist that differ in nothing else."""
    kicks = [
        scene
        for scene in results.scenes.values()
        if isinstance(scene.spec.excitation, Kick) and scene.spec.excitation.wave in AXIAL_WAVES
    ]
    for extension in kicks:
        for twist in kicks:
            waves = [one.spec.excitation.wave for one in (extension, twist)]  # type: ignore[union-attr]
            if waves == list(AXIAL_WAVES) and _alike(extension) == _alike(twist):
                return extension, twist
    return None


def _alike(scene: SceneResults) -> tuple[object, ...]:
    spec = scene.spec
    return spec.system, spec.ends, spec.method, spec.excitation.pairs  # type: ignore[union-attr]


def _field(scene: SceneResults) -> tuple[np.ndarray, np.ndarray]:
    usable = int(scene.waves.attrs["usable_frames"])
    field = scene.waves[f"{scene.spec.excitation.wave}_velocity"].transpose("time", "pair")  # type: ignore[union-attr]
    return scene.waves["time"].values[:usable], field.values[:usable]
