"""One copy of a duplex at T = 0, kicked or driven with one sign."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import openmm
from numpy.typing import NDArray

from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.dynamics import Dynamics, Frame, Saved
from dnawaves.trajectory.pattern import forces_at_full_strength, kick_pattern
from dnawaves.trajectory.plan import PULSE_DELAY_WIDTHS, Plan
from dnawaves.trajectory.verlet import driven_leapfrog, gaussian_course, leapfrog, sine_course

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Injected:
    """What an excitation has put in: the drive's work (kJ/mol) and the momenta of kick and drive.

    `momenta` is momentum (Da nm/ps) and angular momentum about the origin (Da nm²/ps), (2, 3).
    """

    work_kJ_per_mol: float
    momenta: Array


class Copy:
    """One simulated copy of a duplex; held base pairs have no mass."""

    def __init__(
        self, duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan, scale: float, threads: int
    ) -> None:
        excitation = scene.excitation
        velocities = np.zeros_like(duplex.positions_nm)
        self._drive: Array | None = None
        if isinstance(excitation, Kick | StandingWave):
            kick = kick_pattern(excitation, scene.ends, duplex.pair_count)
            velocities = scale * kick.velocities(duplex)
        elif isinstance(excitation, Pulse | Periodic):
            self._drive = scale * forces_at_full_strength(excitation, scene.ends, duplex)
        self.dynamics = Dynamics(
            hold(duplex, held_pairs(scene.ends, duplex.pair_count)),
            integrator_of(excitation, plan),
            self._drive,
            threads=threads,
        )
        self.dynamics.start(duplex.positions_nm, velocities)
        self._momenta = moments(duplex.positions_nm, duplex.masses_Da[:, None] * velocities)
        self._impulse_ps, self._load = 0.0, self._load_on(duplex.positions_nm)

    def step(self, steps: int) -> None:
        """Advance by a number of timesteps."""
        self.dynamics.step(steps)

    def frame(self) -> tuple[Frame, Injected]:
        """Return what there is now and what has been put in so far."""
        frame = self.dynamics.frame()
        if self._drive is None:
            return frame, Injected(0.0, self._momenta)
        impulse_ps = frame.saved.variables["impulse"]
        load = self._load_on(frame.positions_nm)
        # The torque changes as the pairs that it acts on move: slowly, so once a frame is enough.
        self._momenta = self._momenta + 0.5 * (load + self._load) * (impulse_ps - self._impulse_ps)
        self._impulse_ps, self._load = impulse_ps, load
        return frame, Injected(frame.saved.variables["work"], self._momenta)

    def state(self) -> tuple[Array, Array, float]:
        """Return positions (nm), velocities (nm/ps), both (atoms, 3), and energy (kJ/mol)."""
        frame, _ = self.frame()
        return frame.positions_nm, frame.velocities_nm_per_ps, frame.energy_kJ_per_mol

    def restore(self, saved: Saved, momenta: Array) -> None:
        """Go on from a saved moment, at which `momenta` had been put in."""
        self.dynamics.restore(saved)
        self._momenta = np.array(momenta)
        if self._drive is not None:
            self._impulse_ps = saved.variables["impulse"]
            self._load = self._load_on(np.array(saved.state.getPositions(asNumpy=True)._value))

    def _load_on(self, positions_nm: Array) -> Array:
        return np.zeros((2, 3)) if self._drive is None else moments(positions_nm, self._drive)


def moments(positions_nm: Array, vectors: Array) -> Array:
    """Return the sum of vectors (atoms, 3) and of their moments about the origin, (2, 3)."""
    return np.array([vectors.sum(axis=0), np.cross(positions_nm, vectors).sum(axis=0)])


def hold(duplex: SimulatedDuplex, held: list[int]) -> openmm.System:
    """Return a copy of the System in which the atoms of the held base pairs cannot move."""
    system = copy.deepcopy(duplex.system)
    for atom in np.flatnonzero(np.isin(duplex.pairs, held)):
        system.setParticleMass(int(atom), 0.0)
    return system


def integrator_of(excitation: object, plan: Plan) -> openmm.Integrator:
    """Return the integrator that an excitation needs."""
    if isinstance(excitation, Periodic):
        assert plan.frequency_GHz is not None
        return driven_leapfrog(plan.timestep_ps, sine_course(plan.frequency_GHz, plan.ramp_ps))
    if isinstance(excitation, Pulse):
        assert plan.pulse_width_ps is not None
        width_ps = plan.pulse_width_ps
        return driven_leapfrog(
            plan.timestep_ps, gaussian_course(PULSE_DELAY_WIDTHS * width_ps, width_ps)
        )
    return leapfrog(plan.timestep_ps)
