"""A System in motion: positions and velocities of the same time, saved and taken up again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import unit

from dnawaves.trajectory.verlet import DRIVE_VARIABLES

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Saved:
    """A moment to go on from: OpenMM's State and the global variables of a driven integrator."""

    state: openmm.State
    variables: dict[str, float]


@dataclass(frozen=True)
class Frame:
    """Positions (nm), velocities (nm/ps) and forces (kJ/mol/nm), (atoms, 3), and energy (kJ/mol).

    `saved` holds the same moment for `Dynamics.restore`.
    """

    positions_nm: Array
    velocities_nm_per_ps: Array
    forces: Array
    energy_kJ_per_mol: float
    saved: Saved


class Dynamics:
    """A System on a platform, integrated by a leapfrog without constraints.

    `drive` (atoms, 3) in kJ/mol/nm goes with the integrator of `verlet.driven_leapfrog`.
    """

    def __init__(
        self,
        system: openmm.System,
        integrator: openmm.Integrator,
        drive: Array | None = None,
        platform: str = "CPU",
        threads: int = 1,
    ) -> None:
        properties = {"Threads": str(threads), "DeterministicForces": "true"}
        self._integrator, self._drive = integrator, drive
        self._context = openmm.Context(
            system,
            integrator,
            openmm.Platform.getPlatformByName(platform),
            properties if platform == "CPU" else {},
        )
        count = system.getNumParticles()
        self._masses = np.array([system.getParticleMass(i)._value for i in range(count)])[:, None]
        half_ps = 0.5 * integrator.getStepSize().value_in_unit(unit.picosecond)
        # What has no mass is held.
        self._half = np.divide(
            half_ps, self._masses, out=np.zeros_like(self._masses), where=self._masses > 0
        )

    def start(self, positions_nm: Array, velocities_nm_per_ps: Array) -> None:
        """Set positions and velocities at t = 0."""
        self._context.setPositions(positions_nm)
        self._set_drive()
        forces = self._context.getState(forces=True).getForces(asNumpy=True)._value
        self._context.setVelocities(velocities_nm_per_ps - self._half * forces)

    def step(self, steps: int) -> None:
        """Advance by a number of timesteps."""
        self._integrator.step(steps)

    def frame(self) -> Frame:
        """Return what there is now; costs one evaluation of forces and energy."""
        state = self._context.getState(positions=True, velocities=True, forces=True, energy=True)
        forces = np.array(state.getForces(asNumpy=True)._value)
        variables = {}
        if self._drive is not None:
            variables = {name: self.drive_variable(name) for name in DRIVE_VARIABLES}
            forces += variables["now"] * self._drive
        late = np.array(state.getVelocities(asNumpy=True)._value)
        velocities = late + self._half * forces
        return Frame(
            np.array(state.getPositions(asNumpy=True)._value),
            velocities,
            forces,
            state.getPotentialEnergy()._value + 0.5 * float(np.sum(self._masses * velocities**2)),
            Saved(state, variables),
        )

    def late_velocities(self) -> Array:
        """Return the leapfrog's own velocities, half a step late; needs no force."""
        state = self._context.getState(velocities=True)
        return np.array(state.getVelocities(asNumpy=True)._value)

    def restore(self, saved: Saved) -> None:
        """Go on from a saved moment, as if nothing had been before.

        The order in which forces are summed depends on the list of neighbours, and that on the
        past. A context that is made anew has none, so that a run that is killed and taken up here
        equals one that goes on from here, to the last digit on one thread.
        """
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
