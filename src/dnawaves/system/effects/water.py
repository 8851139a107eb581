"""Explicit solvent: water and ions in a box that is long enough for the held ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import app, unit

from dnawaves.duplex.build import seeded_random
from dnawaves.system.geometry import HelixFrame

Array = NDArray[np.float64]
Water = Literal["OPC", "TIP3P"]

# Each with the ions fitted to that water: OPC (Izadi, Anandakrishnan & Onufriev 2014) with Li,
# Song, Li & Merz; TIP3P (Jorgensen et al. 1983) with Joung & Cheatham 2008.
WATER_FILES = {"OPC": "amber19/opc.xml", "TIP3P": "amber14/tip3p.xml"}
# OpenMM's default. The Coulomb force jumps at the cutoff by about this part of itself.
EWALD_TOLERANCE = 5e-4
# The pre-equilibrated box of OpenMM that has the same number of sites.
_FILLED_FROM = {"OPC": "tip4pew", "TIP3P": "tip3p"}


@dataclass(frozen=True)
class Solvated:
    """A duplex in a box of water and ions, at positions (atoms, 3) in nm.

    The duplex's atoms come first and in their own order; its helix axis is the z axis and its
    middle the origin, which is the box's middle too.
    """

    topology: app.Topology
    positions_nm: Array
    duplex_atoms: int

    @property
    def box_nm(self) -> Array:
        """Lengths of the rectangular box, shape (3,)."""
        return np.array(self.topology.getUnitCellDimensions().value_in_unit(unit.nanometer))


def along_z(positions_nm: Array, frame: HelixFrame) -> Array:
    """Return positions turned so that the helix axis is the z axis, with the middle at z = 0."""
    turned: Array = (positions_nm - frame.origin_nm) @ frame.directions.T
    turned[:, 2] -= (turned[:, 2].min() + turned[:, 2].max()) / 2
    return turned


def box_lengths_nm(positions_nm: Array, padding_nm: float) -> Array:
    """Return the lengths (3,) of a box with `padding_nm` around a duplex that lies along z.

    The box is square across the axis, and images are twice the padding apart. It does not follow a
    duplex that turns over: hold an end, or keep runs short against the tens of nanoseconds that
    takes.
    """
    across = 2 * np.linalg.norm(positions_nm[:, :2], axis=1).max()
    along = np.ptp(positions_nm[:, 2])
    return np.array([across, across, along]) + 2 * padding_nm


def solvate(
    topology: app.Topology,
    positions_nm: Array,
    frame: HelixFrame,
    force_field: app.ForceField,
    water: Water,
    *,
    padding_nm: float = 1.0,
    salt_M: float = 0.0,
    cation: Literal["Na+", "K+"] = "Na+",
    seed: int = 1,
) -> Solvated:
    """Fill a box with water, cations that neutralise the duplex, and `salt_M` of cation and Cl-.

    `force_field` holds both the duplex's and the water's file. Ions replace waters chosen at
    random by `seed`. Water comes no nearer to the duplex than the atoms' radii, so the box is some
    percent too large until a barostat has equilibrated it.
    """
    upright = along_z(positions_nm, frame)
    modeller = app.Modeller(topology, upright * unit.nanometer)
    lengths = openmm.Vec3(*box_lengths_nm(upright, padding_nm))
    with seeded_random(seed):
        modeller.addSolvent(
            force_field,
            model=_FILLED_FROM[water],
            boxSize=lengths * unit.nanometer,
            positiveIon=cation,
            negativeIon="Cl-",
            ionicStrength=salt_M * unit.molar,
        )
    positions = np.array(modeller.positions.value_in_unit(unit.nanometer))
    return Solvated(
        modeller.topology,
        _in_the_models_shape(force_field.createSystem(modeller.topology), positions),
        topology.getNumAtoms(),
    )


def build_explicit(
    topology: app.Topology,
    force_field: app.ForceField,
    *,
    cutoff_nm: float = 0.9,
    switch_nm: float | None = 0.8,
    ewald_tolerance: float = EWALD_TOLERANCE,
    **options: object,
) -> openmm.System:
    """Return the System of a solvated duplex: particle-mesh Ewald, rigid water.

    Lennard-Jones forces are switched off from `switch_nm` on, or cut off where it is None. Nothing
    removes the motion of the centre of mass. `options` go to OpenMM's `createSystem`, such as
    those of `hydrogen_options`.
    """
    system = force_field.createSystem(
        topology,
        nonbondedMethod=app.PME,
        nonbondedCutoff=cutoff_nm * unit.nanometer,
        ewaldErrorTolerance=ewald_tolerance,
        rigidWater=True,
        removeCMMotion=False,
        **options,
    )
    (nonbonded,) = (f for f in system.getForces() if isinstance(f, openmm.NonbondedForce))
    nonbonded.setUseSwitchingFunction(switch_nm is not None)
    if switch_nm is not None:
        nonbonded.setSwitchingDistance(switch_nm * unit.nanometer)
    return system


def _in_the_models_shape(system: openmm.System, positions_nm: Array) -> Array:
    """Return the positions with each water's bonds, angle and massless site as its model has it."""
    while system.getNumForces():
        system.removeForce(0)
    context = openmm.Context(
        system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference")
    )
    context.setPositions(positions_nm)
    context.applyConstraints(1e-8)
    context.computeVirtualSites()
    state = context.getState(getPositions=True)
    return np.array(state.getPositions(asNumpy=True).value_in_unit(unit.nanometer))
