"""Leapfrog integration, with an optional force that varies in time, evaluated on the platform.

A leapfrog's positions are those of velocity Verlet; its velocities are half a step behind and are
brought to the time of the positions where they are asked for.
"""

from __future__ import annotations

import numpy as np
import openmm

# Of a driven integrator, at the time of the positions: time, course, and what follows from it.
DRIVE_VARIABLES = ("t", "now", "impulse", "work")


def leapfrog(timestep_ps: float) -> openmm.VerletIntegrator:
    """Return OpenMM's own leapfrog, on the CPU a tenth faster than a custom velocity Verlet."""
    return openmm.VerletIntegrator(timestep_ps)


def driven_leapfrog(timestep_ps: float, course: str) -> openmm.CustomIntegrator:
    """Return a leapfrog with the forces `drive` (a per-degree-of-freedom variable) times `course`.

    `course` is an expression in the time `t` in ps that is zero at t = 0. Global variables, for
    the time of the positions and to second order in the timestep: `now`, the course; `impulse`,
    its integral in ps; `work`, what the drive has done in kJ/mol.
    """
    integrator = openmm.CustomIntegrator(timestep_ps)
    for name in (*DRIVE_VARIABLES, "before", "power"):
        integrator.addGlobalVariable(name, 0.0)
    integrator.addPerDofVariable("drive", 0.0)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v + dt*(f + drive*now)/m")
    integrator.addComputePerDof("x", "x + dt*v")
    integrator.addComputeGlobal("t", "t + dt")
    integrator.addComputeGlobal("before", "now")
    integrator.addComputeGlobal("now", course)
    integrator.addComputeSum("power", "drive*v")
    integrator.addComputeGlobal("impulse", "impulse + 0.5*dt*(before + now)")
    integrator.addComputeGlobal("work", "work + 0.5*dt*(before + now)*power")
    return integrator


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
