"""A System in motion: positions and velocities of the same time, saved and taken up again."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import unit

from dnawaves.errors import InputError
from dnawaves.system.effects.constraints import degrees_of_freedom
from dnawaves.trajectory.noise import restart_shared_noise, seed_at, shares_noise
from dnawaves.trajectory.verlet import KEPT_VARIABLES

Array = NDArray[np.float64]
# Of the constrained distances, for velocities.
CONSTRAINT_TOLERANCE = 1e-8


@dataclass(frozen=True)
class Saved:
    """A moment to go on from: OpenMM's State and the global variables of a driven integrator."""

    state: openmm.State
    variables: dict[str, float]


@dataclass(frozen=True)
class Frame:
    """Positions (nm), velocities (nm/ps) and forces (kJ/mol/nm), (atoms, 3), and energy (kJ/mol).

    `late_kinetic_kJ_per_mol` is that of the leapfrog's own velocities, half a step late. These have
    the thermostat's temperature; those at the time of the positions have less, in an oscillation
    of rate w the part (w dt)²/4 (Zhang et al. 2019, J. Phys. Chem. A 123, 6056). `saved` holds the
    same moment for `Dynamics.restore`.
    """

    positions_nm: Array
    velocities_nm_per_ps: Array
    forces: Array
    energy_kJ_per_mol: float
    late_kinetic_kJ_per_mol: float
    saved: Saved


class Dynamics:
    """A System on a platform, integrated by a leapfrog.

    `drive` (atoms, 3) in kJ/mol/nm goes with the integrator of `verlet.driven_leapfrog`. With
    `seeds`, noise is drawn by them and by the number of the step, and no other: the same seeds
    give the same noise, also where a run goes on from a saved moment.

    Raises
    ------
    InputError
        When this OpenMM has no such platform.
    """

    def __init__(
        self,
        system: openmm.System,
        integrator: openmm.Integrator,
        drive: Array | None = None,
        platform: str = "CPU",
        threads: int = 1,
        seeds: Sequence[int] | None = None,
    ) -> None:
        self._integrator, self._drive, self._seeds = integrator, drive, seeds
        self._shares_noise = seeds is not None and shares_noise(integrator, platform)
        if seeds is not None:
            integrator.setRandomNumberSeed(seed_at(seeds, 0))
        self._context = openmm.Context(
            system, integrator, find_platform(platform), properties(platform, threads)
        )
        count = system.getNumParticles()
        self._masses = np.array([system.getParticleMass(i)._value for i in range(count)])[:, None]
        half_ps = 0.5 * integrator.getStepSize().value_in_unit(unit.picosecond)
        # What has no mass is held.
        self._half = np.divide(
            half_ps, self._masses, out=np.zeros_like(self._masses), where=self._masses > 0
        )
        self._rigid = _forceless(system) if system.getNumConstraints() else None
        self.degrees_of_freedom = degrees_of_freedom(system)

    def start(self, positions_nm: Array, velocities_nm_per_ps: Array) -> None:
        """Set positions and velocities at t = 0."""
        self._context.setPositions(positions_nm)
        if self._rigid is not None:
            # Places sites without mass too.
            self._context.applyConstraints(CONSTRAINT_TOLERANCE)
        self._set_drive()
        forces = self._context.getState(forces=True).getForces(asNumpy=True)._value
        late = velocities_nm_per_ps - self._half * forces
        self._context.setVelocities(self._allowed(positions_nm, late))

    def step(self, steps: int) -> None:
        """Advance by a number of timesteps."""
        if self._shares_noise and self._seeds is not None:
            restart_shared_noise(seed_at(self._seeds, self._context.getStepCount()))
        self._integrator.step(steps)

    def frame(self) -> Frame:
        """Return what there is now; costs one evaluation of forces and energy."""
        state = self._context.getState(positions=True, velocities=True, forces=True, energy=True)
        positions = np.array(state.getPositions(asNumpy=True)._value)
        forces = np.array(state.getForces(asNumpy=True)._value)
        variables = {}
        if self._drive is not None:
            variables = {name: self.drive_variable(name) for name in KEPT_VARIABLES}
            forces += variables["now"] * self._drive
        late = np.array(state.getVelocities(asNumpy=True)._value)
        velocities = self._allowed(positions, late + self._half * forces)
        kinetic = 0.5 * float(np.sum(self._masses * velocities**2))
        return Frame(
            positions,
            velocities,
            forces,
            state.getPotentialEnergy()._value + kinetic,
            0.5 * float(np.sum(self._masses * late**2)),
            Saved(state, variables),
        )

    def late_velocities(self) -> Array:
        """Return the leapfrog's own velocities, half a step late; needs no force."""
        state = self._context.getState(velocities=True)
        return np.array(state.getVelocities(asNumpy=True)._value)

    def restore(self, saved: Saved) -> None:
        """Go on from a saved moment, as if nothing had been before.

        The order in which forces are summed depends on the list of neighbours, and that on the
        past; so does noise. A context that is made anew has none, so that a run that is killed and
        taken up here equals one that goes on from here, to the last digit on one thread.
        """
        if self._seeds is not None:
            self._integrator.setRandomNumberSeed(seed_at(self._seeds, saved.state.getStepCount()))
        self._context.reinitialize()
        self._context.setState(saved.state)
        self._set_drive()
        for name, value in saved.variables.items():
            self._integrator.setGlobalVariableByName(name, value)

    def drive_variable(self, name: str) -> float:
        """Return a global variable of the driven integrator, such as `work`."""
        return float(self._integrator.getGlobalVariableByName(name))

    def _set_drive(self) -> None:
        if self._drive is not None:
            self._integrator.setPerDofVariableByName("drive", self._drive)

    def _allowed(self, positions_nm: Array, velocities_nm_per_ps: Array) -> Array:
        """Return velocities without what would change a constrained distance."""
        if self._rigid is None:
            return velocities_nm_per_ps
        self._rigid.setPositions(positions_nm)
        self._rigid.setVelocities(velocities_nm_per_ps)
        self._rigid.applyVelocityConstraints(CONSTRAINT_TOLERANCE)
        state = self._rigid.getState(velocities=True)
        return np.array(state.getVelocities(asNumpy=True)._value)


def find_platform(name: str) -> openmm.Platform:
    """Return OpenMM's platform of that name; raises `InputError` with those that there are."""
    count = openmm.Platform.getNumPlatforms()
    found = [openmm.Platform.getPlatform(index).getName() for index in range(count)]
    if name not in found:
        raise InputError(f"platform: found {name!r}; allowed: {', '.join(sorted(found))}")
    return openmm.Platform.getPlatformByName(name)


def properties(platform: str, threads: int) -> dict[str, str]:
    """Return the properties with which runs on a platform repeat, in the precision they need."""
    if platform == "CPU":
        return {"Threads": str(threads), "DeterministicForces": "true"}
    if platform == "CUDA":
        return {"Precision": "mixed", "DeterministicForces": "true"}
    return {} if platform == "Reference" else {"Precision": "mixed"}


def _forceless(system: openmm.System) -> openmm.Context:
    """Return a context that knows the masses and constraints of a System, for velocities alone."""
    bare = copy.deepcopy(system)
    while bare.getNumForces():
        bare.removeForce(0)
    reference = openmm.Platform.getPlatformByName("Reference")
    return openmm.Context(bare, openmm.VerletIntegrator(0.001), reference)
