"""From the built duplex to a true minimum in its own environment."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import openmm
import scipy.sparse
import xarray as xr
from numpy.typing import NDArray
from openmm import unit
from scipy.linalg import eigh

from dnawaves.errors import SimulationError
from dnawaves.files import provenance
from dnawaves.scene.environment import Relaxation
from dnawaves.scene.models import SystemSpec
from dnawaves.system.clash import nearest_atoms
from dnawaves.system.duplex import SimulatedDuplex, read_built, read_result
from dnawaves.system.effects.start import turned
from dnawaves.system.effects.thermostat import openmm_seed
from dnawaves.system.guided import first_estimates_A_per_ps
from dnawaves.system.hessian import Hessian, ReferenceForces
from dnawaves.system.instability import Instability, instability
from dnawaves.system.minimum import Minimum, NoMinimumError, minimise
from dnawaves.system.modes import EIGENVALUE_TOLERANCE_PER_PS2, RIGID_MODES

Array = NDArray[np.float64]
Report = Callable[[str], None]

ANNEAL_TIMESTEP_PS = 0.002
ANNEAL_FRICTION_PER_PS = 5.0
ANNEAL_STAGES = 40
SADDLES_ALLOWED = 5
SADDLE_STEP_NM = 0.002
WHAT_TO_DO = "Raise relaxation.cycles, or take another relaxation.seed or anneal_ps"


def relax(
    built: SimulatedDuplex, threads: int, report: Report
) -> tuple[xr.Dataset, scipy.sparse.csr_array]:
    """Anneal, minimise and check that no mode is unstable.

    Returns a dataset with `position_nm` (atom, xyz), `lowest_eigenvalue_per_ps2` (mode) and, as
    attributes, what was reached and the first estimates of the speeds; and the Hessian at the
    minimum (3 atoms, 3 atoms) in kJ/mol/nm².

    Raises
    ------
    SimulationError
        When no minimum without negative modes is found.
    """
    relaxation = built.spec.environment.to_minimum
    positions = anneal(started(built), relaxation, report)
    forces = ReferenceForces(built.system)
    differentiate = Hessian(built.system, built.spec.environment.cutoff_nm, threads)
    report(differentiate.price(positions))

    def evaluate(x: Array) -> tuple[float, Array]:
        energy, force = forces(x.reshape(-1, 3))
        return energy, force.ravel()

    def modes_at(positions: Array) -> tuple[Array, float, Array, Array, Instability]:
        hessian, asymmetry = differentiate(positions)
        values, vectors = lowest_modes(hessian, built.masses_Da, 4 * RIGID_MODES)
        unstable = instability(
            values, vectors, built.masses_Da, built.with_positions(positions).bodies
        )
        return hessian, asymmetry, values, vectors, unstable

    for _ in range(SADDLES_ALLOWED + 1):
        try:
            minimum = minimise(
                evaluate,
                lambda x: differentiate(x.reshape(-1, 3))[0],
                positions.ravel(),
                relaxation.force_tolerance_kJ_per_mol_nm,
                cycles=relaxation.cycles,
                report=report,
            )
        except NoMinimumError as error:
            unstable = modes_at(error.coordinates_nm.reshape(-1, 3))[-1]
            raise SimulationError(f"{error}; {unstable}. {WHAT_TO_DO}") from None
        positions = minimum.coordinates_nm.reshape(-1, 3)
        hessian, asymmetry, values, vectors, unstable = modes_at(positions)
        report(f"lowest eigenvalues, ps^-2: {np.array2string(values[:8], precision=4)}")
        if not unstable.modes:
            relaxed = built.with_positions(positions)
            dataset = _dataset(relaxed, minimum, values, asymmetry, hessian)
            return dataset, scipy.sparse.csr_array(hessian)
        step = vectors[:, 0].reshape(-1, 3) / np.sqrt(built.masses_Da)[:, None]
        positions = positions + SADDLE_STEP_NM * step / np.abs(step).max()
    raise SimulationError(
        f"still a saddle point after {SADDLES_ALLOWED} descents: {unstable}. {WHAT_TO_DO}"
    )


def started(built: SimulatedDuplex) -> SimulatedDuplex:
    """Return the duplex bent or overtwisted as its environment says, or as built."""
    start = built.spec.environment.to_minimum.start
    if start is None:
        return built
    first, second, axis = built.frame.directions
    angle = np.deg2rad(start.direction_deg)
    across = np.cos(angle) * first + np.sin(angle) * second
    rotation = np.deg2rad(start.twist_deg) * axis + np.deg2rad(start.bend_deg) * across
    positions = turned(
        built.positions_nm, built.pairs, built.pivots_nm, start.first - 1, start.last - 1, rotation
    )
    return built.with_positions(positions)


def anneal(built: SimulatedDuplex, relaxation: Relaxation, report: Report) -> Array:
    """Return positions after a short minimisation and a linear anneal to zero temperature.

    One thread and deterministic forces: the structure found must not depend on the cores at hand.

    Raises
    ------
    SimulationError
        When it explodes, as it does where atoms lie upon each other; names the nearest two.
    """
    try:
        return _annealed(built, relaxation, report)
    except openmm.OpenMMException as error:
        # OpenMM names neither the atoms nor the step.
        cause = str(error).split(".")[0]
        nearest = nearest_atoms(built.topology, built.positions_nm)
        raise SimulationError(
            f"the anneal exploded: {cause}; at its start the nearest atoms are {nearest}"
        ) from error


def _annealed(built: SimulatedDuplex, relaxation: Relaxation, report: Report) -> Array:
    integrator = openmm.LangevinMiddleIntegrator(
        relaxation.anneal_temperature_K, ANNEAL_FRICTION_PER_PS, ANNEAL_TIMESTEP_PS
    )
    integrator.setRandomNumberSeed(openmm_seed(relaxation.seed))
    context = openmm.Context(
        built.system,
        integrator,
        openmm.Platform.getPlatformByName("CPU"),
        {"Threads": "1", "DeterministicForces": "true"},
    )
    context.setPositions(built.positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 10.0, 500)
    context.setVelocitiesToTemperature(relaxation.anneal_temperature_K, relaxation.seed)
    steps = round(relaxation.anneal_ps / ANNEAL_TIMESTEP_PS)
    for stage in range(ANNEAL_STAGES):
        integrator.setTemperature(relaxation.anneal_temperature_K * (1 - stage / ANNEAL_STAGES))
        integrator.step(steps * (stage + 1) // ANNEAL_STAGES - steps * stage // ANNEAL_STAGES)
        if (stage + 1) % (ANNEAL_STAGES // 4) == 0:
            report(f"anneal: {(stage + 1) / ANNEAL_STAGES:.0%} of {relaxation.anneal_ps:g} ps")
    # Close enough to the minimum for the Hessian to be worth its price.
    openmm.LocalEnergyMinimizer.minimize(context, 0.1, 3000)
    state = context.getState(getPositions=True, getEnergy=True)
    energy = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    report(f"annealed: {energy:.1f} kJ/mol")
    positions: Array = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    if not np.isfinite(positions).all():
        raise SimulationError("the anneal gave positions that are not numbers")
    return np.array(positions)


def lowest_modes(hessian: Array, masses_Da: Array, count: int) -> tuple[Array, Array]:
    """Return the `count` lowest eigenvalues (ps⁻²) and vectors of the mass-weighted Hessian."""
    weights = np.repeat(1 / np.sqrt(masses_Da), 3)
    weighted = hessian * weights * weights[:, None]
    values, vectors = eigh(
        weighted, subset_by_index=[0, count - 1], overwrite_a=True, check_finite=False
    )
    return values, vectors


def read_relaxed(spec: SystemSpec, built: Path, relaxed: Path) -> SimulatedDuplex:
    """Return the duplex at the minimum that `dnawaves relax` wrote for the same system.

    Raises `InputError` where the minimum belongs to another duplex or environment.
    """
    dataset = read_result(spec, relaxed, "minimum", "position_nm")
    return read_built(spec, built).with_positions(dataset["position_nm"].values)


def _dataset(
    relaxed: SimulatedDuplex, minimum: Minimum, values: Array, asymmetry: float, hessian: Array
) -> xr.Dataset:
    estimates = first_estimates_A_per_ps(relaxed, hessian)
    return xr.Dataset(
        {
            "position_nm": (("atom", "xyz"), relaxed.positions_nm, {"units": "nm"}),
            "lowest_eigenvalue_per_ps2": (("mode",), values, {"units": "ps-2"}),
        },
        coords={"xyz": ["x", "y", "z"]},
        attrs={
            "energy_kJ_per_mol": minimum.energy_kJ_per_mol,
            "rms_force_kJ_per_mol_nm": minimum.rms_force_kJ_per_mol_nm,
            "force_evaluations": minimum.evaluations,
            "hessian_asymmetry_kJ_per_mol_nm2": asymmetry,
            "negative_modes": int(np.sum(values < -EIGENVALUE_TOLERANCE_PER_PS2)),
            "zero_modes": int(np.sum(np.abs(values) <= EIGENVALUE_TOLERANCE_PER_PS2)),
            "eigenvalue_tolerance_per_ps2": EIGENVALUE_TOLERANCE_PER_PS2,
            **{f"first_estimate_{wave}_A_per_ps": v for wave, v in estimates.items()},
            "spec": relaxed.spec.model_dump_json(),
            **provenance("openmm", "numpy", "scipy"),
        },
    )
