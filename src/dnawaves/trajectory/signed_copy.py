"""One copy of a duplex at its minimum or in a snapshot, kicked or driven with one sign."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import openmm
from numpy.typing import NDArray

from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import fixed_pairs, held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.constraints import refuse_constraints_on_frozen
from dnawaves.system.effects.ends import restraint
from dnawaves.trajectory.dynamics import Dynamics, Frame, Saved
from dnawaves.trajectory.integrator import integrator_of
from dnawaves.trajectory.pattern import forces_at_full_strength, kick_pattern
from dnawaves.trajectory.plan import Plan

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Injected:
    """What an excitation has put in: the drive's work (kJ/mol) and the momenta of kick and drive.

    `momenta` is momentum (Da nm/ps) and angular momentum about the origin (Da nm²/ps), (2, 3).
    """

    work_kJ_per_mol: float
    momenta: Array


class Copy:
    """One simulated copy of a duplex; held base pairs have no mass, restrained ones springs.

    Copies of one scene and `snapshot` share thermal velocities and, with a thermostat, noise.
    """

    def __init__(
        self,
        duplex: SimulatedDuplex,
        scene: SceneSpec,
        plan: Plan,
        scale: float,
        threads: int,
        platform: str = "CPU",
        snapshot: int = 0,
    ) -> None:
        excitation, atoms = scene.excitation, slice(duplex.solute)
        system = system_of(duplex, scene)
        kick, self._drive = np.zeros_like(duplex.positions_nm), None
        if isinstance(excitation, Kick | StandingWave):
            pattern = kick_pattern(excitation, scene.ends, duplex.pair_count)
            kick[atoms] = scale * pattern.velocities(duplex)
        elif isinstance(excitation, Pulse | Periodic):
            self._drive = np.zeros_like(duplex.positions_nm)
            self._drive[atoms] = scale * forces_at_full_strength(excitation, scene.ends, duplex)
        velocities = kick
        if duplex.velocities_nm_per_ps is not None:
            held = np.isin(duplex.pairs, held_pairs(scene.ends, duplex.pair_count))
            velocities = kick + duplex.velocities_nm_per_ps
            velocities[atoms][held] = 0.0
        self.dynamics = Dynamics(
            system,
            integrator_of(scene, plan),
            self._drive,
            platform=platform,
            threads=threads,
            seeds=None if scene.thermostat is None else (scene.thermostat.seed, snapshot),
        )
        self.dynamics.start(duplex.positions_nm, velocities)
        self._momenta = moments(duplex.positions_nm, duplex.masses_Da[:, None] * kick)
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


def system_of(duplex: SimulatedDuplex, scene: SceneSpec) -> openmm.System:
    """Return a copy of the System with the scene's ends held by no mass, or by springs.

    The springs are at rest where the duplex is. Raises `InputError` where a constraint would touch
    an atom that is held.
    """
    ends, pairs = scene.ends, duplex.pair_count
    held = held_pairs(ends, pairs)
    system = hold(duplex, held)
    refuse_constraints_on_frozen(system, duplex.topology)
    if ends.stiffness_pN_per_nm is not None:
        restrained = [pair for pair in fixed_pairs(ends, pairs) if pair not in held]
        springs = restraint(
            duplex.positions_nm,
            duplex.masses_Da,
            duplex.pairs,
            restrained,
            ends.stiffness_pN_per_nm,
            periodic=duplex.box_nm is not None,
        )
        springs.setName("restraint")
        system.addForce(springs)
    return system


def hold(duplex: SimulatedDuplex, held: Iterable[int]) -> openmm.System:
    """Return a copy of the System in which the atoms of the held base pairs cannot move."""
    system = copy.deepcopy(duplex.system)
    for atom in np.flatnonzero(np.isin(duplex.pairs, list(held))):
        system.setParticleMass(int(atom), 0.0)
    return system
