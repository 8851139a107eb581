"""Constrained bonds to hydrogen, and mass moved from heavy atoms to their hydrogens."""

from __future__ import annotations

from typing import Any, Literal

import openmm
from openmm import app, unit

from dnawaves.errors import InputError

CONSTRAINTS = {"none": None, "hbonds": app.HBonds}


def hydrogen_options(
    constraints: Literal["none", "hbonds"], hydrogen_mass_Da: float | None
) -> dict[str, Any]:
    """Return OpenMM's `createSystem` options for constraints and heavier hydrogens.

    What a hydrogen gains its heavy atom loses, so each residue keeps its mass (Hopkins et al.
    2015, J. Chem. Theory Comput. 11, 1864). Rigid water keeps its own masses.
    """
    mass = None if hydrogen_mass_Da is None else hydrogen_mass_Da * unit.dalton
    return {"constraints": CONSTRAINTS[constraints], "hydrogenMass": mass}


def degrees_of_freedom(system: openmm.System) -> int:
    """Return the number of degrees of freedom: of all that has mass, less the constraints."""
    massive = sum(system.getParticleMass(i)._value > 0 for i in range(system.getNumParticles()))
    return 3 * massive - system.getNumConstraints()


def refuse_constraints_on_frozen(system: openmm.System, topology: app.Topology) -> None:
    """Raise `InputError`, with the first one's atoms named, where a constraint meets a frozen atom.

    A frozen atom has mass zero. OpenMM refuses a constraint between a frozen and a free atom,
    without names, and ignores one between two frozen atoms.
    """
    atoms = list(topology.atoms())
    touched = []
    for index in range(system.getNumConstraints()):
        pair = system.getConstraintParameters(index)[:2]
        if any(system.getParticleMass(atom)._value == 0 for atom in pair):
            touched.append(pair)
    if touched:
        names = " and ".join(
            f"{atom.residue.chain.id}:{atom.residue.id}:{atom.name}"
            for atom in (atoms[index] for index in touched[0])
        )
        raise InputError(
            f"constraints: found {len(touched)} that touch frozen atoms, first that of {names}; "
            "allowed: constraints 'none', or ends that are restrained instead of frozen"
        )
