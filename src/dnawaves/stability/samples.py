"""The small duplexes that the cases run with: built, relaxed, warmed up."""

from __future__ import annotations

from functools import cache

import numpy as np
import openmm
import scipy.sparse
import xarray as xr
from numpy.typing import NDArray

from dnawaves.scene.environment import Environment
from dnawaves.scene.models import NamedDuplex, SceneSpec, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.relax import relax
from dnawaves.system.steps import built_structure

Array = NDArray[np.float64]
HELD = {"first": "held", "last": "held"}
FREE = {"first": "free", "last": "free"}
# Long enough to leave the builder's strains, short enough for a hard case that is not about them.
ANNEAL_PS = 1.0
FRICTION_PER_PS = 5.0
TIMESTEP_PS = 0.001


def built(sequence: str, **environment: object) -> SimulatedDuplex:
    """Return a duplex as built, in an environment of these fields."""
    spec = SystemSpec(
        duplex=NamedDuplex(name="sample", sequence=sequence),
        environment_name="sample",
        environment=Environment.model_validate(environment),
    )
    return SimulatedDuplex(spec, *built_structure(spec))


@cache
def relaxed(sequence: str) -> tuple[SimulatedDuplex, xr.Dataset, scipy.sparse.csr_array]:
    """Return a duplex at its minimum without solvent, what was reached, and the Hessian."""
    start = built(sequence, relaxation={"anneal_ps": ANNEAL_PS})
    record, hessian = relax(start, 1, lambda line: None)
    return start.with_positions(record["position_nm"].values), record, hessian


def scene_of(duplex: SimulatedDuplex, excitation: object, ends: object = FREE) -> SceneSpec:
    """Return a scene in memory."""
    return SceneSpec.model_validate(
        {
            "name": "stability",
            "system": duplex.spec,
            "ends": ends,
            "excitation": excitation,
            "observation": {},
        }
    )


def context_of(
    system: openmm.System, integrator: openmm.Integrator, platform: str = "CPU"
) -> openmm.Context:
    """Return a context on one thread."""
    properties = {"Threads": "1", "DeterministicForces": "true"} if platform == "CPU" else {}
    return openmm.Context(
        system, integrator, openmm.Platform.getPlatformByName(platform), properties
    )


def settled(system: openmm.System, positions_nm: Array, iterations: int = 200) -> Array:
    """Return positions after OpenMM's minimiser: no minimum, but nothing strained either."""
    context = context_of(system, openmm.VerletIntegrator(TIMESTEP_PS))
    context.setPositions(positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 10.0, iterations)
    return np.array(context.getState(positions=True).getPositions(asNumpy=True)._value)


def warm(
    system: openmm.System, positions_nm: Array, temperature_K: float, steps: int = 2000
) -> tuple[Array, Array]:
    """Return positions and velocities of a system that a thermostat has warmed up."""
    integrator = openmm.LangevinMiddleIntegrator(temperature_K, FRICTION_PER_PS, TIMESTEP_PS)
    integrator.setRandomNumberSeed(1)
    context = context_of(system, integrator)
    context.setPositions(settled(system, positions_nm))
    context.setVelocitiesToTemperature(temperature_K, 1)
    integrator.step(steps)
    state = context.getState(positions=True, velocities=True)
    return (
        np.array(state.getPositions(asNumpy=True)._value),
        np.array(state.getVelocities(asNumpy=True)._value),
    )
