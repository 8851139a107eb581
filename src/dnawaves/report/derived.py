"""What follows from speeds and frictions: attenuation, diffusion, coupling of the waves."""

from __future__ import annotations

import numpy as np
import pandas as pd

from dnawaves.comparison.predictions import constant, spacing_A
from dnawaves.report.answers import lead
from dnawaves.report.gather import Results, SystemResults
from dnawaves.report.numbers import digits
from dnawaves.report.own_lattice import own_rod
from dnawaves.report.style import INK, WAVE_COLOURS, Illustration, blank_figure, error_bars
from dnawaves.rod.dispersion import bend_shear_branches
from dnawaves.rod.rod import Rod
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS
from dnawaves.waves.derived import (
    attenuation_length_A,
    crossover,
    driven_attenuation_length_A,
)
from dnawaves.waves.record import AXIAL_WAVES

# Frequencies of the curves, GHz: from far below the crossover to the lattice's edge.
LOWEST_GHZ, POINTS = 2.0, 200


def damped(table: pd.DataFrame) -> pd.DataFrame:
    """Return the waves of which a fit found the friction."""
    return table[
        (table["friction_per_ps"] > 0)
        & table["frequency_GHz"].notna()
        & table["speed_A_per_ps"].notna()
    ]


def attenuation(results: Results, system: SystemResults) -> tuple[Illustration | None, str]:
    """Return how far each wave runs before its amplitude has fallen by e, and what that says."""
    rows = damped(results.single(system.spec.name))
    lengths = {index: _length_A(system, row) for index, row in rows.iterrows()}
    rows = rows.assign(length_A=pd.Series(lengths, dtype=float)).dropna(subset=["length_A"])
    if rows.empty:
        return None, "Attenuation: no fit found a friction; standing waves would."
    figure = blank_figure("frequency (GHz)", "attenuation length (Å)")
    for wave, group in rows.groupby("wave", sort=False):
        figure.add_scatter(
            x=group["frequency_GHz"],
            y=group["length_A"],
            mode="markers",
            marker={"color": WAVE_COLOURS[str(wave)], "size": 10},
            name=str(wave),
            text=group["scene"] + ", " + group["estimator"],
            hovertemplate="%{text}: %{y:.0f} Å at %{x:.0f} GHz<extra></extra>",
        )
    figure.update_layout(yaxis={"type": "log", "dtick": "D2"}, xaxis_rangemode="tozero")
    said = []
    for wave, group in rows.groupby("wave", sort=False):
        ends = group["length_A"].min(), group["length_A"].max()
        of_pairs = (length / spacing_A(system.constants) for length in ends)
        said.append(f"{wave} {_from_to(*ends)} Å ({_from_to(*of_pairs)} bp)")
    line = (
        f"Attenuation lengths, twice the group velocity over the friction: {'; '.join(said)}. At "
        "T = 0 and without solvent this friction is the energy that a wave loses to other motions."
    )
    return Illustration("Attenuation length of each wave", figure, line), line


def _from_to(low: float, high: float) -> str:
    first, last = digits(low, 2), digits(high, 2)
    return first if first == last else f"{first} to {last}"


def _length_A(system: SystemResults, row: pd.Series) -> float:
    speed = float(row["speed_A_per_ps"])
    if row["wave"] not in AXIAL_WAVES:
        own = own_rod(system.constants)
        if own is None or pd.isna(row["wavenumber_rad_per_A"]):
            return float("nan")
        speed = _group_velocity_A_per_ps(own[0], row["wave"], float(row["wavenumber_rad_per_A"]))
    return attenuation_length_A(speed, float(row["friction_per_ps"]))


def _group_velocity_A_per_ps(rod: Rod, wave: str, wavenumber_per_A: float) -> float:
    k = A_PER_NM * wavenumber_per_A * np.array([0.99, 1.01])
    branch = bend_shear_branches(rod, k, lattice=True)[:, 0 if wave == "bend" else 1]
    return float(A_PER_NM * abs(np.diff(branch)[0] / np.diff(k)[0]))


