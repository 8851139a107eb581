"""The forces of the environment: Amber DNA with condensed counterions, or in a solvent."""

from __future__ import annotations

import openmm
from openmm import app, unit

from dnawaves.scene.contradictions import EXPLICIT
from dnawaves.scene.environment import Environment
from dnawaves.system.effects.constraints import hydrogen_options
from dnawaves.system.effects.implicit import custom_born, native_obc2
from dnawaves.system.effects.water import WATER_FILES, build_explicit

FORCE_FIELD_FILES = {
    "OL21": "amber19/DNA.OL21.xml",
    "OL15": "amber14/DNA.OL15.xml",
    "bsc1": "amber14/DNA.bsc1.xml",
}
# Large enough that the reaction field's force at the cutoff is zero to the last digit.
CONDUCTOR_DIELECTRIC = 1e9


def load_force_field(environment: Environment) -> app.ForceField:
    """Return the Amber DNA force field that the environment names, with its water if explicit."""
    files = [FORCE_FIELD_FILES[environment.force_field]]
    if environment.solvent in EXPLICIT:
        files.append(WATER_FILES[environment.solvent])
    return app.ForceField(*files)


def build_system(topology: app.Topology, environment: Environment) -> openmm.System:
    """Return the OpenMM System of a duplex in its environment.

    Nothing removes the motion of the centre of mass: a remover would answer a kick, a load or a
    held end with a recoil of the whole duplex at once.
    """
    force_field = load_force_field(environment)
    hydrogens = hydrogen_options(environment.constraints, environment.hydrogen_mass_Da)
    if environment.solvent in EXPLICIT and topology.getUnitCellDimensions() is None:
        # The duplex taken out of its water: it has masses and bonds, but is not to be simulated.
        return force_field.createSystem(topology, removeCMMotion=False, **hydrogens)
    if environment.solvent in EXPLICIT:
        assert environment.cutoff_nm
        return build_explicit(
            topology,
            force_field,
            cutoff_nm=environment.cutoff_nm,
            switch_nm=environment.switch_nm,
            **hydrogens,
        )
    implicit = environment.solvent != "none"
    system = force_field.createSystem(
        topology,
        nonbondedMethod=app.NoCutoff if implicit else app.CutoffNonPeriodic,
        rigidWater=False,
        removeCMMotion=False,
        **hydrogens,
    )
    nonbonded = nonbonded_force(system)
    if implicit:
        system.addForce(_implicit_solvent(topology, environment, charges_e(nonbonded)))
    else:
        assert environment.cutoff_nm and environment.switch_nm
        assert environment.counterion_fraction is not None
        cut_off(nonbonded, environment.cutoff_nm, environment.switch_nm)
        condense_counterions(nonbonded, topology, environment.counterion_fraction)
    return system


def cut_off(nonbonded: openmm.NonbondedForce, cutoff_nm: float, switch_nm: float) -> None:
    """Let the forces end at a cutoff without a jump, so that energy is conserved.

    Coulomb forces go to zero at the cutoff (reaction field of a conductor), Lennard-Jones forces
    are switched off below it.
    """
    nonbonded.setCutoffDistance(cutoff_nm * unit.nanometer)
    nonbonded.setReactionFieldDielectric(CONDUCTOR_DIELECTRIC)
    nonbonded.setUseSwitchingFunction(True)
    nonbonded.setSwitchingDistance(switch_nm * unit.nanometer)


def _implicit_solvent(
    topology: app.Topology, environment: Environment, charges: list[float]
) -> openmm.Force:
    if environment.solvent == "OBC2" and environment.salt_M == 0:
        return native_obc2(topology, charges, surface_area=environment.surface_area)
    return custom_born(
        "GBn2" if environment.solvent == "GBn2" else "OBC2",
        topology,
        FORCE_FIELD_FILES[environment.force_field],
        salt_M=environment.salt_M,
        surface_area=environment.surface_area,
    )


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
