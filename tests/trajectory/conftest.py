"""Scenes of the relaxed duplex, made in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import openmm
import pytest

from dnawaves.files import write_json
from dnawaves.scene.models import Environment, NamedDuplex, SceneSpec, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.snapshots import read_equilibrated
from dnawaves.system.steps import build_step, equilibrate_step

FREE = {"first": "free", "last": "free"}
HELD = {"first": "held", "last": "held"}
AMPLITUDES = {
    "extension": {"velocity_A_per_ps": 0.2},
    "shear": {"velocity_A_per_ps": 0.2},
    "twist": {"angular_velocity_rad_per_ps": 0.02},
    "bend": {"angular_velocity_rad_per_ps": 0.02},
}


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., SceneSpec]:
    """Return a function of a duplex, an excitation, the ends and the observation's fields."""

    def make(
        duplex: SimulatedDuplex,
        excitation: Mapping[str, Any],
        ends: Mapping[str, Any] = FREE,
        thermostat: Mapping[str, Any] | None = None,
        **observation: Any,
    ) -> SceneSpec:
        return SceneSpec.model_validate(
            {
                "name": "test",
                "system": duplex.spec,
                "ends": ends,
                "excitation": excitation,
                "observation": observation,
                "thermostat": thermostat,
            }
        )

    return make


@pytest.fixture(scope="session")
def make_kick() -> Callable[..., dict[str, Any]]:
    """Return a function of a wave: the excitation of a kick, 0.2 Å/ps or 0.02 rad/ps."""

    def make(wave: str, **fields: Any) -> dict[str, Any]:
        return {"kind": "kick", "wave": wave, "pairs": 2, **AMPLITUDES[wave], **fields}

    return make


@pytest.fixture(scope="session")
def near_minimum(as_built: Callable[..., SimulatedDuplex]) -> Callable[..., SimulatedDuplex]:
    """Return a function of a sequence: the duplex as built after some minimisation.

    Its other arguments are the tolerance in kJ/mol/nm and the most iterations.
    """

    def make(sequence: str, tolerance: float, iterations: int) -> SimulatedDuplex:
        built = as_built(sequence)
        context = openmm.Context(
            built.system,
            openmm.VerletIntegrator(0.001),
            openmm.Platform.getPlatformByName("CPU"),
            {"Threads": "1"},
        )
        context.setPositions(built.positions_nm)
        openmm.LocalEnergyMinimizer.minimize(context, tolerance, iterations)
        positions = context.getState(positions=True).getPositions(asNumpy=True)._value
        return built.with_positions(np.array(positions))

    return make


@dataclass(frozen=True)
class Snapshots:
    """A system above 0 K after a very short equilibration: the files of the steps that made it."""

    spec: SystemSpec
    built_file: Path
    equilibrated_file: Path

    def __getitem__(self, number: int) -> SimulatedDuplex:
        """Return the system in a snapshot, from 1."""
        return read_equilibrated(self.spec, self.built_file, self.equilibrated_file, number)


@pytest.fixture(scope="session")
def equilibrated(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Snapshots]:
    """Return a function of a sequence and an environment's fields: two snapshots at 300 K."""
    known: dict[str, Snapshots] = {}

    def make(sequence: str = "CGCG", **environment: Any) -> Snapshots:
        short = {"duration_ps": 0.4, "timestep_fs": 1, "snapshots": 2, "spacing_ps": 0.1}
        short |= environment.pop("equilibration", {})
        spec = SystemSpec(
            duplex=NamedDuplex(name="small", sequence=sequence),
            environment_name="warm",
            environment=Environment.model_validate(
                {"temperature_K": 300, "equilibration": short, **environment}
            ),
        )
        name = spec.model_dump_json()
        if name not in known:
            folder = tmp_path_factory.mktemp("equilibrated")
            files = [folder / file for file in ("system.json", "built.pdb", "equilibrated.nc")]
            write_json(files[0], spec.model_dump(mode="json"))
            build_step(files[0], files[1])
            equilibrate_step(*files, threads=1)
            known[name] = Snapshots(spec, *files[1:])
        return known[name]

    return make
