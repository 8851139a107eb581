"""The barostat: an ideal gas has its volume, and frozen atoms are moved, so they are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import openmm
import pytest

from dnawaves.errors import InputError
from dnawaves.system.effects.barostat import barostat, refuse_barostat_on_frozen
from dnawaves.system.effects.thermostat import langevin_middle
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

PARTICLES, TEMPERATURE_K = 64, 300.0
# 1 bar in kJ/mol/nm³.
BAR = 1e5 * 1e-27 / 1e3 * 6.02214076e23
BOX_nm = 3.0
IDEAL_PRESSURE_bar = (PARTICLES + 1) * BOLTZMANN_KJ_PER_MOL_K * TEMPERATURE_K / BOX_nm**3 / BAR


def gas(bodies: Any, *, along_axis: bool, frozen: int = 0) -> openmm.System:
    nonbonded = openmm.NonbondedForce()
    nonbonded.setNonbondedMethod(openmm.NonbondedForce.CutoffPeriodic)
    nonbonded.setCutoffDistance(0.5)
    for _ in range(PARTICLES):
        nonbonded.addParticle(0, 0.1, 0)
    masses = np.where(np.arange(PARTICLES) < frozen, 0.0, 40.0)
    system = bodies(
        masses,
        nonbonded,
        barostat(
            TEMPERATURE_K,
            2,
            along_axis=along_axis,
            pressure_bar=IDEAL_PRESSURE_bar,
            steps_per_attempt=1,
        ),
    )
    system.setDefaultPeriodicBoxVectors(*(BOX_nm * np.eye(3)))
    return system


def start(system: openmm.System) -> tuple[openmm.Context, openmm.Integrator, np.ndarray]:
    integrator = langevin_middle(TEMPERATURE_K, 1.0, 0.002, 1)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
    place = np.random.default_rng(1).uniform(-1.5, 1.5, (PARTICLES, 3))
    context.setPositions(place)
    return context, integrator, place


@pytest.mark.parametrize("along_axis", [True, False])
def test_an_ideal_gas_has_its_volume(bodies: Any, along_axis: bool) -> None:
    context, integrator, _ = start(gas(bodies, along_axis=along_axis))
    integrator.step(1000)
    volumes, lengths = [], []
    for _ in range(3000):
        integrator.step(1)
        box = context.getState().getPeriodicBoxVectors(asNumpy=True)._value
        volumes.append(np.prod(np.diag(box)))
        lengths.append(np.diag(box))
    # <V> = (N + 1) kT/P. sd V/sqrt(N) = 12 %, a move each step of some 10 % of that: a few hundred
    # independent volumes, 0.8 %.
    assert np.mean(volumes) == pytest.approx(BOX_nm**3, rel=0.04)
    x, y, z = np.transpose(lengths)
    assert np.std(x) > 0.01
    # One scale for the sides; the length follows it or is kept for restrained ends.
    np.testing.assert_allclose(x, y, rtol=1e-12)
    np.testing.assert_allclose(z, x if along_axis else BOX_nm, rtol=1e-12)


def test_a_molecule_at_the_origin_stays_there(bodies: Any) -> None:
    system = gas(bodies, along_axis=True)
    integrator = openmm.VerletIntegrator(1e-9)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
    place = np.random.default_rng(1).uniform(-1.5, 1.5, (PARTICLES, 3))
    place[0] = 0
    context.setPositions(place)
    integrator.step(20)
    state = context.getState(getPositions=True)
    after = state.getPositions(asNumpy=True)._value
    scale = state.getPeriodicBoxVectors(asNumpy=True)._value[0, 0] / BOX_nm
    assert abs(scale - 1) > 1e-3
    # All places are scaled about the origin, also negative ones. Nothing moves in 2e-8 ps.
    np.testing.assert_allclose(after, scale * place, atol=1e-6)
    np.testing.assert_allclose(after[0], 0, atol=1e-6)


def test_frozen_atoms_would_be_moved_and_are_refused(bodies: Any) -> None:
    system = gas(bodies, along_axis=True, frozen=2)
    context, integrator, place = start(system)
    integrator.step(20)
    after = context.getState(getPositions=True).getPositions(asNumpy=True)._value
    assert np.abs(after[:2] - place[:2]).max() > 1e-3
    with pytest.raises(InputError, match="found 2 frozen atoms"):
        refuse_barostat_on_frozen(system)
    refuse_barostat_on_frozen(gas(bodies, along_axis=True))
