"""A run that explodes stops at once, and says at which step, which atoms and by which forces."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmm
from numpy.typing import NDArray

from dnawaves.errors import SimulationError
from dnawaves.files import write_text
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.dynamics import Frame, Saved
from dnawaves.trajectory.signed_copy import Copy, Injected

Array = NDArray[np.float64]
# Far beyond any velocity at T = 0, and twenty times a hydrogen's at 300 K: it has exploded.
LARGEST_VELOCITY_NM_PER_PS = 50.0
ATOMS_NAMED = 3


@dataclass(frozen=True)
class Guard:
    """Watches one run; the last good state of one that explodes goes to the file `kept`."""

    duplex: SimulatedDuplex
    title: str
    kept: Path | None

    def advance(self, one: Copy, good: Saved | None, steps: int) -> tuple[Frame, Injected]:
        """Advance a copy by `steps` timesteps from the saved moment `good` and return the frame.

        Raises `SimulationError` where it explodes. OpenMM stops only at a coordinate that is not a
        number, and names neither the step nor the atom.
        """
        cause = None
        try:
            one.step(steps)
            frame, injected = one.frame()
            velocities = frame.velocities_nm_per_ps
            if not exploded(velocities):
                return frame, injected
        except openmm.OpenMMException as error:
            velocities = one.dynamics.late_velocities()
            if good is None or not exploded(velocities):
                raise
            cause = error
        if good is None:
            worst = self._worst(velocities, frame.forces)
            raise SimulationError(f"{self.title}: at the start {worst}")
        raise self._explain(one, good, steps, velocities) from cause

    def _explain(self, one: Copy, good: Saved, steps: int, seen: Array) -> SimulationError:
        """Return the error, after doing the steps since the last frame again one by one.

        With other noise than before it may not explode again: then by the velocities that were
        `seen` at the end of those steps.
        """
        dynamics = one.dynamics
        dynamics.restore(good)
        for _ in range(steps):
            frame = dynamics.frame()
            dynamics.step(1)
            velocities = dynamics.late_velocities()
            if exploded(velocities):
                where = f"in step {frame.saved.state.getStepCount() + 1}"
                break
        else:
            dynamics.restore(good)
            frame, velocities, where = dynamics.frame(), seen, f"within {steps} steps"
        state = frame.saved.state
        worst = self._worst(velocities, frame.forces)
        message = f"{self.title}: after {state.getTime()._value:.3f} ps, {where}, {worst}"
        if self.kept is not None:
            write_text(self.kept, openmm.XmlSerializer.serialize(state))
            message += f"; the last good state is in {self.kept}"
        return SimulationError(message)

    def _worst(self, velocities_nm_per_ps: Array, forces: Array) -> str:
        speeds = np.linalg.norm(velocities_nm_per_ps, axis=1)
        # What is not a number comes first.
        order = np.argsort(-np.nan_to_num(speeds, nan=np.inf), kind="stable")[:ATOMS_NAMED]
        atoms = list(self.duplex.topology.atoms())
        return ", ".join(
            f"atom {index} ({atoms[index].residue.chain.id}:{atoms[index].residue.id} "
            f"{atoms[index].name}) moves at {speeds[index]:.3g} nm/ps under a force of "
            f"{np.linalg.norm(forces[index]):.3g} kJ/mol/nm"
            for index in order
        )


def exploded(velocities_nm_per_ps: Array) -> bool:
    """Return whether an atom's velocity is not a number or beyond any that makes sense."""
    speeds = np.linalg.norm(velocities_nm_per_ps, axis=1)
    return not speeds.max() < LARGEST_VELOCITY_NM_PER_PS