def diffusion(results: Results, system: SystemResults) -> tuple[Illustration | None, str]:
    """Return where propagation turns into diffusion, of extension and of twist."""
    table = results.single(system.spec.name)
    spacing = spacing_A(system.constants)
    figure = blank_figure("frequency of the drive (GHz)", "attenuation length (Å)")
    said = []
    for wave in AXIAL_WAVES:
        row = lead(damped(table[table["wave"] == wave]))
        if row is None:
            continue
        speed, friction = float(row["speed_A_per_ps"]), float(row["friction_per_ps"])
        edge = 2 * speed / spacing * GHZ_PER_RAD_PER_PS
        frequencies = np.geomspace(LOWEST_GHZ, 0.99 * edge, POINTS)
        lengths = driven_attenuation_length_A(
            frequencies / GHZ_PER_RAD_PER_PS, speed, friction, spacing / A_PER_NM
        )
        turn = crossover(speed, friction, spacing / A_PER_NM)
        at_GHz = turn.frequency_rad_per_ps * GHZ_PER_RAD_PER_PS
        colour = WAVE_COLOURS[wave]
        figure.add_scatter(
            x=frequencies, y=lengths, mode="lines", line={"color": colour}, name=wave
        )
        figure.add_scatter(
            x=[at_GHz, at_GHz],
            y=[lengths.min(), lengths.max()],
            mode="lines",
            line={"color": colour, "dash": "dot", "width": 1.5},
            name=f"{wave}, {digits(at_GHz, 2)} GHz",
            hoverinfo="name",
        )
        said.append(
            f"{wave} at {digits(at_GHz, 2)} GHz, a wavelength of "
            f"{digits(turn.wavelength_A / A_PER_NM, 2)} nm, with "
            f"{digits(turn.diffusion_A2_per_ps, 2)} Å²/ps"
        )
    if not said:
        return None, "Diffusion: no fit found a friction; standing waves would."
    line = (
        f"Propagation turns into diffusion: {'; '.join(said)}. Slower and longer waves only relax. "
        "From speed and friction of the lowest wave, as if its friction were that of all."
    )
    figure.update_layout(xaxis_type="log", yaxis={"type": "log", "dtick": "D2"})
    return Illustration("Where waves turn into diffusion", figure, line), line


def coupling(system: SystemResults) -> tuple[Illustration | None, str]:
    """Return how extension and twist are coupled, by the length of the segments."""
    constants = system.constants
    rows = []
    for route in constants["route"].unique():
        kind, _, rest = str(route).partition(", segments of ")
        found = [
            constant(constants, str(route), name)
            for name in (
                "twist_stretch_coupling_pN_nm",
                "stretch_modulus_pN",
                "twist_rigidity_pN_nm2",
            )
        ]
        if rest and all(one is not None for one in found):
            own, stretch, twist = (one for one in found if one is not None)
            scale = float(np.sqrt(stretch.value * twist.value))
            parts = [part / scale for part in (own.value, own.low, own.high)]
            rows.append((kind, int(rest.split()[0]), *parts))
    if not rows:
        return None, "Coupling: the constants of no segments were derived."
    table = pd.DataFrame(rows, columns=["kind", "steps", "value", "low", "high"])
    figure = blank_figure("length of the segment (steps)", "coupling over √(S C)")
    for name, group in table.groupby("kind", sort=False):
        figure.add_scatter(
            x=group["steps"],
            y=group["value"],
            error_y=error_bars(group["value"], group["low"], group["high"], 1),
            mode="markers",
            marker={"color": INK if name == "hessian" else WAVE_COLOURS["bend"], "size": 7},
            name=str(name),
        )
    figure.add_hline(y=0, line={"color": INK, "width": 1})
    last = table.iloc[-1]
    sense = "overwinds" if last["value"] < 0 else "unwinds"
    if last["low"] < 0 < last["high"]:
        sense = f"{sense}, which the interval does not settle"
    over = "range over the segments" if last["kind"] == "hessian" else "95 %"
    between = f"{digits(last['low'], 2)} to {digits(last['high'], 2)}, {over}"
    line = (
        f"Coupling of extension and twist over {last['steps']} steps, of the largest that a stable "
        f"rod may have, √(stretch modulus × twist rigidity): {digits(last['value'], 2)} "
        f"({between}): pulled, the duplex {sense}."
    )
    return Illustration("Coupling of extension and twist", figure, line), line
