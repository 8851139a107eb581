"""What each effect of a system costs per step, measured by leaving it out.

The table (CSV) has one row for each effect that the system has, or that its scenes may add:

- `system`: name of the system;
- `effect`: bonded, nonbonded (direct space where there is PME), PME reciprocal, implicit solvent,
  constraints (bonds to hydrogen; rigid water stays), thermostat (above 0 K), restraint (springs on
  both end pairs), drive (periodic, with its work), or the class of another Force;
- `ms_per_step_without`: time of a step without the effect, median of the repeats;
- `ms_per_step_whole`: the same with it, timed in turn with the former;
- `ms_saved`: median of the differences of neighbouring timings, whole less without;
- `low`, `high`: 96 % interval of that median, by the order of the differences (sign test).

Forces are left out while all atoms stand still, as a molecule without bonds would not stay one; so
neighbour lists, which moving atoms wear out, are not built anew. The rest is left out while the
atoms move. Times are processor times of one thread on the CPU platform: other work on the machine
costs them little.
"""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import openmm
import pandas as pd
from numpy.typing import NDArray

from dnawaves.files import whole_file
from dnawaves.scene.load import read_system
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.ends import restraint
from dnawaves.system.effects.thermostat import langevin_middle
from dnawaves.system.relax import read_relaxed
from dnawaves.system.snapshots import read_equilibrated
from dnawaves.trajectory.verlet import MOST_STEPS_PER_SUM, driven_leapfrog, leapfrog, sine_course

Array = NDArray[np.float64]

TIMESTEP_PS = 0.002
# Atoms move by less than the last digit of their places.
STILL_PS = 1e-12
REPEATS = 12
# Of 12 differences the third lowest and third highest hold the median with 96.1 %.
LEFT_OUT_AT_EITHER_END = 2
TIMING_S = 0.15
# Of effects that scenes may add: what they cost does not depend on these.
FREQUENCY_GHz = 100.0
STIFFNESS_PN_PER_NM = 1000.0
FRICTION_PER_PS = 1.0

BONDED = ("HarmonicBondForce", "HarmonicAngleForce", "PeriodicTorsionForce", "CMAPTorsionForce")
EFFECTS = dict.fromkeys(BONDED, "bonded") | {
    "NonbondedForce": "nonbonded",
    "GBSAOBCForce": "implicit solvent",
    "CustomGBForce": "implicit solvent",
}
MESH = "PME reciprocal"


@dataclass(frozen=True)
class Variant:
    """A System with its integrator; `groups` are the forces that act, all by default."""

    system: openmm.System
    integrator: openmm.Integrator
    groups: frozenset[int] | None = None


class Probe:
    """A variant that steps, and the time it takes."""

    def __init__(self, variant: Variant, duplex: SimulatedDuplex) -> None:
        if variant.groups is not None:
            variant.integrator.setIntegrationForceGroups(set(variant.groups))
        self._integrator = variant.integrator
        self._context = openmm.Context(
            variant.system,
            variant.integrator,
            openmm.Platform.getPlatformByName("CPU"),
            {"Threads": "1"},
        )
        self._context.setPositions(duplex.positions_nm)
        if duplex.velocities_nm_per_ps is not None:
            self._context.setVelocities(duplex.velocities_nm_per_ps)
        self._integrator.step(2)  # sets up what is reused

    def step_ms(self, steps: int) -> float:
        """Return the time of one step, from several."""
        started = time.process_time()
        self._integrator.step(steps)
        return 1e3 * (time.process_time() - started) / steps


def costs_step(
    system_json: Path, built: Path, start: Path, output: Path, timing_s: float = TIMING_S
) -> None:
    """Write the table of a system; `start` is its minimum, or its snapshots above 0 K."""
    spec = read_system(system_json)
    if spec.thermal:
        duplex = read_equilibrated(spec, built, start, snapshot=1)
    else:
        duplex = read_relaxed(spec, built, start)
    table = costs(duplex, timing_s)
    with whole_file(output) as temporary:
        table.to_csv(temporary, index=False, float_format="%.5g")


