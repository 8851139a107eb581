"""Velocity Verlet, with an optional force that varies in time, evaluated on the platform."""

from __future__ import annotations

import numpy as np
import openmm
from numpy.typing import NDArray

Array = NDArray[np.float64]


def velocity_verlet(timestep_ps: float) -> openmm.CustomIntegrator:
    """Return a velocity Verlet integrator (OpenMM's VerletIntegrator is a leapfrog).

    Positions and velocities belong to the same time, so a kick at t = 0 is exact.
    """
    integrator = openmm.CustomIntegrator(timestep_ps)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v + 0.5*dt*f/m")
    integrator.addComputePerDof("x", "x + dt*v")
    integrator.addComputePerDof("v", "v + 0.5*dt*f/m")
    return integrator


def driven_velocity_verlet(timestep_ps: float, course: str) -> openmm.CustomIntegrator:
    """Return velocity Verlet with the forces `drive` (a per-degree-of-freedom variable) times
    `course`, an expression in the time `t` in ps.

    The global variable `work` holds the work done by the drive in kJ/mol, to second order in the
    timestep.
    """
    integrator = openmm.CustomIntegrator(timestep_ps)
    for name in ("t", "now", "before", "power", "work"):
        integrator.addGlobalVariable(name, 0.0)
    integrator.addPerDofVariable("drive", 0.0)
    integrator.addUpdateContextState()
    integrator.addComputeGlobal("before", course)
    integrator.addComputePerDof("v", "v + 0.5*dt*(f + drive*before)/m")
    integrator.addComputePerDof("x", "x + dt*v")
    integrator.addComputeGlobal("t", "t + dt")
    integrator.addComputeGlobal("now", course)
    integrator.addComputeSum("power", "drive*v")
    integrator.addComputeGlobal("work", "work + 0.5*dt*(before + now)*power")
    integrator.addComputePerDof("v", "v + 0.5*dt*(f + drive*now)/m")
    return integrator


def sine_course(frequency_GHz: float) -> str:
    """Return sin(2 pi f t), which starts from zero without a jump of the force."""
    return f"sin({2e-3 * np.pi * frequency_GHz!r}*t)"


def gaussian_course(centre_ps: float, width_ps: float) -> str:
    """Return a Gaussian of unit height."""
    return f"exp(-0.5*((t - {centre_ps!r})/{width_ps!r})^2)"
