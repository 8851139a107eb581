"""What an effect costs: what is left out is that effect, and the table says what it saved."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import openmm
import pandas as pd
import pytest
from scipy.stats import binom

from dnawaves.files import write_json
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory import costs as costs_module
from dnawaves.trajectory.costs import (
    LEFT_OUT_AT_EITHER_END,
    REPEATS,
    Variant,
    costs_step,
    effects_of,
    timings,
)

COLUMNS = [
    "system",
    "effect",
    "ms_per_step_without",
    "ms_per_step_whole",
    "ms_saved",
    "low",
    "high",
]
COLD = ["bonded", "nonbonded", "restraint", "drive"]


def energy(variant: Variant, duplex: SimulatedDuplex, kinds: tuple[str, ...] = ()) -> float:
    """Return the energy of the groups that a variant integrates; of some kinds of Force alone."""
    groups = variant.groups or frozenset(range(32))
    if kinds:
        groups = frozenset(
            force.getForceGroup()
            for force in variant.system.getForces()
            if type(force).__name__ in kinds
        )
    context = openmm.Context(
        variant.system,
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("Reference"),
    )
    context.setPositions(duplex.positions_nm)
    state = context.getState(energy=True, groups=set(groups))
    return float(state.getPotentialEnergy()._value)


@pytest.mark.parametrize(
    ("environment", "effects"),
    [
        ({}, COLD),
        ({"solvent": "OBC2"}, ["bonded", "nonbonded", "implicit solvent", *COLD[2:]]),
        (
            {"solvent": "OBC2", "temperature_K": 300, "constraints": "hbonds"},
            ["bonded", "nonbonded", "implicit solvent", "constraints", "thermostat", *COLD[2:]],
        ),
    ],
)
def test_each_effect_that_a_system_has_is_left_out_once(
    as_built: Callable[..., SimulatedDuplex], environment: dict[str, Any], effects: list[str]
) -> None:
    assert [effect for effect, *_ in effects_of(as_built("CGCG", **environment))] == effects


def test_a_force_that_is_left_out_takes_its_own_energy_along(
    as_built: Callable[..., SimulatedDuplex],
) -> None:
    duplex = as_built("CGCG", solvent="OBC2")
    kinds = {
        "bonded": ("HarmonicBondForce", "HarmonicAngleForce", "PeriodicTorsionForce"),
        "nonbonded": ("NonbondedForce",),
        "implicit solvent": ("GBSAOBCForce",),
    }
    total = 0.0
    for effect, whole, without in effects_of(duplex):
        if effect in kinds:
            own = energy(whole, duplex, kinds[effect])
            total += own
            # Sums in double precision of energies of up to 1e5 kJ/mol.
            assert energy(whole, duplex) - energy(without, duplex) == pytest.approx(own, abs=1e-6)
    assert total == pytest.approx(energy(Variant(duplex.system, None), duplex), abs=1e-6)  # type: ignore[arg-type]


def test_springs_and_constraints_are_in_one_variant_alone(
    as_built: Callable[..., SimulatedDuplex],
) -> None:
    duplex = as_built("CGCG", temperature_K=300, constraints="hbonds")
    found = {effect: (whole, without) for effect, whole, without in effects_of(duplex)}
    whole, without = found["restraint"]
    assert whole.system.getNumForces() == without.system.getNumForces() + 1
    whole, without = found["constraints"]
    hydrogens = sum(atom.element.symbol == "H" for atom in duplex.topology.atoms())
    assert (whole.system.getNumConstraints(), without.system.getNumConstraints()) == (hydrogens, 0)
    # A drive that ignored them would tear the bonds.
    driven = found["drive"][0].integrator
    steps = [driven.getComputationStep(index)[0] for index in range(driven.getNumComputations())]
    assert openmm.CustomIntegrator.ConstrainPositions in steps


def test_the_table_of_a_system(relaxed: Any, tmp_path: Path) -> None:
    system, output = tmp_path / "system.json", tmp_path / "costs.csv"
    write_json(system, relaxed.duplex.spec.model_dump(mode="json"))
    costs_step(system, relaxed.built_file, relaxed.relaxed_file, output, timing_s=0.01)
    table = pd.read_csv(output)
    assert list(table.columns) == COLUMNS
    assert list(table["effect"]) == COLD
    assert set(table["system"]) == {"small-condensed"}
    assert (table[["ms_per_step_without", "ms_per_step_whole"]] > 0).all(axis=None)
    assert (table["low"] <= table["ms_saved"]).all() and (table["ms_saved"] <= table["high"]).all()


class Priced:
    """A probe whose clock shows the price of what its variant has, instead of a time."""

    FORCES_MS: ClassVar = {
        "HarmonicBondForce": 0.01,
        "HarmonicAngleForce": 0.02,
        "PeriodicTorsionForce": 0.04,
        "NonbondedForce": 0.5,
        "CustomExternalForce": 0.08,
    }
    INTEGRATORS_MS: ClassVar = {"VerletIntegrator": 0.001, "CustomIntegrator": 0.03}

    def __init__(self, variant: Variant, duplex: SimulatedDuplex) -> None:
        acting = [
            force
            for force in variant.system.getForces()
            if variant.groups is None or force.getForceGroup() in variant.groups
        ]
        self.price_ms = sum(self.FORCES_MS[type(force).__name__] for force in acting)
        self.price_ms += self.INTEGRATORS_MS[type(variant.integrator).__name__]

    def step_ms(self, steps: int) -> float:
        return self.price_ms


def test_each_row_is_the_price_of_its_effect(
    as_built: Callable[..., SimulatedDuplex], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(costs_module, "Probe", Priced)
    table = costs_module.costs(as_built("CGCG")).set_index("effect")
    prices = {"bonded": 0.07, "nonbonded": 0.5, "restraint": 0.08, "drive": 0.029}
    for column in ("ms_saved", "low", "high"):
        assert table[column].to_dict() == pytest.approx(prices, rel=1e-9)


def test_a_machine_that_gets_slower_falsifies_no_difference() -> None:
    clock = count(1)
    # Each timing takes 1 ms more than the last; the second of the two 5 ms more than the first.
    first, second = timings(lambda: float(next(clock)), lambda: 5.0 + next(clock))
    assert len(first) == len(second) == REPEATS
    # Drift adds 1 ms or takes it, in turn.
    assert sorted(second - first) == [4] * (REPEATS // 2) + [6] * (REPEATS // 2)
    assert np.median(second - first) == 5


def test_the_interval_holds_the_median_as_often_as_it_says() -> None:
    # The k-th lowest and highest of n draws miss the median where fewer than k lie on one side.
    missed = 2 * binom.cdf(LEFT_OUT_AT_EITHER_END, REPEATS, 0.5)
    assert 1 - missed == pytest.approx(0.961, abs=1e-3)
