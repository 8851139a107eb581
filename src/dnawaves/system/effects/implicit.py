"""Implicit solvent: generalised Born models with full phosphate charges and no cutoff."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Literal

import numpy as np
import openmm
import scipy.constants
from numpy.typing import NDArray
from openmm import app

from dnawaves.errors import InputError

Array = NDArray[np.float64]

SOLVENT_DIELECTRIC = 78.5
SOLUTE_DIELECTRIC = 1.0
# 5.4 cal/mol/A^2 in kJ/mol/nm^2 (Schaefer, Bartels & Karplus 1998, J. Mol. Biol. 284, 835).
SURFACE_ENERGY_kJ_PER_MOL_NM2 = 2.25936
# Radii of Bondi 1964 as Amber changed them for OBC (mbondi2: Onufriev, Bashford & Case 2004,
# Proteins 55, 383), and the overlap scales of Hawkins, Cramer & Truhlar 1996 (J. Phys. Chem.
# 100, 19824), by element.
RADIUS_nm = {"H": 0.12, "C": 0.17, "N": 0.155, "O": 0.15, "P": 0.185}
HYDROGEN_ON_NITROGEN_RADIUS_nm = 0.13
OVERLAP_SCALE = {"H": 0.85, "C": 0.72, "N": 0.79, "O": 0.85, "P": 0.86}
# Ions keep off the solute's surface (Srinivasan, Trevathan, Beroza & Case 1999, Theor. Chem. Acc.
# 101, 426).
ION_EXCLUSION = 0.73


def native_obc2(
    topology: app.Topology,
    charges_e: Sequence[float],
    *,
    solvent_dielectric: float = SOLVENT_DIELECTRIC,
    solute_dielectric: float = SOLUTE_DIELECTRIC,
    surface_area: bool = False,
) -> openmm.GBSAOBCForce:
    """Return OBC2 (Amber's igb=5) as OpenMM's own force, which knows no salt.

    It goes with a NonbondedForce without cutoff. With `surface_area` the nonpolar term of ACE is
    added; Amber's default is without. Raises `InputError` for elements that DNA does not have.
    """
    force = openmm.GBSAOBCForce()
    force.setNonbondedMethod(openmm.GBSAOBCForce.NoCutoff)
    force.setSolventDielectric(solvent_dielectric)
    force.setSoluteDielectric(solute_dielectric)
    force.setSurfaceAreaEnergy(SURFACE_ENERGY_kJ_PER_MOL_NM2 if surface_area else 0.0)
    for charge, (radius, scale) in zip(charges_e, obc2_parameters(topology), strict=True):
        force.addParticle(charge, radius, scale)
    return force


def obc2_parameters(topology: app.Topology) -> Array:
    """Return each atom's mbondi2 radius in nm and overlap scale, shape (atoms, 2)."""
    on_nitrogen = set()
    for one, other in topology.bonds():
        for atom, partner in ((one, other), (other, one)):
            if atom.element is app.element.hydrogen and partner.element is app.element.nitrogen:
                on_nitrogen.add(atom.index)
    parameters = np.empty((topology.getNumAtoms(), 2))
    for atom in topology.atoms():
        symbol = atom.element.symbol if atom.element else "none"
        if symbol not in RADIUS_nm:
            raise InputError(
                f"implicit solvent: found an atom {atom.name} of element {symbol}; "
                f"allowed: {', '.join(RADIUS_nm)}"
            )
        radius = RADIUS_nm[symbol]
        if atom.index in on_nitrogen:
            radius = HYDROGEN_ON_NITROGEN_RADIUS_nm
        parameters[atom.index] = radius, OVERLAP_SCALE[symbol]
    return parameters


def custom_born(
    model: Literal["OBC2", "GBn2"],
    topology: app.Topology,
    force_field_file: str,
    *,
    salt_M: float = 0.0,
    temperature_K: float = 300.0,
    solvent_dielectric: float = SOLVENT_DIELECTRIC,
    solute_dielectric: float = SOLUTE_DIELECTRIC,
    surface_area: bool = False,
) -> openmm.CustomGBForce:
    """Return OBC2 or GBn2 (Amber's igb=5, 8) as OpenMM's CustomGBForce, with salt.

    Many times slower than `native_obc2`; `benchmarks/solvent.py` shows how many.
    """
    system = app.ForceField(force_field_file, f"implicit/{model.lower()}.xml").createSystem(
        topology,
        nonbondedMethod=app.NoCutoff,
        removeCMMotion=False,
        soluteDielectric=solute_dielectric,
        solventDielectric=solvent_dielectric,
        implicitSolventKappa=inverse_debye_length_per_nm(salt_M, temperature_K, solvent_dielectric),
        sasaMethod="ACE" if surface_area else None,
    )
    (force,) = (f for f in system.getForces() if isinstance(f, openmm.CustomGBForce))
    return copy.deepcopy(force)


def inverse_debye_length_per_nm(salt_M: float, temperature_K: float, dielectric: float) -> float:
    """Return the screening constant of a 1:1 salt, less the part that ion exclusion takes."""
    permittivity = dielectric * scipy.constants.epsilon_0
    ions_per_m3 = 2e3 * salt_M * scipy.constants.N_A
    energy = scipy.constants.k * temperature_K
    kappa = np.sqrt(ions_per_m3 * scipy.constants.e**2 / (permittivity * energy))
    return float(ION_EXCLUSION * kappa * 1e-9)
