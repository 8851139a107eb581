"""From the built duplex to snapshots of thermal equilibrium, ends free, that scenes start from.

A local minimisation, velocities drawn at the temperature, then Langevin dynamics. A barostat acts
in the first half of the time before the first snapshot; from then on the box is fixed, so that the
second half, in which the run checks itself, is the ensemble of the snapshots.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmm
import xarray as xr
from numpy.typing import NDArray
from openmm import unit

from dnawaves.errors import SimulationError
from dnawaves.files import digest, provenance
from dnawaves.scene.environment import Equilibration
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.barostat import STEPS_PER_ATTEMPT, barostat
from dnawaves.system.effects.constraints import degrees_of_freedom
from dnawaves.system.effects.thermostat import langevin_middle
from dnawaves.system.equilibration_record import Record, load_record
from dnawaves.system.equilibrium_file import equilibrium_dataset
from dnawaves.system.geometry import sugar_anchors
from dnawaves.system.saving import parts_between_checkpoints
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

Array = NDArray[np.float64]
Report = Callable[[str], None]

# A sample costs an evaluation of the energy, a 25th of the steps between two.
STEPS_PER_SAMPLE = 25
# OpenMM's own tolerance: only to part atoms that lie too near; the dynamics does the rest.
MINIMISE_TOLERANCE_KJ_PER_MOL_NM, MINIMISE_ITERATIONS = 10.0, 500
# Kinetic energy, over that of the thermostat, at which a run has exploded. Of f degrees of freedom
# it fluctuates by √(2/f), some percent.
EXPLODED = 10.0


@dataclass(frozen=True)
class Course:
    """An equilibration in samples: where the barostat ends, the first snapshot, the last."""

    half: int
    first: int
    spacing: int
    snapshots: int

    @property
    def last(self) -> int:
        """Number of samples in all."""
        return self.first + (self.snapshots - 1) * self.spacing

    def is_snapshot(self, sample: int) -> bool:
        """Return whether a snapshot is taken at a sample, counted from 1."""
        return sample >= self.first and (sample - self.first) % self.spacing == 0


def course_of(equilibration: Equilibration) -> Course:
    """Return the course; times are rounded up to whole samples."""
    sample_fs = STEPS_PER_SAMPLE * equilibration.timestep_fs
    first, spacing = (
        max(1, int(np.ceil(1e3 * time_ps / sample_fs - 1e-9)))
        for time_ps in (equilibration.duration_ps, equilibration.spacing_ps)
    )
    return Course(first // 2, first, spacing, equilibration.snapshots)


def equilibrate(
    built: SimulatedDuplex,
    threads: int,
    report: Report,
    checkpoint: Path | None = None,
    samples_per_piece: int | None = None,
) -> xr.Dataset:
    """Return the snapshots, the mean structure and what the run says about itself.

    The run is cut into pieces of `samples_per_piece` samples, left out: by the size of the system.
    With a file `checkpoint` a killed run goes on from the last piece and, on one thread, ends as it
    would have ended, to the last digit; the caller removes the file once the result is on disk.

    Raises
    ------
    SimulationError
        When the run explodes; says when.
    """
    equilibration = built.spec.environment.to_snapshots
    course = course_of(equilibration)
    piece = samples_per_piece or parts_between_checkpoints(
        built.spec.environment, built.topology.getNumAtoms(), STEPS_PER_SAMPLE
    )
    run = _run(built, piece, threads)
    record = load_record(checkpoint, run) if checkpoint else None
    if record is None:
        record = _start(built, threads, report)
    else:
        report(f"goes on after {_time_ps(equilibration, len(record.samples)):.2f} ps")
    while (done := len(record.samples)) < course.last:
        pressed = equilibration.pressure_bar is not None and done < course.half
        until = min(done + piece - done % piece, course.half if pressed else course.last)
        _advance(built, record, course, until, pressed, threads)
        if checkpoint:
            record.save(checkpoint, run)
        report(
            f"{_time_ps(equilibration, until):.2f} of "
            f"{_time_ps(equilibration, course.last):.2f} ps, {record.samples[-1][0]:.0f} K"
        )
    return equilibrium_dataset(
        built,
        record,
        slice(course.half, course.first),
        _time_ps(equilibration, 1),
        degrees_of_freedom(built.system),
    )


def _start(built: SimulatedDuplex, threads: int, report: Report) -> Record:
    """Return the record at time zero: minimised, with velocities drawn at the temperature."""
    environment = built.spec.environment
    context, _ = _context(built, built.system, 0, threads)
    context.setPositions(built.positions_nm)
    openmm.LocalEnergyMinimizer.minimize(
        context, MINIMISE_TOLERANCE_KJ_PER_MOL_NM, MINIMISE_ITERATIONS
    )
    context.setVelocitiesToTemperature(
        environment.temperature_K, _seed(environment.to_snapshots.seed, 0)
    )
    state = context.getState(positions=True, velocities=True, energy=True)
    report(f"minimised: {state.getPotentialEnergy()._value:.1f} kJ/mol")
    return Record(_moment(state), np.array([]) if built.box_nm is None else built.box_nm)


def _advance(
    built: SimulatedDuplex, record: Record, course: Course, until: int, pressed: bool, threads: int
) -> None:
    """Take the record on to `until` samples, in a context of its own.

    Forces are summed in the order of a list of neighbours, that depends on the past, and the noise
    is OpenMM's own: a context that is made anew, with a seed for this piece, depends on neither.
    """
    environment = built.spec.environment
    equilibration, target_K = environment.to_snapshots, environment.temperature_K
    done = len(record.samples)
    system = built.system
    if pressed:
        assert equilibration.pressure_bar is not None
        system = copy.deepcopy(system)
        system.addForce(
            barostat(
                target_K,
                _seed(equilibration.seed, done + 1, 1),
                along_axis=True,
                pressure_bar=equilibration.pressure_bar,
                steps_per_attempt=STEPS_PER_ATTEMPT,
            )
        )
    context, integrator = _context(built, system, done + 1, threads)
    if record.box_nm.size:
        context.setPeriodicBoxVectors(*np.diag(record.box_nm))
    context.setPositions(record.moment[0])
    context.setVelocities(record.moment[1])
    masses, anchors = built.masses_Da, sugar_anchors(built.topology)
    freedom = degrees_of_freedom(system)
    for sample in range(done + 1, until + 1):
        try:
            integrator.step(STEPS_PER_SAMPLE)
        except openmm.OpenMMException as error:
            raise _stopped(equilibration, sample, str(error)) from error
        state = context.getState(positions=True, velocities=True, energy=True)
        record.moment = _moment(state)
        places, velocities = record.moment
        twice_kinetic = float(masses @ np.sum(velocities**2, axis=1))
        temperature_K = twice_kinetic / (freedom * BOLTZMANN_KJ_PER_MOL_K)
        if not temperature_K < EXPLODED * target_K:
            raise _stopped(equilibration, sample, f"it exploded to {temperature_K:.3g} K")
        if record.box_nm.size:
            record.box_nm = np.diag(state.getPeriodicBoxVectors(asNumpy=True)._value).copy()
        ends = places[anchors].mean(axis=0)[[0, -1]]
        record.samples.append(
            np.array(
                [
                    temperature_K,
                    state.getPotentialEnergy()._value,
                    np.linalg.norm(ends[1] - ends[0]),
                    record.box_nm.prod() if record.box_nm.size else np.nan,
                ]
            )
        )
        if course.half < sample <= course.first:
            record.average(places[: built.solute], masses[: built.solute])
        if course.is_snapshot(sample):
            record.snapshots.append(np.array([places, _synchronised(context, masses)]))
            record.boxes.append(record.box_nm)


def _synchronised(context: openmm.Context, masses_Da: Array) -> Array:
    """Return the velocities at the time of the positions; the integrator's are half a step late.

    They keep the constraints. The context is left as it was.
    """
    state = context.getState(velocities=True, forces=True)
    late = np.array(state.getVelocities(asNumpy=True)._value)
    forces = state.getForces(asNumpy=True)._value
    half_ps = 0.5 * context.getIntegrator().getStepSize().value_in_unit(unit.picosecond)
    # What has no mass is a site of a water model, that follows its atoms.
    kick = np.divide(half_ps, masses_Da, out=np.zeros_like(masses_Da), where=masses_Da > 0)
    context.setVelocities(late + kick[:, None] * forces)
    context.applyVelocityConstraints(1e-6)
    now = context.getState(velocities=True).getVelocities(asNumpy=True)._value
    context.setVelocities(late)
    return np.array(now)


def _context(
    built: SimulatedDuplex, system: openmm.System, piece: int, threads: int
) -> tuple[openmm.Context, openmm.Integrator]:
    environment = built.spec.environment
    equilibration = environment.to_snapshots
    integrator = langevin_middle(
        environment.temperature_K,
        equilibration.friction_per_ps,
        equilibration.timestep_fs / 1e3,
        _seed(equilibration.seed, piece),
    )
    context = openmm.Context(
        system,
        integrator,
        openmm.Platform.getPlatformByName("CPU"),
        {"Threads": str(threads), "DeterministicForces": "true"},
    )
    return context, integrator


def _seed(*numbers: int) -> int:
    """Return a seed that depends on all numbers; OpenMM takes zero for a seed of its own choice."""
    return 1 + int(np.random.SeedSequence(numbers).generate_state(1)[0]) % (2**31 - 2)


def _moment(state: openmm.State) -> Array:
    return np.array(
        [state.getPositions(asNumpy=True)._value, state.getVelocities(asNumpy=True)._value]
    )


def _time_ps(equilibration: Equilibration, samples: int) -> float:
    return samples * STEPS_PER_SAMPLE * equilibration.timestep_fs / 1e3


def _stopped(equilibration: Equilibration, sample: int, found: str) -> SimulationError:
    before, at = (_time_ps(equilibration, which) for which in (sample - 1, sample))
    return SimulationError(
        f"equilibration: stopped between {before:.3f} and {at:.3f} ps: {found}; "
        "a smaller equilibration.timestep_fs may help"
    )


def _run(built: SimulatedDuplex, piece: int, threads: int) -> str:
    """Return what defines a run, by nothing that another machine would round differently."""
    return json.dumps(
        {
            "spec": built.spec.model_dump_json(),
            "positions": digest(built.positions_nm.tobytes()),
            "system": digest(openmm.XmlSerializer.serialize(built.system)),
            "samples_per_piece": piece,
            "threads": threads,
            **provenance("openmm", "numpy"),
        }
    )
