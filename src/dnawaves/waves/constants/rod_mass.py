"""Density and inertia of a duplex as a rod, from its atoms, and the speeds that follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.measured import mass_per_length
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.stiffness import base_pair_frames
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM

Array = NDArray[np.float64]

SPEEDS = (
    "speed_extension_A_per_ps",
    "speed_twist_A_per_ps",
    "speed_bend_A_per_ps",
    "speed_shear_A_per_ps",
)


@dataclass(frozen=True)
class RodMass:
    """Mass per length of a straight rod: density, inertia about and across the helix axis."""

    density_Da_per_A: float
    inertia_axial_Da_A: float
    inertia_transverse_Da_A: float

    def speeds(self, stiffness: Mapping[str, float]) -> dict[str, float]:
        """Return the speeds, by the names of `SPEEDS`, of constants by their names.

        Extension and twist are the long waves, mixed as their coupling says and named by most of
        their kinetic energy (no coupling given: none); bend and shear are the short waves. Those
        whose constants are not given are left out.
        """
        # One pN nm in Da Å²/ps²: a kJ/mol is 100 of them.
        unit = A_PER_NM**2 * KJ_PER_MOL_PER_PN_NM
        force, torque, area = unit / A_PER_NM, unit, unit * A_PER_NM
        density, inertia = self.density_Da_per_A, self.inertia_axial_Da_A
        squared = {
            "extension": force * stiffness.get("stretch_modulus_pN", np.nan) / density,
            "twist": area * stiffness.get("twist_rigidity_pN_nm2", np.nan) / inertia,
            "bend": area
            * stiffness.get("bend_rigidity_pN_nm2", np.nan)
            / self.inertia_transverse_Da_A,
            "shear": force * stiffness.get("shear_stiffness_pN", np.nan) / density,
        }
        coupling = torque * stiffness.get("twist_stretch_coupling_pN_nm", 0.0)
        if coupling and np.isfinite(squared["extension"] + squared["twist"]):
            cross = coupling / np.sqrt(density * inertia)
            values, vectors = np.linalg.eigh(
                [[squared["extension"], cross], [cross, squared["twist"]]]
            )
            extension = int(np.argmax(np.abs(vectors[0])))
            squared["extension"], squared["twist"] = values[extension], values[1 - extension]
        return {
            f"speed_{wave}_A_per_ps": float(np.sqrt(value))
            for wave, value in squared.items()
            if np.isfinite(value)
        }


def rod_mass(duplex: SimulatedDuplex) -> RodMass:
    """Return the mean mass per length of all base pairs, inertia about the helix axis."""
    about = mass_per_length(
        duplex.positions_nm[: duplex.solute],
        duplex.masses_Da[: duplex.solute],
        duplex.pairs,
        duplex.pivots_nm,
        np.tile(duplex.frame.directions, (duplex.pair_count, 1, 1)),
        duplex.spacing_nm,
    )
    # Each pair about its own point of the axis: what winds about the axis adds to the inertia.
    centre = about.centre_nm
    arm = np.sum(centre**2) * np.eye(3) - np.outer(centre, centre)
    inertia = np.diag(about.inertia_Da_nm + about.density_Da_per_nm * arm)
    return RodMass(
        about.density_Da_per_nm / A_PER_NM,
        A_PER_NM * float(inertia[2]),
        A_PER_NM * float(inertia[:2].mean()),
    )


def topology_constants(duplex: SimulatedDuplex) -> dict[str, float]:
    """Return spacing, twist, density and inertia of a structure, as `constants` names them.

    The three moments of inertia are those about the base pairs' centres of mass, along the axes of
    their standard frames; twist is the mean turn of the long axes about the helix axis.
    """
    mass, frames = rod_mass(duplex), base_pair_frames(duplex)
    axes = frames.axes.transpose(2, 0, 1)
    own = np.einsum("pix,pxy,piy->pi", axes, duplex.bodies.inertia_Da_nm2, axes).mean(axis=0)
    long_axis = axes[:, 1] @ duplex.frame.directions.T
    angle = np.unwrap(np.arctan2(long_axis[:, 1], long_axis[:, 0]))
    spacing_A = A_PER_NM * duplex.spacing_nm
    moments = A_PER_NM**2 * own / spacing_A
    return {
        "spacing_A": spacing_A,
        "twist_deg_per_bp": float(np.degrees(angle[-1] - angle[0]) / (len(angle) - 1)),
        "mass_Da_per_bp": mass.density_Da_per_A * spacing_A,
        "density_Da_per_A": mass.density_Da_per_A,
        **{f"inertia_{i}_Da_A": float(moment) for i, moment in enumerate(moments, 1)},
        "inertia_axial_Da_A": mass.inertia_axial_Da_A,
        "inertia_transverse_Da_A": mass.inertia_transverse_Da_A,
    }
