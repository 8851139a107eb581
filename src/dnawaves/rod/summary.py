"""What the theory says of one rod, as tables: constants, speeds, finite duplex, dispersion."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from dnawaves.rod.chain import FiniteChain
from dnawaves.rod.finite_rod import End
from dnawaves.rod.half_waves import Wave, half_wave_table
from dnawaves.rod.limits import STRAINS, long_wave_speeds_A_per_ps, short_waves
from dnawaves.rod.plane_waves import MOTIONS
from dnawaves.rod.rod import (
    AXIAL,
    BEND_1,
    BEND_2,
    EXTENSION,
    SHEAR_1,
    SHEAR_2,
    TWIST,
    Rod,
    axial_stiffness,
)
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS, KJ_PER_MOL_PER_PN_NM

KINETIC = {
    "along": MOTIONS["extension"],
    "across": MOTIONS["shear"],
    "about": MOTIONS["twist"],
    "tilt": MOTIONS["bend"],
}
# of a whole: smaller shares are round-off
NO_SHARE = 1e-12


class Duplex(NamedTuple):
    """A finite duplex: number of base pairs and how its two ends are held."""

    pairs: int
    ends: tuple[End, End]

    @property
    def cells(self) -> float:
        """Length of the continuous rod in base-pair spacings.

        From the first held or pinned pair to the last; a free end reaches half a spacing further,
        because its base pair's mass belongs to a whole cell.
        """
        return self.pairs - 1 + 0.5 * self.ends.count("free")


def constants_table(rod: Rod) -> pd.DataFrame:
    """Return the rod's constants in the units of the literature, one row each.

    Couplings, offsets and the axis of intrinsic rotation have rows where they are not zero.
    """
    matrix = rod.stiffness / KJ_PER_MOL_PER_PN_NM
    units = ["pN", "pN nm", "pN nm^2"]
    blocks = np.add.outer(np.arange(6) // 3, np.arange(6) // 3)
    turn_deg = np.degrees(np.linalg.norm(rod.omega0_rad_per_nm)) * rod.spacing_nm
    always = [
        ("density", rod.density_Da_per_nm, "Da/nm"),
        *((f"inertia {i + 1}", rod.inertia_Da_nm[i, i], "Da nm") for i in range(3)),
        *((f"{name} stiffness", matrix[i, i], units[blocks[i, i]]) for i, name in _strains()),
        ("spacing", rod.spacing_nm * A_PER_NM, "A"),
        ("intrinsic turn per base pair", turn_deg, "degrees"),
    ]
    vectors = (
        ("Gamma0", rod.gamma0, "1"),
        ("Omega0", rod.omega0_rad_per_nm, "rad/nm"),
        ("centre of mass", rod.centre_nm * A_PER_NM, "A"),
    )
    others = [
        *(
            (f"inertia {i + 1}-{j + 1}", rod.inertia_Da_nm[i, j], "Da nm")
            for i, j in combinations(range(3), 2)
        ),
        *(
            (f"coupling {first}-{second}", matrix[i, j], units[blocks[i, j]])
            for (i, first), (j, second) in combinations(_strains(), 2)
        ),
        *((f"{name} {i + 1}", value[i], unit) for name, value, unit in vectors for i in range(3)),
    ]
    rows = always + [row for row in others if row[1] != 0]
    return pd.DataFrame(rows, columns=["constant", "value", "unit"])


def speeds_table(rod: Rod) -> pd.DataFrame:
    """Return the speed of each wave, much shorter and much longer than the helix's pitch.

    Per arc length of the rod. `share` is what the strain of that name has in the elastic energy
    of the short wave. Long bends and shears have no speed: bends disperse, shears have a cut-off.
    """
    short, long = short_waves(rod), long_wave_speeds_A_per_ps(rod)
    return pd.DataFrame(
        {
            "wave": STRAINS,
            "short_wave_A_per_ps": short.speeds_A_per_ps,
            "share": short.shares,
            "long_wave_A_per_ps": [long.get(wave, np.nan) for wave in STRAINS],
        }
    )


def travel_table(rod: Rod, pairs: int) -> pd.DataFrame:
    """Return when long waves of extension and twist reach the other end of a duplex.

    From the first base pair to the last: `length_A` along the axis, `arc_length_A` along the rod.
    """
    arc_A = (pairs - 1) * rod.spacing_nm * A_PER_NM
    speeds = long_wave_speeds_A_per_ps(rod)
    return pd.DataFrame(
        {
            "wave": list(speeds),
            "length_A": arc_A * abs(rod.on_axis().gamma0[2]),
            "arc_length_A": arc_A,
            "travel_ps": [arc_A / speed for speed in speeds.values()],
        }
    )


def standing_table(rod: Rod, duplex: Duplex, count: int) -> pd.DataFrame:
    """Return the standing waves of the continuous rod beside the rule L = n lambda/2.

    Of the rod averaged about its axis (`Rod.averaged_about_axis`) or, without twist, of its two
    planes, each without couplings; `Duplex.cells` is the length.
    """
    length_nm = duplex.cells * rod.spacing_nm
    waves = [
        (name, one)
        for name, (wave, straight) in _straight_waves(rod).items()
        for one in half_wave_table(straight, length_nm, wave, duplex.ends, count)
    ]
    return pd.DataFrame(
        {
            "wave": [name for name, _ in waves],
            "mode": [one.mode for _, one in waves],
            "frequency_GHz": [one.frequency_rad_per_ps * GHZ_PER_RAD_PER_PS for _, one in waves],
            "rule_GHz": [one.rule_rad_per_ps * GHZ_PER_RAD_PER_PS for _, one in waves],
            "ratio": [one.ratio for _, one in waves],
        }
    )


def modes_table(rod: Rod, duplex: Duplex, count: int) -> pd.DataFrame:
    """Return the lowest vibrations of the coupled lattice of base pairs, with all couplings.

    The other columns are shares of the kinetic energy: of motion along and across the axis, and
    of rotation about it (twist) and about the other two (tilt). None where every base pair is held.
    """
    if duplex.pairs == 2 and duplex.ends == ("held", "held"):
        return pd.DataFrame({name: [] for name in ("mode", "frequency_GHz", *KINETIC)})
    fixed = {"held": list[int](), "pinned": list[int]()}
    for pair, end in zip((0, -1), duplex.ends, strict=True):
        if end != "free":
            fixed[end].append(pair)
    chain = FiniteChain(rod, duplex.pairs, fixed["held"], pinned=fixed["pinned"])
    frequencies, shapes = chain.modes()
    vibrations = np.flatnonzero(frequencies > 0)[:count]
    momentum = rod.spacing_nm * shapes[vibrations] @ rod.mass
    energy = np.sum(shapes[vibrations] * momentum, axis=1)
    energy[np.abs(energy) < NO_SHARE] = 0.0
    return pd.DataFrame(
        {
            "mode": np.arange(1, len(vibrations) + 1),
            "frequency_GHz": frequencies[vibrations] * GHZ_PER_RAD_PER_PS,
            **{name: energy[:, axes].sum(axis=1) for name, axes in KINETIC.items()},
        }
    )


def dispersion_table(dataset: xr.Dataset) -> pd.DataFrame:
    """Return the dispersion relation of `dispersion_dataset`, one row per wavenumber and branch.

    Wavenumbers in the frame that turns with the cross-section and, for each circular component of
    the wave with its share of the kinetic energy, in the laboratory. The shares of the motions are
    those of the elastic energy, which tell bend from shear.
    """
    parts = [
        dataset[["angular_frequency", "phase_velocity", "group_velocity"]],
        _columns(dataset["strain_share"], "motion", "{}_elastic_share"),
        _columns(
            dataset["laboratory_wavenumber"], "circular", "laboratory_wavenumber_{}_rad_per_A"
        ),
        _columns(dataset["laboratory_share"], "circular", "laboratory_{}_kinetic_share"),
    ]
    table = xr.merge(parts, compat="override").to_dataframe().reset_index()
    table["frame_of_wavenumber"] = dataset.attrs["frame"]
    units = {
        "wavenumber": "wavenumber_rad_per_A",
        "angular_frequency": "angular_frequency_rad_per_ps",
        "phase_velocity": "phase_velocity_A_per_ps",
        "group_velocity": "group_velocity_A_per_ps",
    }
    first = [units["wavenumber"], "frame_of_wavenumber", "branch"]
    table = table.rename(columns=units)
    return table[[*first, *(name for name in table.columns if name not in first)]]


def _columns(array: xr.DataArray, dimension: str, name: str) -> xr.Dataset:
    dataset = array.to_dataset(dimension)
    return dataset.rename({one: name.format(one) for one in dataset.data_vars})


def _strains() -> list[tuple[int, str]]:
    return list(enumerate(STRAINS))


def _straight_waves(rod: Rod) -> dict[str, tuple[Wave, Rod]]:
    """Return the standing waves of a rod, each with the straight uncoupled rod that carries it."""
    if rod.omega0_rad_per_nm.any():
        straight = rod.averaged_about_axis()
        planes = {"bend": straight}
    else:
        straight = rod.on_axis()
        planes = {"bend 1": _plane(straight, BEND_1), "bend 2": _plane(straight, BEND_2)}
    stiffness = np.diag(straight.stiffness).copy()
    stiffness[AXIAL] = np.diag(axial_stiffness(straight))
    axial = replace(
        straight,
        stiffness=np.diag(stiffness),
        inertia_Da_nm=np.diag(np.diag(straight.inertia_Da_nm)),
        centre_nm=np.zeros(3),
    )
    waves: dict[str, tuple[Wave, Rod]] = {
        "extension": ("extension", axial),
        "twist": ("twist", axial),
    }
    return waves | {name: ("bend", plane) for name, plane in planes.items()}


def _plane(rod: Rod, bend: int) -> Rod:
    """Return the isotropic rod whose every plane is that of bends about one axis of a rod."""
    shear = {BEND_1: SHEAR_2, BEND_2: SHEAR_1}[bend]
    stiffness = np.diag(rod.stiffness)[[shear, shear, EXTENSION, bend, bend, TWIST]]
    inertia = np.diag(rod.inertia_Da_nm)[[bend - BEND_1, bend - BEND_1, 2]]
    return replace(
        rod, stiffness=np.diag(stiffness), inertia_Da_nm=np.diag(inertia), centre_nm=np.zeros(3)
    )
