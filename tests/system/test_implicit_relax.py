"""A duplex in implicit solvent: its forces, a Hessian without cutoff, a true minimum, a kick."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmm
import pytest
import scipy.sparse
import xarray as xr
from numpy.typing import NDArray

from dnawaves.duplex.build import write_pdb
from dnawaves.files import read_netcdf, write_json
from dnawaves.motion.structure import inspect_structure
from dnawaves.scene.environment import Environment
from dnawaves.scene.models import NamedDuplex, SceneSpec, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import charges_e, nonbonded_force
from dnawaves.system.hessian import Hessian, ReferenceForces
from dnawaves.system.relax import read_relaxed
from dnawaves.system.steps import build_step, relax_step
from dnawaves.trajectory.steps import simulate_step

AsBuilt = Callable[..., SimulatedDuplex]
SEQUENCE = "CGCG"
AMBER = ["HarmonicAngleForce", "HarmonicBondForce", "NonbondedForce", "PeriodicTorsionForce"]


@pytest.mark.parametrize(
    ("environment", "added"),
    [
        ({}, []),
        ({"solvent": "OBC2"}, ["GBSAOBCForce"]),
        ({"solvent": "OBC2", "salt_M": 0.1}, ["CustomGBForce"]),
    ],
)
def test_each_environment_has_its_forces_and_no_other(
    as_built: AsBuilt, environment: dict[str, object], added: list[str]
) -> None:
    system = as_built(SEQUENCE, **environment).system
    assert sorted(type(force).__name__ for force in system.getForces()) == sorted(AMBER + added)
    assert system.getNumConstraints() == 0
    cut_off = nonbonded_force(system).getNonbondedMethod() != openmm.NonbondedForce.NoCutoff
    assert cut_off == (not added)


def test_phosphates_keep_their_charges(as_built: AsBuilt) -> None:
    # The System owns the force: without a name of its own it would be freed before it is read.
    system = as_built(SEQUENCE, solvent="OBC2").system
    nonbonded = nonbonded_force(system)
    # Amber's charges are written with four to six digits and 250 of them add up.
    assert sum(charges_e(nonbonded)) == pytest.approx(-(2 * len(SEQUENCE) - 2), abs=1e-4)


def test_salt_and_surface_change_the_energy_as_they_must(as_built: AsBuilt) -> None:
    def energy(**environment: object) -> float:
        duplex = as_built(SEQUENCE, solvent="OBC2", **environment)
        return ReferenceForces(duplex.system)(duplex.positions_nm)[0]

    pure = energy()
    # Salt stabilises charges; the surface costs energy.
    assert energy(salt_M=0.1) < pure < energy(surface_area=True)


def test_hessian_without_a_cutoff_is_that_with_everything_in_reach(as_built: AsBuilt) -> None:
    duplex = as_built("CGAT")
    positions = duplex.positions_nm
    extent = float(np.linalg.norm(np.ptp(positions, axis=0)))
    whole, cut = (Hessian(duplex.system, reach, 1)(positions)[0] for reach in (None, extent))
    # The same evaluations, in another order.
    np.testing.assert_allclose(whole, cut, atol=1e-9)


@dataclass(frozen=True)
class Implicit:
    """The relaxed duplex, the folder of the steps' files, and what relaxing said."""

    duplex: SimulatedDuplex
    folder: Path
    record: xr.Dataset
    hessian: NDArray[np.float64]


@pytest.fixture(scope="module")
def implicit(tmp_path_factory: pytest.TempPathFactory) -> Implicit:
    """Return four base pairs in OBC2 at their minimum, by the pipeline's own steps."""
    folder = tmp_path_factory.mktemp("implicit")
    spec = SystemSpec(
        duplex=NamedDuplex(name="four", sequence=SEQUENCE),
        environment_name="water",
        environment=Environment.model_validate(
            {"solvent": "OBC2", "relaxation": {"anneal_ps": 0.2}}
        ),
    )
    system, built, minimum, hessian = (
        folder / name for name in ("system.json", "built.pdb", "relaxed.nc", "hessian.npz")
    )
    write_json(system, spec.model_dump(mode="json"))
    build_step(system, built)
    relax_step(system, built, minimum, hessian, threads=2)
    return Implicit(
        read_relaxed(spec, built, minimum),
        folder,
        read_netcdf(minimum),
        scipy.sparse.load_npz(hessian).toarray(),
    )


def test_it_comes_to_a_true_minimum(implicit: Implicit) -> None:
    duplex = implicit.duplex
    _, force = ReferenceForces(duplex.system)(duplex.positions_nm)
    assert np.sqrt(np.mean(force**2)) <= 1e-4
    record = implicit.record
    assert (record.negative_modes, record.zero_modes) == (0, 6)
    # Nothing is out of reach: all blocks of two atoms are there.
    atoms = len(duplex.pairs)
    blocks = np.abs(implicit.hessian).reshape(atoms, 3, atoms, 3).max(axis=(1, 3))
    assert blocks.min() > 0
    # What differences over 1e-5 nm leave of elements up to 1e6.
    assert record.hessian_asymmetry_kJ_per_mol_nm2 < 0.1


def test_it_says_whether_it_is_still_b_dna(implicit: Implicit) -> None:
    pdb = implicit.folder / "relaxed.pdb"
    write_pdb(implicit.duplex.topology, implicit.duplex.positions_nm, pdb)
    found = inspect_structure(implicit.duplex, implicit.folder / "built.pdb", pdb)
    assert found.attrs["verdict"] == "B-DNA"


def test_a_kick_goes_through_it_and_keeps_its_energy(implicit: Implicit) -> None:
    scene = SceneSpec.model_validate(
        {
            "name": "kicked",
            "system": implicit.duplex.spec,
            "ends": {"first": "free", "last": "held"},
            "excitation": {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 1, "pairs": 1},
            "observation": {"duration_ps": 0.5, "interval_fs": 20, "timestep_fs": 1},
        }
    )
    folder = implicit.folder
    write_json(folder / "scene.json", scene.model_dump(mode="json"))
    files = [folder / name for name in ("scene.json", "built.pdb", "relaxed.nc")]
    simulate_step(*files, "x1", folder / "motion.nc", None, [], threads=1)
    motion = read_netcdf(folder / "motion.nc")
    energy = motion["total_energy"].sel(sign=1).values
    put_in = float(motion["difference_kinetic_energy"][0])
    # The bound for a record at T = 0.
    assert np.abs(energy - energy[0]).max() < 0.01 * put_in
    # The last pair is held: no digit of it moves but by round-off.
    assert float(abs(motion["velocity"][0, :, -1]).max()) < 1e-12