def costs(duplex: SimulatedDuplex, timing_s: float = TIMING_S) -> pd.DataFrame:
    """Return what each effect costs per step, with the columns that this module lists."""
    rows = []
    for effect, whole, without in effects_of(duplex):
        probes = [Probe(variant, duplex) for variant in (without, whole)]
        steps = max(2, int(timing_s / (1e-3 * probes[1].step_ms(2))))
        without_ms, whole_ms = timings(*(partial(probe.step_ms, steps) for probe in probes))
        saved = np.sort(whole_ms - without_ms)
        rows.append(
            {
                "system": duplex.spec.name,
                "effect": effect,
                "ms_per_step_without": np.median(without_ms),
                "ms_per_step_whole": np.median(whole_ms),
                "ms_saved": np.median(saved),
                "low": saved[LEFT_OUT_AT_EITHER_END],
                "high": saved[-1 - LEFT_OUT_AT_EITHER_END],
            }
        )
    return pd.DataFrame(rows)


def timings(first: Callable[[], float], second: Callable[[], float]) -> tuple[Array, Array]:
    """Return `REPEATS` timings of each of two, in turn; every other turn in the opposite order.

    So a machine that gets slower all the while falsifies no median of their differences.
    """
    pairs = []
    for turn in range(REPEATS):
        if turn % 2:
            later = second()
            pairs.append((first(), later))
        else:
            pairs.append((first(), second()))
    one, other = np.array(pairs).T
    return one, other


def effects_of(duplex: SimulatedDuplex) -> Iterator[tuple[str, Variant, Variant]]:
    """Yield each effect with the variants that have it and that do not."""
    yield from _forces(duplex)
    environment = duplex.spec.environment
    system = duplex.system
    if environment.constraints != "none":
        free = environment.model_copy(update={"constraints": "none"})
        other = replace(duplex, spec=duplex.spec.model_copy(update={"environment": free}))
        yield "constraints", _moving(system), _moving(other.system)
    if duplex.spec.thermal:
        thermostat = langevin_middle(environment.temperature_K, FRICTION_PER_PS, TIMESTEP_PS, 1)
        yield "thermostat", Variant(system, thermostat), _moving(system)
    yield "restraint", _moving(_with_springs(duplex)), _moving(system)
    drive = driven_leapfrog(
        TIMESTEP_PS,
        sine_course(FREQUENCY_GHz),
        steps_per_sum=MOST_STEPS_PER_SUM,
        constrained=system.getNumConstraints() > 0,
    )
    yield "drive", Variant(system, drive), _moving(system)


def _moving(system: openmm.System) -> Variant:
    return Variant(system, leapfrog(TIMESTEP_PS))


def _forces(duplex: SimulatedDuplex) -> Iterator[tuple[str, Variant, Variant]]:
    """Yield the variants of each kind of Force, by the groups that the integrator takes."""
    system = copy.deepcopy(duplex.system)
    effects: list[str] = []

    def group_of(effect: str) -> int:
        if effect not in effects:
            effects.append(effect)
        return effects.index(effect)

    for force in system.getForces():
        name = type(force).__name__
        force.setForceGroup(group_of(EFFECTS.get(name, name)))
        if isinstance(force, openmm.NonbondedForce) and force.getNonbondedMethod() in (
            openmm.NonbondedForce.PME,
            openmm.NonbondedForce.LJPME,
        ):
            force.setReciprocalSpaceForceGroup(group_of(MESH))
    everything = frozenset(range(len(effects)))
    for group, effect in enumerate(effects):
        whole, without = (
            Variant(system, leapfrog(STILL_PS), groups)
            for groups in (everything, everything - {group})
        )
        yield effect, whole, without


def _with_springs(duplex: SimulatedDuplex) -> openmm.System:
    system = copy.deepcopy(duplex.system)
    force = restraint(
        duplex.positions_nm[: duplex.solute],
        duplex.masses_Da[: duplex.solute],
        duplex.pairs,
        (0, duplex.pair_count - 1),
        STIFFNESS_PN_PER_NM,
        periodic=duplex.box_nm is not None,
    )
    system.addForce(force)
    return system
