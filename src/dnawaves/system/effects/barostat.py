"""A barostat, for equilibration only: what is measured is measured in a box of fixed size."""

from __future__ import annotations

import openmm

from dnawaves.errors import InputError
from dnawaves.system.effects.thermostat import openmm_seed

ATMOSPHERE_bar = 1.01325
STEPS_PER_ATTEMPT = 25


def barostat(
    temperature_K: float,
    seed: int,
    *,
    along_axis: bool,
    pressure_bar: float = ATMOSPHERE_bar,
    steps_per_attempt: int = STEPS_PER_ATTEMPT,
) -> openmm.Force:
    """Return a Monte Carlo barostat of a box whose z axis is the helix axis.

    With `along_axis` all three lengths change in proportion, for a duplex that is free. Where ends
    are restrained the box keeps its length and only its cross-section changes: the springs would
    answer a change of length, and the pressure would be theirs, not the water's. Molecules are
    moved in proportion to their distance from the origin, so the duplex must be there.
    """
    force: openmm.Force
    if along_axis:
        force = openmm.MonteCarloBarostat(pressure_bar, temperature_K, steps_per_attempt)
    else:
        # Without surface tension. Scaled one by one, as by the anisotropic barostat, the two sides
        # would drift apart: a liquid does not resist it.
        force = openmm.MonteCarloMembraneBarostat(
            pressure_bar,
            0.0,
            temperature_K,
            openmm.MonteCarloMembraneBarostat.XYIsotropic,
            openmm.MonteCarloMembraneBarostat.ZFixed,
            steps_per_attempt,
        )
    force.setRandomNumberSeed(openmm_seed(seed))
    return force


def refuse_barostat_on_frozen(system: openmm.System) -> None:
    """Raise `InputError` where a barostat would move frozen atoms, as OpenMM's do.

    They scale the places of whole molecules, whether or not their atoms have mass.
    """
    barostats = [force for force in system.getForces() if "Barostat" in force.getName()]
    frozen = sum(
        system.getParticleMass(index)._value == 0 and not system.isVirtualSite(index)
        for index in range(system.getNumParticles())
    )
    if barostats and frozen:
        raise InputError(
            f"barostat: found {frozen} frozen atoms, which it would move; "
            "allowed: ends that are free or restrained while the box is equilibrated"
        )
