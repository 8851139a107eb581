"""Leapfrog integration, with an optional force that varies in time, evaluated on the platform.

A leapfrog's positions are those of velocity Verlet; its velocities are half a step behind and are
brought to the time of the positions where they are asked for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import openmm

from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

# Of a driven integrator, at the time of the positions: time, course, and what follows from it.
DRIVE_VARIABLES = ("t", "now", "impulse", "work")
# And what the next interval of the work starts from.
KEPT_VARIABLES = (*DRIVE_VARIABLES, "since", "place", "count")
# Of the work's quadrature, and what is no more than a step's memory.
_INNER_VARIABLES = ("since", "place", "count", "before", "middle", "reached")
# A sum over all atoms costs a twentieth of a step without solvent.
MOST_STEPS_PER_SUM = 5


@dataclass(frozen=True)
class Bath:
    """A thermostat's temperature, and the rate at which its friction makes momentum decay."""

    temperature_K: float
    friction_per_ps: float


def leapfrog(timestep_ps: float) -> openmm.VerletIntegrator:
    """Return OpenMM's own leapfrog, on the CPU a tenth faster than a custom velocity Verlet."""
    return openmm.VerletIntegrator(timestep_ps)


def driven_leapfrog(
    timestep_ps: float,
    course: str,
    *,
    steps_per_sum: int = 1,
    bath: Bath | None = None,
    constrained: bool = False,
) -> openmm.CustomIntegrator:
    """Return a leapfrog with the forces `drive` (a per-degree-of-freedom variable) times `course`.

    `course` is an expression in the time `t` in ps that is zero at t = 0. Global variables, for
    the time of the positions: `now`, the course; `impulse`, its integral in ps, to second order in
    the timestep; `work`, what the drive has done in kJ/mol, to fourth order in the time of
    `steps_per_sum` steps, each time that so many steps are done. With a `bath`, friction and noise
    act in the middle of the drift, as in OpenMM's LangevinMiddleIntegrator (Zhang et al. 2019, J.
    Phys. Chem. A 123, 6056).
    """
    integrator = openmm.CustomIntegrator(timestep_ps)
    for name in (*DRIVE_VARIABLES, *_INNER_VARIABLES):
        integrator.addGlobalVariable(name, 0.0)
    integrator.addPerDofVariable("drive", 0.0)
    integrator.addUpdateContextState()
    integrator.beginIfBlock("t = 0")
    integrator.addComputeSum("place", "drive*x")
    integrator.endBlock()
    integrator.addComputePerDof("v", "v + dt*(f + drive*now)/m")
    if constrained:
        integrator.addConstrainVelocities()
    _drift(integrator, timestep_ps, bath)
    if constrained:
        # What the constraints move in a step belongs to the velocity.
        integrator.addPerDofVariable("free", 0.0)
        integrator.addComputePerDof("free", "x")
        integrator.addConstrainPositions()
        integrator.addComputePerDof("v", "v + (x - free)/dt")
    integrator.addComputeGlobal("t", "t + dt")
    integrator.addComputeGlobal("before", "now")
    integrator.addComputeGlobal("now", course)
    integrator.addComputeGlobal("impulse", "impulse + 0.5*dt*(before + now)")
    integrator.addComputeGlobal("count", "count + 1")
    integrator.beginIfBlock(f"count >= {steps_per_sum}")
    integrator.addComputeSum("reached", "drive*x")
    integrator.addComputeGlobal("middle", f"{course}; t = t - {0.5 * steps_per_sum}*dt")
    # The course's mean over the displacement: both of fourth order in the interval, for either
    # alone is of second.
    mean = "(8*middle - since - now)/6"
    integrator.addComputeGlobal("work", f"work + {mean}*(reached - place)")
    for name, value in (("since", "now"), ("place", "reached"), ("count", "0")):
        integrator.addComputeGlobal(name, value)
    integrator.endBlock()
    return integrator


def _drift(integrator: openmm.CustomIntegrator, timestep_ps: float, bath: Bath | None) -> None:
    if bath is None:
        integrator.addComputePerDof("x", "x + dt*v")
        return
    kept = float(np.exp(-bath.friction_per_ps * timestep_ps))
    thermal = BOLTZMANN_KJ_PER_MOL_K * bath.temperature_K * (1 - kept**2)
    integrator.addComputePerDof("x", "x + 0.5*dt*v")
    integrator.addComputePerDof("v", f"{kept!r}*v + sqrt({thermal!r}/m)*gaussian")
    integrator.addComputePerDof("x", "x + 0.5*dt*v")


def steps_per_sum(steps_per_frame: int) -> int:
    """Return how many steps lie between two sums of a drive's work: they end with every frame."""
    return max(n for n in range(1, MOST_STEPS_PER_SUM + 1) if steps_per_frame % n == 0)


def sine_course(frequency_GHz: float, ramp_ps: float = 0.0) -> str:
    """Return sin(2 pi f t), times (1 - cos(pi t/ramp))/2 while t < ramp.

    Without a ramp the force starts from zero without a jump, but its slope does not, and the
    transient is as large as the answer to the drive.
    """
    sine = f"sin({2e-3 * np.pi * frequency_GHz!r}*t)"
    if ramp_ps == 0:
        return sine
    return f"{sine}*select(step(t - {ramp_ps!r}), 1, 0.5 - 0.5*cos({np.pi / ramp_ps!r}*t))"


def gaussian_course(centre_ps: float, width_ps: float) -> str:
    """Return a Gaussian of unit height; centred five widths late it starts from 4e-6 of that."""
    return f"exp(-0.5*((t - {centre_ps!r})/{width_ps!r})^2)"
