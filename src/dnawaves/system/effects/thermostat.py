"""Thermostats and friction, as integrators."""

from __future__ import annotations

import numpy as np
import openmm

from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K


def openmm_seed(seed: int) -> int:
    """Return a seed for OpenMM, which takes zero for one of its own choice."""
    return seed or 2**31 - 1


def langevin_middle(
    temperature_K: float, friction_per_ps: float, timestep_ps: float, seed: int
) -> openmm.LangevinMiddleIntegrator:
    """Return OpenMM's thermostat for equilibration and thermal runs (Zhang et al. 2019, LFMiddle).

    Its velocities are half a step behind its positions.
    """
    integrator = openmm.LangevinMiddleIntegrator(temperature_K, friction_per_ps, timestep_ps)
    integrator.setRandomNumberSeed(openmm_seed(seed))
    return integrator


def velocity_verlet_with_friction(
    timestep_ps: float, friction_per_ps: float, temperature_K: float = 0.0, seed: int = 1
) -> openmm.CustomIntegrator:
    """Return velocity Verlet between two half steps of friction and noise.

    The scheme OBABO of Bussi & Parrinello 2007 (Phys. Rev. E 75, 056707, eq 23): positions and
    velocities belong to the same time, without friction it is velocity Verlet, and at zero
    temperature there is no noise. `friction_per_ps` is the rate at which momentum decays.
    """
    integrator = openmm.CustomIntegrator(timestep_ps)
    integrator.setRandomNumberSeed(openmm_seed(seed))
    integrator.addGlobalVariable("kept", float(np.exp(-0.5 * friction_per_ps * timestep_ps)))
    integrator.addGlobalVariable("kT", BOLTZMANN_KJ_PER_MOL_K * temperature_K)
    integrator.addPerDofVariable("free", 0.0)
    ornstein_uhlenbeck = "kept*v + sqrt((1 - kept^2)*kT/m)*gaussian" if temperature_K else "kept*v"
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", ornstein_uhlenbeck)
    integrator.addConstrainVelocities()
    integrator.addComputePerDof("v", "v + 0.5*dt*f/m")
    integrator.addComputePerDof("x", "x + dt*v")
    integrator.addComputePerDof("free", "x")
    integrator.addConstrainPositions()
    # What the constraints moved in a step belongs to the velocity (RATTLE).
    integrator.addComputePerDof("v", "v + 0.5*dt*f/m + (x - free)/dt")
    integrator.addConstrainVelocities()
    integrator.addComputePerDof("v", ornstein_uhlenbeck)
    integrator.addConstrainVelocities()
    return integrator
