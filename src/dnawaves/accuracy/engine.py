"""A copy of a duplex under any of the settings of a study."""

from __future__ import annotations

import copy
import itertools
from dataclasses import replace

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm.mtsintegrator import MTSIntegrator

from dnawaves.accuracy.models import LANGEVIN, SEVERAL_FORCES, Numerics
from dnawaves.errors import SimulationError
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.thermostat import langevin_middle, velocity_verlet_with_friction
from dnawaves.system.forces import nonbonded_force
from dnawaves.trajectory.guard import exploded
from dnawaves.trajectory.verlet import leapfrog

Array = NDArray[np.float64]
# Velocities that are half a step behind the positions.
LATE = ("leapfrog", LANGEVIN)
FAST, SLOW = 0, 1
# Of water at 25 °C, as OpenMM's implicit solvents of Amber take it.
WATER_DIELECTRIC = 78.5
SEED = 1


class Engine:
    """One copy, kicked at t = 0 from a minimum, read at the times of frames.

    Raises
    ------
    SimulationError
        When the platform is not there, and later when the copy explodes.
    """

    def __init__(
        self,
        duplex: SimulatedDuplex,
        held: list[int],
        numerics: Numerics,
        velocities_nm_per_ps: Array,
        threads: int = 1,
    ) -> None:
        self._late, self._ahead = numerics.integrator in LATE, False
        system = system_under(duplex, held, numerics)
        try:
            self._context = openmm.Context(
                system,
                integrator_of(numerics),
                openmm.Platform.getPlatformByName(numerics.platform),
                _properties(numerics, threads),
            )
        except openmm.OpenMMException as error:
            raise SimulationError(f"{numerics.platform} is not to be had here: {error}") from None
        self._context.setPositions(duplex.positions_nm)
        # A leapfrog's first half step back changes nothing: at a minimum there are no forces.
        self._context.setVelocities(velocities_nm_per_ps)
        self._context.getState(forces=True)

    def advance(self, steps: int) -> tuple[Array, Array]:
        """Go on by so many timesteps; return positions (nm) and velocities (nm/ps) of that time."""
        integrator = self._context.getIntegrator()
        try:
            integrator.step(steps - self._ahead)
            state = self._context.getState(positions=True, velocities=True)
            velocities = state.getVelocities(asNumpy=True)._value
            if self._late:
                # The mean of half a step before and after, also where there are constraints.
                integrator.step(1)
                later = self._context.getState(velocities=True).getVelocities(asNumpy=True)._value
                velocities, self._ahead = 0.5 * (velocities + later), True
        except openmm.OpenMMException as error:
            raise SimulationError(f"unstable: {error}") from None
        if exploded(velocities):
            raise SimulationError("unstable: it explodes")
        return np.array(state.getPositions(asNumpy=True)._value), np.array(velocities)


def integrator_of(numerics: Numerics) -> openmm.Integrator:
    """Return the integrator that a setting names."""
    timestep_ps = numerics.timestep_fs / 1e3
    if numerics.integrator == "leapfrog":
        return leapfrog(timestep_ps)
    if numerics.integrator == "velocity Verlet":
        return velocity_verlet_with_friction(timestep_ps, 0.0)
    if numerics.integrator == SEVERAL_FORCES:
        return multiple_timestep(timestep_ps, numerics.inner_steps)
    assert numerics.integrator == LANGEVIN
    return langevin_middle(0.0, numerics.friction_per_ps, timestep_ps, SEED)


def multiple_timestep(timestep_ps: float, inner_steps: int) -> MTSIntegrator:
    """Return the integrator that takes so many steps of all but the nonbonded forces in each."""
    return MTSIntegrator(timestep_ps, [(SLOW, 1), (FAST, inner_steps)])


def split_forces(system: openmm.System) -> None:
    """Put the forces into the groups that `multiple_timestep` tells apart."""
    for force in system.getForces():
        force.setForceGroup(FAST)
    nonbonded_force(system).setForceGroup(SLOW)


def system_under(duplex: SimulatedDuplex, held: list[int], numerics: Numerics) -> openmm.System:
    """Return a copy of the duplex's System as a setting asks for it, held pairs without mass."""
    if numerics.hydrogen_mass_Da is not None:
        duplex = _with_hydrogens_of(duplex, numerics.hydrogen_mass_Da)
    system = copy.deepcopy(duplex.system)
    frozen = np.isin(duplex.pairs, held)
    for atom in np.flatnonzero(frozen):
        system.setParticleMass(int(atom), 0.0)
    if numerics.constraints == "hbonds":
        for hydrogen, heavy in hydrogen_bonds(duplex):
            if not frozen[hydrogen]:
                # At the lengths of the minimum: at the force field's own, it would be none.
                arm = duplex.positions_nm[hydrogen] - duplex.positions_nm[heavy]
                system.addConstraint(hydrogen, heavy, float(np.linalg.norm(arm)))
    nonbonded = nonbonded_force(system)
    if numerics.cutoff != "smooth":
        nonbonded.setUseSwitchingFunction(False)
    if numerics.cutoff == "jump":
        nonbonded.setReactionFieldDielectric(WATER_DIELECTRIC)
    if numerics.integrator == SEVERAL_FORCES:
        split_forces(system)
    return system


def hydrogen_bonds(duplex: SimulatedDuplex) -> list[tuple[int, int]]:
    """Return hydrogen and heavy atom of each bond to hydrogen."""
    both = itertools.chain.from_iterable(((a, b), (b, a)) for a, b in duplex.topology.bonds())
    return [(a.index, b.index) for a, b in both if a.element.symbol == "H"]


def _with_hydrogens_of(duplex: SimulatedDuplex, mass_Da: float) -> SimulatedDuplex:
    heavier = duplex.spec.environment.model_copy(update={"hydrogen_mass_Da": mass_Da})
    return replace(duplex, spec=duplex.spec.model_copy(update={"environment": heavier}))


def _properties(numerics: Numerics, threads: int) -> dict[str, str]:
    if numerics.platform == "CPU":
        return {"Threads": str(threads), "DeterministicForces": "true"}
    return {"Precision": numerics.precision} if numerics.precision else {}
