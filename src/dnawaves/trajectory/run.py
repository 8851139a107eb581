"""Run one member of a scene: two copies of opposite sign, in step, recorded as they go."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import unit

from dnawaves.errors import SimulationError
from dnawaves.scene.models import Kick, Periodic, Pulse, SceneSpec, StandingWave
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.pattern import forces_at_full_strength, kick_pattern
from dnawaves.trajectory.plan import PULSE_DELAY_WIDTHS, Plan
from dnawaves.trajectory.progress import progress
from dnawaves.trajectory.record import SIGNS, Recorder
from dnawaves.trajectory.verlet import (
    driven_velocity_verlet,
    gaussian_course,
    sine_course,
    velocity_verlet,
)

Array = NDArray[np.float64]
# Far beyond any velocity at T = 0: a run that gets there has exploded.
LARGEST_VELOCITY_NM_PER_PS = 50.0


class Copy:
    """One simulated copy of a duplex at T = 0, kicked or driven with one sign."""

    def __init__(
        self, duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan, scale: float, threads: int
    ) -> None:
        held = held_pairs(scene.ends, duplex.pair_count)
        self._integrator, drive = _integrator(duplex, scene, plan)
        self._context = openmm.Context(
            hold(duplex, held),
            self._integrator,
            openmm.Platform.getPlatformByName("CPU"),
            {"Threads": str(threads), "DeterministicForces": "true"},
        )
        self._context.setPositions(duplex.positions_nm)
        velocities = np.zeros_like(duplex.positions_nm)
        if isinstance(scene.excitation, Kick | StandingWave):
            kick = kick_pattern(scene.excitation, scene.ends, duplex.pair_count)
            velocities = scale * kick.velocities(duplex)
        self._context.setVelocities(velocities)
        if drive is not None:
            self._integrator.setPerDofVariableByName("drive", scale * drive)
        self._driven = drive is not None

    def step(self, steps: int) -> None:
        """Advance by a number of timesteps."""
        self._integrator.step(steps)

    def state(self) -> tuple[Array, Array, float]:
        """Return positions (nm), velocities (nm/ps), both (atoms, 3), and energy (kJ/mol)."""
        state = self._context.getState(getPositions=True, getVelocities=True, getEnergy=True)
        energy = state.getPotentialEnergy() + state.getKineticEnergy()
        return (
            np.array(state.getPositions(asNumpy=True)._value),
            np.array(state.getVelocities(asNumpy=True)._value),
            energy._value,
        )

    def velocities(self) -> Array:
        """Return the velocities (atoms, 3) in nm/ps; needs no force, unlike `state`."""
        state = self._context.getState(getVelocities=True)
        return np.array(state.getVelocities(asNumpy=True)._value)

    @property
    def time_ps(self) -> float:
        """Simulated time."""
        return self._context.getTime().value_in_unit(unit.picosecond)

    @property
    def work_kJ_per_mol(self) -> float:
        """Work that the drive has done."""
        return self._integrator.getGlobalVariableByName("work") if self._driven else 0.0


def run_member(
    duplex: SimulatedDuplex,
    scene: SceneSpec,
    plan: Plan,
    member: str,
    trajectories: dict[int, Path],
    threads: int = 1,
) -> Recorder:
    """Simulate one member and return what was recorded.

    `trajectories` maps a sign to the file that its base atoms go to; empty for none.

    Raises
    ------
    SimulationError
        When a copy's velocities are not finite or have exploded; names the time and the atom.
    """
    signs = tuple(SIGNS[name] for name in scene.signs)
    scale = float(member[1:]) if isinstance(scene.excitation, Kick | StandingWave) else 1.0
    copies = [Copy(duplex, scene, plan, sign * scale, threads) for sign in signs]
    title = f"{scene.name} {member}"
    total_ps = plan.steps * plan.timestep_ps * len(copies)
    recorder = Recorder(duplex, scene, plan, signs)
    with recorder.writing(trajectories), progress(title, total_ps) as advance:
        for frame in range(plan.frames):
            if frame:
                for one in copies:
                    try:
                        one.step(plan.steps_per_frame)
                    except openmm.OpenMMException:
                        # OpenMM stops at a NaN and names neither the time nor the atom.
                        _check(duplex, one.velocities(), one.time_ps, title)
                        raise
                advance(frame * plan.interval_ps * len(copies))
            states = [one.state() for one in copies]
            for _, velocities, _ in states:
                _check(duplex, velocities, frame * plan.interval_ps, title)
            recorder.add(states, [one.work_kJ_per_mol for one in copies])
    return recorder


def hold(duplex: SimulatedDuplex, held: list[int]) -> openmm.System:
    """Return a copy of the System in which the atoms of the held base pairs cannot move."""
    system = copy.deepcopy(duplex.system)
    for atom in np.flatnonzero(np.isin(duplex.pairs, held)):
        system.setParticleMass(int(atom), 0.0)
    return system


def _integrator(
    duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan
) -> tuple[openmm.CustomIntegrator, Array | None]:
    excitation = scene.excitation
    if not isinstance(excitation, Pulse | Periodic):
        return velocity_verlet(plan.timestep_ps), None
    if isinstance(excitation, Periodic):
        assert plan.frequency_GHz is not None
        course = sine_course(plan.frequency_GHz)
    else:
        assert plan.pulse_width_ps is not None
        course = gaussian_course(PULSE_DELAY_WIDTHS * plan.pulse_width_ps, plan.pulse_width_ps)
    forces = forces_at_full_strength(excitation, scene.ends, duplex)
    return driven_velocity_verlet(plan.timestep_ps, course), forces


def _check(duplex: SimulatedDuplex, velocities: Array, time_ps: float, title: str) -> None:
    speeds = np.linalg.norm(velocities, axis=1)
    # The fastest atom, or the first whose velocity is not a number.
    worst = int(np.argmax(speeds))
    if not speeds[worst] < LARGEST_VELOCITY_NM_PER_PS:
        atom = list(duplex.topology.atoms())[worst]
        raise SimulationError(
            f"{title}: at {time_ps:.3f} ps atom {worst} ({atom.residue.chain.id}:"
            f"{atom.residue.id} {atom.name}) moves at {speeds[worst]:g} nm/ps"
        )
