"""Normal modes on disk, with what they say about the duplex."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from dnawaves.errors import InputError
from dnawaves.files import provenance
from dnawaves.system.duplex import SimulatedDuplex, read_result
from dnawaves.system.modes import EIGENVALUE_TOLERANCE_PER_PS2, NormalModes, participation
from dnawaves.system.stiffness import STRAINS, axis_compliance, strain_compliance
from dnawaves.system.structure_factor import (
    COORDINATES,
    axis_shapes,
    velocity_structure_factor,
)
from dnawaves.units import A_PER_NM

# The structure factor is drawn up to where waves of base pairs end; a mode is 20 GHz wide, the
# distance of neighbouring standing waves of 24 base pairs.
TOP_GHZ, WIDTH_GHZ, SAMPLES = 3000.0, 20.0, 301


def modes_dataset(modes: NormalModes, duplex: SimulatedDuplex, held: tuple[int, int]) -> xr.Dataset:
    """Return the modes with labels and units.

    The structure factor is added for every pattern of held pairs, the compliance of the steps
    only for the free duplex: held pairs would stiffen those beside them.
    """
    values = modes.eigenvalues_per_ps2
    shares = participation(modes, duplex)
    dataset = xr.Dataset(
        {
            "eigenvalue": ("mode", values, {"units": "ps-2"}),
            "shape": (
                ("mode", "pair", "component"),
                modes.shapes,
                {
                    "units": "Da-1/2, rad Da-1/2 nm-1",
                    "long_name": "velocity and angular velocity per mass-weighted velocity",
                },
            ),
            "share": (
                ("mode", "wave", "pair"),
                np.stack(list(shares.values()), axis=1),
                {"units": "1", "long_name": "part of the mode's kinetic energy"},
            ),
            "mass": ("pair", duplex.bodies.masses_Da, {"units": "Da"}),
            "axial_inertia": (
                "pair",
                A_PER_NM**2 * duplex.axial_inertia_Da_nm2,
                {"units": "Da angstrom2", "long_name": "moment of inertia about the helix axis"},
            ),
        },
        coords={
            "pair": duplex.labels,
            "height": ("pair", A_PER_NM * duplex.heights_nm, {"units": "angstrom"}),
            "component": ["x", "y", "z", "about x", "about y", "about z"],
            "wave": list(shares),
        },
        attrs={
            "spec": duplex.spec.model_dump_json(),
            "held_first": held[0],
            "held_last": held[1],
            "rigid_modes": modes.rigid,
            "zero_modes": int(np.sum(np.abs(values) <= EIGENVALUE_TOLERANCE_PER_PS2)),
            "negative_modes": int(np.sum(values < -EIGENVALUE_TOLERANCE_PER_PS2)),
            "eigenvalue_tolerance_per_ps2": EIGENVALUE_TOLERANCE_PER_PS2,
            **provenance("numpy", "scipy"),
        },
    )
    dataset = dataset.merge(_structure_factor(modes, duplex))
    if not any(held):
        dataset["strain_compliance"] = (
            ("step", "strain", "other_step", "other_strain"),
            strain_compliance(modes, duplex),
            {"units": "angstrom, rad per kJ/mol", "long_name": "covariance of strains per kBT"},
        )
        dataset["axis_compliance"] = (
            ("pair", "coordinate", "other_pair", "other_coordinate"),
            axis_compliance(modes, duplex),
            {"units": "angstrom, rad per kJ/mol", "long_name": "covariance of motion per kBT"},
        )
        dataset = dataset.assign_coords(other_coordinate=list(COORDINATES))
        names = list(STRAINS)
        dataset = dataset.assign_coords(strain=names, other_strain=names)
    return dataset


def _structure_factor(modes: NormalModes, duplex: SimulatedDuplex) -> xr.Dataset:
    phases = np.pi * np.arange(duplex.pair_count + 1) / duplex.pair_count
    frequencies = np.linspace(0, TOP_GHZ, SAMPLES)
    factor = velocity_structure_factor(
        modes, axis_shapes(modes, duplex), phases, frequencies, WIDTH_GHZ
    )
    # From nm to Å for the linear coordinates.
    factor[:3] *= A_PER_NM**2
    wavenumbers = phases / (A_PER_NM * duplex.spacing_nm)
    return xr.Dataset(
        {
            "velocity_structure_factor": (
                ("coordinate", "wavenumber", "frequency"),
                factor,
                {
                    "units": "angstrom2 ps-2 or rad2 ps-2 per kJ/mol and GHz",
                    "long_name": "S(q, f) of the velocities per kBT",
                    "width_GHz": WIDTH_GHZ,
                },
            )
        },
        coords={
            "coordinate": list(COORDINATES),
            "wavenumber": ("wavenumber", wavenumbers, {"units": "rad/angstrom"}),
            "frequency": ("frequency", frequencies, {"units": "GHz"}),
        },
    )


def read_modes(path: Path, duplex: SimulatedDuplex, held: tuple[int, int]) -> NormalModes:
    """Return the modes that `dnawaves modes` wrote for the same system and held pairs.

    Raises `InputError` where they belong to others.
    """
    dataset = read_result(duplex.spec, path, "modes", "eigenvalue", "shape")
    found = (int(dataset.attrs["held_first"]), int(dataset.attrs["held_last"]))
    if found != held:
        raise InputError(
            f"{path}: found the modes with {found[0]} and {found[1]} base pairs held; "
            f"allowed: those with {held[0]} and {held[1]}"
        )
    return NormalModes(
        duplex.bodies,
        dataset["eigenvalue"].values,
        dataset["shape"].values,
        int(dataset.attrs["rigid_modes"]),
    )
