"""Ten base pairs in explicit water, from the sequence to the waves, by the workflow's steps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mdtraj
import numpy as np
import openmm
import pytest
import xarray as xr

from dnawaves.files import read_netcdf, write_json
from dnawaves.motion.fields import wave_fields
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.dynamics import Saved
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.record import base_atoms
from dnawaves.trajectory.signed_copy import Copy
from dnawaves.trajectory.steps import simulate_step

SEQUENCE = "CGATCAGTCG"
ENVIRONMENT = {
    "solvent": "TIP3P",
    "constraints": "hbonds",
    "water": {"padding_nm": 0.3},
    # Hard on the velocities, as there is no time.
    "equilibration": {"duration_ps": 0.3, "friction_per_ps": 20.0},
}
STIFFNESS_PN_PER_NM = 4e5
ENDS = {"first": "free", "last": "restrained", "stiffness_pN_per_nm": STIFFNESS_PN_PER_NM}
KICK = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 2.0, "pairs": 3}


@pytest.fixture(scope="module")
def snapshot(equilibrated: Any) -> SimulatedDuplex:
    return equilibrated(SEQUENCE, **ENVIRONMENT)[2]


@pytest.fixture(scope="module")
def folder(
    equilibrated: Any,
    snapshot: SimulatedDuplex,
    make_scene: Callable[..., SceneSpec],
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """Return the folder of a run of 0.1 ps from the second snapshot, at constant energy."""
    folder = tmp_path_factory.mktemp("water")
    files = equilibrated(SEQUENCE, **ENVIRONMENT)
    observation = {"duration_ps": 0.1, "interval_fs": 20, "timestep_fs": 1, "helical": True}
    scene = make_scene(snapshot, KICK, ENDS, **observation)
    scene = scene.model_copy(update={"replicas": 2})
    write_json(folder / "scene.json", scene.model_dump(mode="json"))
    start = (files.built_file, files.equilibrated_file)
    output, trajectory = folder / "motion.nc", folder / "trajectory"
    simulate_step(folder / "scene.json", *start, "x1r2", output, trajectory, [], threads=2)
    return folder


@pytest.fixture(scope="module")
def motion(folder: Path) -> xr.Dataset:
    return read_netcdf(folder / "motion.nc")


def test_only_the_duplex_is_recorded(
    folder: Path, motion: xr.Dataset, snapshot: SimulatedDuplex
) -> None:
    assert len(snapshot.masses_Da) > 3 * snapshot.solute
    assert motion.sizes["pair"] == len(SEQUENCE)
    # Ten base pairs of some 620 Da.
    assert motion["mass"].values.sum() == pytest.approx(snapshot.masses_Da[: snapshot.solute].sum())
    topology = mdtraj.Topology.from_openmm(snapshot.topology)
    for sign in ("plus", "minus"):
        atoms = mdtraj.load_dcd(
            str(folder / "trajectory" / f"{sign}.dcd"), top=topology.subset(base_atoms(snapshot))
        )
        assert atoms.n_frames == motion.sizes["time"] == 6
        # Single precision of coordinates of some nm.
        start_nm = snapshot.positions_nm[base_atoms(snapshot)]
        np.testing.assert_allclose(atoms.xyz[0], start_nm, atol=1e-6)


def test_both_signs_differ_by_the_kick_alone(motion: xr.Dataset) -> None:
    fields = wave_fields(motion)
    velocity = fields["extension_velocity"].values
    # In Å/ps; what rigid bonds and water leave of a thermal velocity is their tolerance.
    np.testing.assert_allclose(velocity[0], [2, 2, 2, 0, 0, 0, 0, 0, 0, 0], atol=1e-4)
    energy = fields["kinetic_energy"].values
    kicked = motion["mass"].values[:3].sum()
    # 1 kJ/mol is 100 Da (Å/ps)².
    assert energy[0] == pytest.approx(0.5 * kicked * 2**2 / 100, rel=1e-3)
    # The kick spreads into the duplex and the water; never more comes back than was put in.
    assert (energy[1:] < energy[0]).all()


def test_energy_is_conserved_with_water_springs_and_rigid_bonds(motion: xr.Dataset) -> None:
    energy = motion["total_energy"].values
    # A leapfrog's energy varies by (omega dt)²/8 of what is in the stiffest modes: 1e-2 at 1 fs for
    # bonds of 1500 /cm, in random phases, and single precision rounds -4e4 kJ/mol to 4e-3. A run
    # that lost what the water's constraints do would lose a thousand in this time.
    assert np.abs(energy - energy[:, :1]).max() < 5
    # Plus and minus start with the same positions and thermal velocities.
    assert abs(energy[0, 0] - energy[1, 0]) < 1000
    kelvin = motion["kinetic_temperature_K"].values
    # 0.3 ps of equilibration at 20 /ps; three thousand degrees of freedom scatter by 2 %.
    assert 240 < kelvin.mean() < 340


def test_the_restrained_end_stays(motion: xr.Dataset) -> None:
    last = motion["displacement"].sel(sign=1).values[:, -1]
    # A pN is 6.022 Da Å/ps²; kT is 2.49 kJ/mol = 249 Da (Å/ps)². In each direction the spring of
    # 40,000 pN/Å lets a thermal pair move by sqrt(kT/K) = 0.03 Å, and it starts from its rest.
    spread_A = np.sqrt(249 / (STIFFNESS_PN_PER_NM / 10 * 6.022))
    assert np.abs(last).max() < 4 * spread_A
    # As far as the free pairs go in 0.1 ps.
    assert np.abs(motion["displacement"].sel(sign=1).values[-1, 0]).max() > spread_A


def test_a_run_in_water_goes_on_to_the_last_digit(
    snapshot: SimulatedDuplex, make_scene: Callable[..., SceneSpec]
) -> None:
    """Box, mesh, rigid water and noise, all from a State XML; and two copies share the noise."""
    scene = make_scene(snapshot, KICK, ENDS, {"friction_per_ps": 2.0})
    first, other, later = (Copy(snapshot, scene, Plan(0.001, 10, 2), 0.0, 1) for _ in range(3))
    for one in (first, other):
        one.step(10)
    frame = first.frame()[0]
    np.testing.assert_array_equal(frame.positions_nm, other.state()[0])
    text = openmm.XmlSerializer.serialize(frame.saved.state)
    first.restore(frame.saved, np.zeros((2, 3)))
    later.restore(Saved(openmm.XmlSerializer.deserialize(text), {}), np.zeros((2, 3)))
    for one in (first, later):
        one.step(10)
    np.testing.assert_array_equal(first.state()[0], later.state()[0])
