"""The forces of the environment: Amber DNA, condensed counterions, a continuous cutoff."""

from __future__ import annotations

import openmm
from openmm import app, unit

from dnawaves.scene.models import Environment

FORCE_FIELD_FILES = {
    "OL21": "amber19/DNA.OL21.xml",
    "OL15": "amber14/DNA.OL15.xml",
    "bsc1": "amber14/DNA.bsc1.xml",
}
# Large enough that the reaction field's force at the cutoff is zero to the last digit.
CONDUCTOR_DIELECTRIC = 1e9


def load_force_field(environment: Environment) -> app.ForceField:
    """Return the Amber DNA force field that the environment names."""
    return app.ForceField(FORCE_FIELD_FILES[environment.force_field])


def build_system(topology: app.Topology, environment: Environment) -> openmm.System:
    """Return the OpenMM System of a duplex in vacuum with condensed counterions.

    Coulomb forces go to zero at the cutoff (reaction field of a conductor), Lennard-Jones forces
    are switched off below it, so that the force has no jump and energy is conserved. Nothing is
    constrained and nothing removes the motion of the centre of mass: a remover would answer a
    kick, a load or a held end with a recoil of the whole duplex at once.
    """
    system = load_force_field(environment).createSystem(
        topology,
        nonbondedMethod=app.CutoffNonPeriodic,
        nonbondedCutoff=environment.cutoff_nm * unit.nanometer,
        constraints=None,
        rigidWater=False,
        removeCMMotion=False,
    )
    nonbonded = nonbonded_force(system)
    nonbonded.setReactionFieldDielectric(CONDUCTOR_DIELECTRIC)
    nonbonded.setUseSwitchingFunction(True)
    nonbonded.setSwitchingDistance(environment.switch_nm * unit.nanometer)
    condense_counterions(nonbonded, topology, environment.counterion_fraction)
    return system


def nonbonded_force(system: openmm.System) -> openmm.NonbondedForce:
    """Return the System's only NonbondedForce."""
    (force,) = (force for force in system.getForces() if isinstance(force, openmm.NonbondedForce))
    return force


def condense_counterions(
    nonbonded: openmm.NonbondedForce, topology: app.Topology, fraction: float
) -> None:
    """Add `fraction` of an elementary charge to each phosphate, a third to each of P, OP1, OP2.

    The products of charges in the 1-4 exceptions follow, with their Amber scaling.
    """
    old = charges_e(nonbonded)
    for residue in topology.residues():
        atoms = {atom.name: atom.index for atom in residue.atoms()}
        if "P" not in atoms:
            continue
        for name in ("P", "OP1", "OP2"):
            charge, sigma, epsilon = nonbonded.getParticleParameters(atoms[name])
            added = fraction / 3 * unit.elementary_charge
            nonbonded.setParticleParameters(atoms[name], charge + added, sigma, epsilon)
    new = charges_e(nonbonded)
    for index in range(nonbonded.getNumExceptions()):
        i, j, product, sigma, epsilon = nonbonded.getExceptionParameters(index)
        if old[i] * old[j] != 0:
            scaled = product * (new[i] * new[j] / (old[i] * old[j]))
            nonbonded.setExceptionParameters(index, i, j, scaled, sigma, epsilon)


def charges_e(nonbonded: openmm.NonbondedForce) -> list[float]:
    """Return the particles' charges in elementary charges."""
    return [
        nonbonded.getParticleParameters(index)[0].value_in_unit(unit.elementary_charge)
        for index in range(nonbonded.getNumParticles())
    ]
