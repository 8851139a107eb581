"""What the theory says of one rod, as tables: constants, speeds, finite duplex, dispersion."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from dnawaves.rod.chain import FiniteChain
from dnawaves.rod.finite_rod import End
from dnawaves.rod.half_waves import Wave, half_wave_table
from dnawaves.rod.plane_waves import MOTIONS
from dnawaves.rod.rod import Rod, long_wave_speeds_A_per_ps, short_wave_speeds_A_per_ps
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS, KJ_PER_MOL_PER_PN_NM

KINETIC = {
    "along": MOTIONS["extension"],
    "across": MOTIONS["shear"],
    "about": MOTIONS["twist"],
    "tilt": MOTIONS["bend"],
}
STANDING: tuple[Wave, ...] = ("extension", "twist", "bend")


class Duplex(NamedTuple):
    """A finite duplex: number of base pairs and how its two ends are held."""

    pairs: int
    ends: tuple[End, End]


def constants_table(rod: Rod) -> pd.DataFrame:
    """Return the rod's constants in the units of the literature, one row each."""
    stiffness, inertia = np.diag(rod.stiffness) / KJ_PER_MOL_PER_PN_NM, np.diag(rod.inertia_Da_nm)
    turn = np.degrees(np.linalg.norm(rod.omega0_rad_per_nm)) * rod.spacing_nm
    rows = [
        ("density", rod.density_Da_per_nm, "Da/nm"),
        *((f"inertia {axis}", inertia[axis - 1], "Da nm") for axis in (1, 2, 3)),
        *(
            (f"shear stiffness {axis}", stiffness[axis - 1], "pN")
            for axis in (1, 2)
        ),
        ("extension stiffness", stiffness[2], "pN"),
        *((f"bend stiffness {i}", stiffness[i + 2], "pN nm^2") for i in (1, 2)),
        ("twist stiffness", stiffness[5], "pN nm^2"),
        ("spacing", rod.spacing_nm * A_PER_NM, "A"),
        ("intrinsic turn per base pair", turn, "degrees"),
    ]
    return pd.DataFrame(rows, columns=["constant", "value", "unit"])


def speeds_table(rod: Rod) -> pd.DataFrame:
    """Return the speeds of each wave: much shorter and much longer than the helix's pitch.

    Long bends and shears have no speed: bends disperse, shears have a cut-off.
    """
    short, long = short_wave_speeds_A_per_ps(rod), long_wave_speeds_A_per_ps(rod)
    return pd.DataFrame(
        {
            "wave": list(short),
            "short_wave_A_per_ps": list(short.values()),
            "long_wave_A_per_ps": [long.get(wave, np.nan) for wave in short],
        }
    )


def travel_table(rod: Rod, pairs: int) -> pd.DataFrame:
    """Return when long waves of extension and twist reach the other end of a duplex."""
    length_A = (pairs - 1) * rod.spacing_nm * A_PER_NM
    speeds = long_wave_speeds_A_per_ps(rod)
    return pd.DataFrame(
        {
            "wave": list(speeds),
            "length_A": length_A,
            "travel_ps": [length_A / speed for speed in speeds.values()],
        }
    )


def standing_table(rod: Rod, duplex: Duplex, count: int) -> pd.DataFrame:
    """Return the standing waves of the continuous rod beside the rule L = n lambda/2.

    Of the rod averaged about its axis (`Rod.averaged_about_axis`), without the coupling of
    extension and twist; the length is that between the first and the last base pair.
    """
    straight = _uncoupled(rod)
    length_nm = (duplex.pairs - 1) * rod.spacing_nm
    waves = [
        one
        for wave in STANDING
        for one in half_wave_table(straight, length_nm, wave, duplex.ends, count)
    ]
    return pd.DataFrame(
        {
            "wave": [one.wave for one in waves],
            "mode": [one.mode for one in waves],
            "frequency_GHz": [one.frequency_rad_per_ps * GHZ_PER_RAD_PER_PS for one in waves],
            "rule_GHz": [one.rule_rad_per_ps * GHZ_PER_RAD_PER_PS for one in waves],
            "ratio": [one.ratio for one in waves],
        }
    )


def modes_table(rod: Rod, duplex: Duplex, count: int) -> pd.DataFrame:
    """Return the lowest vibrations of the coupled lattice of base pairs, with all couplings.

    The other columns are shares of the kinetic energy: of motion along and across the axis, and
    of rotation about it (twist) and about the other two (tilt).
    """
    fixed = {"held": list[int](), "pinned": list[int]()}
    for pair, end in zip((0, -1), duplex.ends, strict=True):
        if end != "free":
            fixed[end].append(pair)
    chain = FiniteChain(rod, duplex.pairs, fixed["held"], pinned=fixed["pinned"])
    frequencies, shapes = chain.modes()
    vibrations = np.flatnonzero(frequencies > 0)[:count]
    momentum = rod.spacing_nm * shapes[vibrations] @ rod.mass
    energy = np.sum(shapes[vibrations] * momentum, axis=1)
    return pd.DataFrame(
        {
            "mode": np.arange(1, len(vibrations) + 1),
            "frequency_GHz": frequencies[vibrations] * GHZ_PER_RAD_PER_PS,
            **{name: energy[:, axes].sum(axis=1) for name, axes in KINETIC.items()},
        }
    )


def dispersion_table(dataset: xr.Dataset) -> pd.DataFrame:
    """Return the dispersion relation of `dispersion_dataset`, one row per wavenumber and branch.

    The shares are those of the elastic energy, which tell bend from shear.
    """
    shares = dataset["strain_share"].to_dataset("motion")
    flat = dataset[["angular_frequency", "phase_velocity", "group_velocity"]].merge(shares)
    table = flat.to_dataframe().reset_index()
    names = {
        "wavenumber": "wavenumber_rad_per_A",
        "angular_frequency": "angular_frequency_rad_per_ps",
        "phase_velocity": "phase_velocity_A_per_ps",
        "group_velocity": "group_velocity_A_per_ps",
        **{wave: f"{wave}_energy_share" for wave in MOTIONS},
    }
    return table.rename(columns=names)[
        ["wavenumber_rad_per_A", "branch", *list(names.values())[1:]]
    ]


def _uncoupled(rod: Rod) -> Rod:
    straight = rod.averaged_about_axis()
    return replace(straight, stiffness=np.diag(np.diag(straight.stiffness)))
