"""Fixtures that several test folders share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse
import xarray as xr
from numpy.typing import NDArray

from dnawaves.duplex.build import build_duplex
from dnawaves.files import read_netcdf, write_json
from dnawaves.scene.models import Environment, NamedDuplex, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import load_force_field
from dnawaves.system.relax import read_relaxed
from dnawaves.system.steps import build_step, relax_step


@pytest.fixture(scope="session")
def shared() -> Path:
    """Return the folder of reference tables that lies beside a developer's checkout."""
    folder = Path(__file__).resolve().parents[2] / "shared"
    if not folder.is_dir():
        pytest.skip("the reference tables (folder 'shared' beside the checkout) are not here")
    return folder


def system_spec(sequence: str, **environment: object) -> SystemSpec:
    return SystemSpec(
        duplex=NamedDuplex(name="small", sequence=sequence),
        environment_name="condensed",
        environment=Environment.model_validate(environment),
    )


@pytest.fixture(scope="session")
def as_built() -> Callable[..., SimulatedDuplex]:
    """Return a function of a sequence and an environment's fields: the duplex as built."""

    def build(sequence: str, **environment: object) -> SimulatedDuplex:
        spec = system_spec(sequence, **environment)
        return SimulatedDuplex(spec, *build_duplex(sequence, load_force_field(spec.environment)))

    return build


@dataclass(frozen=True)
class Relaxed:
    """A small duplex at its minimum, and the files of the steps that made it."""

    duplex: SimulatedDuplex
    record: xr.Dataset
    hessian: NDArray[np.float64]
    built_file: Path
    relaxed_file: Path
    hessian_file: Path


@pytest.fixture(scope="session")
def relaxed(tmp_path_factory: pytest.TempPathFactory) -> Relaxed:
    """Return six base pairs, built and relaxed by the pipeline's own steps: some ten seconds."""
    folder = tmp_path_factory.mktemp("relaxed")
    system, built, minimum, hessian = (
        folder / name for name in ("system.json", "built.pdb", "relaxed.nc", "hessian.npz")
    )
    spec = system_spec("CGATCG", relaxation={"anneal_ps": 1})
    write_json(system, spec.model_dump(mode="json"))
    build_step(system, built)
    relax_step(system, built, minimum, hessian, threads=2)
    return Relaxed(
        read_relaxed(spec, built, minimum),
        read_netcdf(minimum),
        scipy.sparse.load_npz(hessian).toarray(),
        built,
        minimum,
        hessian,
    )
