"""Ends held by very soft and very stiff springs, and ends frozen together with constraints."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import openmm
import yaml

from dnawaves.errors import SimulationError
from dnawaves.scene.load import load_scenes
from dnawaves.stability.case import Found
from dnawaves.stability.judge import stopped
from dnawaves.stability.samples import built, context_of, relaxed, scene_of
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.constraints import refuse_constraints_on_frozen
from dnawaves.system.effects.ends import restraint
from dnawaves.trajectory.guard import exploded
from dnawaves.trajectory.signed_copy import hold
from dnawaves.trajectory.verlet import leapfrog
from dnawaves.units import PN_PER_KJ_PER_MOL_NM

SEQUENCE = "CGCG"
SHIFT_NM = 0.001
SAMPLES = 400


def spring(stiffness_pN_per_nm: float, timestep_fs: float, duration_ps: float) -> Found:
    """Return the measured frequency of a restrained end over sqrt(K/M), from its first crossing.

    The first base pair starts beside its place by a hundredth of an ångström. Where it does not
    oscillate, because the duplex is stiffer than the spring, its largest distance, of the first.
    """
    duplex, _, _ = relaxed(SEQUENCE)
    held = duplex.pairs == 0
    mass_Da = float(duplex.masses_Da[held].sum())
    omega = np.sqrt(stiffness_pN_per_nm / PN_PER_KJ_PER_MOL_NM / mass_Da)
    positions = duplex.positions_nm + SHIFT_NM * np.outer(held, duplex.frame.axis)
    integrator = leapfrog(timestep_fs * 1e-3)
    context = context_of(_restrained(duplex, stiffness_pN_per_nm), integrator)
    context.setPositions(positions)
    context.setVelocitiesToTemperature(0)
    steps = max(1, round(duration_ps / (timestep_fs * 1e-3) / SAMPLES))
    shifts, energies = [], []
    for _ in range(SAMPLES):
        state = context.getState(positions=True, energy=True, velocities=True)
        if exploded(np.array(state.getVelocities(asNumpy=True)._value)):
            raise SimulationError(f"the end on springs exploded after {state.getTime()}")
        place = np.array(state.getPositions(asNumpy=True)._value)[held]
        moved = duplex.masses_Da[held] @ (place - duplex.positions_nm[held]) / mass_Da
        shifts.append(float(moved @ duplex.frame.axis))
        energies.append(state.getPotentialEnergy()._value + state.getKineticEnergy()._value)
        integrator.step(steps)
    interval_ps = steps * timestep_fs * 1e-3
    remark = f"omega dt {omega * timestep_fs * 1e-3:.2g}, period {2 * np.pi / omega:.3g} ps"
    spread = np.ptp(energies) / (0.5 * mass_Da * (omega * SHIFT_NM) ** 2)
    signs = np.flatnonzero(np.diff(np.sign(shifts)))
    periods = (len(signs) - 1) / 2
    if periods < 2:
        wander = float(np.abs(shifts).max() / SHIFT_NM)
        return Found("holds", wander, f"{remark}; no oscillation of its own")
    measured = 2 * np.pi * periods / ((signs[-1] - signs[0]) * interval_ps)
    return Found(
        "holds", float(measured / omega), f"{remark}; {periods:.0f} periods, energy to {spread:.1e}"
    )


def spring_beyond_the_timestep(omega_dt: float, timestep_fs: float) -> Found:
    """Return how a spring with omega dt beyond 2 is stopped where nothing refuses it before."""
    duplex, _, _ = relaxed(SEQUENCE)
    mass_Da = float(duplex.masses_Da[duplex.pairs == 0].sum())
    stiffness = mass_Da * (omega_dt / (timestep_fs * 1e-3)) ** 2 * PN_PER_KJ_PER_MOL_NM
    return stopped(lambda: spring(stiffness, timestep_fs, 0.5), "exploded")


def stiffness_refused(stiffness_pN_per_nm: float) -> Found:
    """Return how a scene with springs too stiff for any timestep is refused: field and limit."""
    duplex = built(SEQUENCE)
    ends = {
        "first": "restrained",
        "last": "free",
        "stiffness_pN_per_nm": stiffness_pN_per_nm,
    }
    return stopped(
        lambda: scene_of(duplex, {"kind": "none"}, ends), "stiffness_pN_per_nm", "less than"
    )


def frozen_with_constraints() -> Found:
    """Return how a file with frozen ends and constraints is refused: which of the two it names."""
    content = {
        "structures": "structures.yaml",
        "environments": {"warm": {"temperature_K": 300, "constraints": "hbonds"}},
        "scenes": {
            "one": {
                "duplex": "small",
                "environment": "warm",
                "ends": {"first": "free", "last": "held"},
                "excitation": {"kind": "none"},
            }
        },
    }
    with TemporaryDirectory() as folder:
        config = Path(folder, "config.yaml")
        config.write_text(yaml.safe_dump(content), encoding="utf-8")
        Path(folder, "structures.yaml").write_text(f"small: {SEQUENCE}\n", encoding="utf-8")
        return stopped(lambda: load_scenes(config), "constraints hbonds", "frozen base pairs 4")


def frozen_system_with_constraints() -> Found:
    """Return how a System with frozen ends and constraints is refused: does it name the atoms."""
    duplex = built(SEQUENCE, temperature_K=300, constraints="hbonds")
    return stopped(
        lambda: refuse_constraints_on_frozen(hold(duplex, [0]), duplex.topology),
        r"A:1:\S+ and A:1:\S+",
        "constraints",
        "frozen",
    )


def _restrained(duplex: SimulatedDuplex, stiffness_pN_per_nm: float) -> openmm.System:
    system = hold(duplex, [])
    system.addForce(
        restraint(duplex.positions_nm, duplex.masses_Da, duplex.pairs, [0], stiffness_pN_per_nm)
    )
    return system
