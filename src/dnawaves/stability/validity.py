"""Is the ensemble what it says: the checks of the package physical_validation.

Merz & Shirts 2018, PLoS ONE 13, e0202764.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import openmm
import physical_validation as pv
from numpy.typing import NDArray

from dnawaves.stability.case import Found
from dnawaves.stability.nve import SEQUENCE, energies
from dnawaves.stability.samples import built, context_of, warm
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.thermostat import langevin_middle, velocity_verlet_with_friction
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

Array = NDArray[np.float64]
# Temperature, friction, timestep and seed to an integrator.
SCHEMES: Mapping[str, Callable[[float, float, float, int], openmm.Integrator]] = {
    "Langevin middle": langevin_middle,
    "velocity Verlet with friction": lambda kelvin, friction, dt, seed: (
        velocity_verlet_with_friction(dt, friction, kelvin, seed)
    ),
}
TIMESTEP_PS = 0.001
SEED = 1


def kinetic_energy(
    scheme: str, temperature_K: float, friction_per_ps: float, samples: int, spacing_steps: int
) -> Found:
    """Return how many standard errors mean and width of the kinetic energy lie beside theory."""
    data = _sampled(built(SEQUENCE), scheme, temperature_K, friction_per_ps, samples, spacing_steps)
    probability = pv.kinetic_energy.distribution(
        data, strict=True, verbosity=0, data_is_uncorrelated=True
    )
    return Found(
        "holds",
        off_theory(data),
        f"Kolmogorov-Smirnov test of the whole distribution: p = {probability:.2f}",
    )


def ensemble(
    temperatures_K: Sequence[float], friction_per_ps: float, samples: int, spacing_steps: int
) -> Found:
    """Return how many standard errors the ratio of two potential-energy distributions is off.

    Of two temperatures, ln P1(U)/P2(U) is a line in U with the slope 1/kT2 - 1/kT1 (Shirts 2013,
    J. Chem. Theory Comput. 9, 909).
    """
    duplex = built(SEQUENCE)
    data = [
        _sampled(duplex, "Langevin middle", one, friction_per_ps, samples, spacing_steps)
        for one in temperatures_K
    ]
    (quantiles,) = pv.ensemble.check(*data, verbosity=0, bootstrap_seed=1)
    return Found("holds", float(abs(quantiles)), f"{samples} samples at each temperature")


def convergence(timesteps_fs: Sequence[float], duration_ps: float, temperature_K: float) -> Found:
    """Return how far ratios of energy fluctuations are from those of squared timesteps."""
    duplex = built(SEQUENCE)
    start = warm(duplex.system, duplex.positions_nm, temperature_K)
    data = []
    for timestep_fs in timesteps_fs:
        total = energies(duplex, start, "leapfrog", timestep_fs * 1e-3, duration_ps).total
        observed = pv.data.ObservableData(constant_of_motion=total)
        data.append(pv.data.SimulationData(dt=timestep_fs * 1e-3, observables=observed))
    return Found("holds", float(pv.integrator.convergence(data, verbose=False)))


def _sampled(
    duplex: SimulatedDuplex,
    scheme: str,
    temperature_K: float,
    friction_per_ps: float,
    samples: int,
    spacing_steps: int,
) -> pv.data.SimulationData:
    """Return kinetic and potential energies of a thermostatted duplex."""
    integrator = SCHEMES[scheme](temperature_K, friction_per_ps, TIMESTEP_PS, SEED)
    context = context_of(duplex.system, integrator)
    positions, velocities = warm(duplex.system, duplex.positions_nm, temperature_K)
    context.setPositions(positions)
    context.setVelocities(velocities)
    kinetic, potential = np.empty(samples), np.empty(samples)
    for sample in range(samples):
        integrator.step(spacing_steps)
        state = context.getState(energy=True)
        kinetic[sample] = state.getKineticEnergy()._value
        potential[sample] = state.getPotentialEnergy()._value
    return simulation_data(len(duplex.pairs), temperature_K, kinetic, potential)


def simulation_data(
    atoms: int, temperature_K: float, kinetic: Array, potential: Array
) -> pv.data.SimulationData:
    """Return energies (samples,) in kJ/mol of free atoms as physical_validation takes them."""
    return pv.data.SimulationData(
        units=pv.data.UnitData(BOLTZMANN_KJ_PER_MOL_K, 1, 1, 1, 1, 1, 1, "kJ/mol", time_str="ps"),
        dt=TIMESTEP_PS,
        system=pv.data.SystemData(
            natoms=atoms, nconstraints=0, ndof_reduction_tra=0, ndof_reduction_rot=0
        ),
        ensemble=pv.data.EnsembleData("NVT", natoms=atoms, volume=1.0, temperature=temperature_K),
        observables=pv.data.ObservableData(kinetic_energy=kinetic, potential_energy=potential),
    )


def off_theory(data: pv.data.SimulationData) -> float:
    """Return mean and width of the kinetic energy beside theory, the larger, in standard errors."""
    mean, width = pv.kinetic_energy.distribution(
        data, verbosity=0, bootstrap_seed=1, data_is_uncorrelated=True
    )
    return float(max(abs(mean), abs(width)))
