"""What is written: trajectories that two readers agree on, motion with labels and units."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import MDAnalysis
import mdtraj
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.record import SIGNS, Recorder, antisymmetric, base_atoms
from dnawaves.trajectory.run import run_member

Array = NDArray[np.float64]
PLAN = Plan(timestep_ps=0.002, steps_per_frame=10, frames=6)


@pytest.fixture(scope="module")
def written(
    relaxed: Any,
    make_scene: Callable[..., SceneSpec],
    make_kick: Callable[..., dict[str, Any]],
    tmp_path_factory: pytest.TempPathFactory,
) -> dict[int, Path]:
    """Return the trajectories of a twist kick, one of each sign."""
    folder = tmp_path_factory.mktemp("trajectory")
    files = {sign: folder / f"{name}.dcd" for name, sign in SIGNS.items()}
    scene = make_scene(relaxed.duplex, make_kick("twist", angular_velocity_rad_per_ps=0.5))
    run_member(relaxed.duplex, scene, PLAN, "x1", files)
    return files


def base_topology(duplex: SimulatedDuplex) -> mdtraj.Topology:
    whole = mdtraj.Topology.from_openmm(duplex.topology)
    return whole.subset(base_atoms(duplex))


def test_two_readers_see_the_same_positions(relaxed: Any, written: dict[int, Path]) -> None:
    topology = base_topology(relaxed.duplex)
    for path in written.values():
        one = mdtraj.load_dcd(str(path), top=topology)
        universe = MDAnalysis.Universe.empty(topology.n_atoms).load_new(str(path))
        assert one.n_frames == universe.trajectory.n_frames == PLAN.frames
        other_A = np.array([frame.positions.copy() for frame in universe.trajectory])
        # The file's numbers have 24 bits: 2e-7 nm at 2 nm.
        np.testing.assert_allclose(one.xyz, other_A / 10, atol=1e-6)
        # 20 fs between frames, kept as a single-precision number in CHARMM's unit of time.
        assert universe.trajectory.dt == pytest.approx(0.02, rel=1e-6)


def test_trajectory_starts_at_the_relaxed_structure_and_the_signs_part(
    relaxed: Any, written: dict[int, Path]
) -> None:
    topology = base_topology(relaxed.duplex)
    atoms = base_atoms(relaxed.duplex)
    plus, minus = (mdtraj.load_dcd(str(written[sign]), top=topology).xyz for sign in (1, -1))
    for positions_nm in (plus, minus):
        np.testing.assert_allclose(positions_nm[0], relaxed.duplex.positions_nm[atoms], atol=1e-6)
    # 0.5 rad/ps for 0.1 ps at some 0.3 nm: 0.015 nm each way, less what the rest takes up.
    assert 0.005 < np.abs(plus[-1] - minus[-1]).max() < 0.08


def test_only_the_atoms_that_frames_need_are_kept(relaxed: Any) -> None:
    duplex = relaxed.duplex
    atoms = [list(duplex.topology.atoms())[index] for index in base_atoms(duplex)]
    for residue in duplex.topology.residues():
        names = {atom.name for atom in atoms if atom.residue == residue}
        ring = {"N1", "C2", "N3", "C4", "C5", "C6", "C1'"}
        purine = {"N7", "C8", "N9"}
        assert names == (ring | purine if residue.name in ("DA", "DG") else ring)


def test_record_holds_the_rigid_motion_of_each_sign(
    relaxed: Any, make_scene: Callable[..., SceneSpec], make_kick: Callable[..., dict[str, Any]]
) -> None:
    duplex = relaxed.duplex
    scene = make_scene(duplex, make_kick("shear"))
    recorder = Recorder(duplex, scene, PLAN, (1, -1))
    turn, shift_nm = Rotation.from_rotvec([0.1, -0.2, 0.3]), np.array([0.03, 0.01, -0.02])
    angular, linear = np.array([0.2, 0.1, -0.4]), np.array([0.5, -0.6, 0.7])
    centres = duplex.bodies.centres_nm
    for sign_of_time in (1, 2):
        states = []
        for sign in (1, -1):
            arms = duplex.positions_nm - centres[duplex.pairs]
            moved = turn.apply(arms) if sign == 1 else arms
            velocities = sign * sign_of_time * (linear + np.cross(angular, moved))
            positions = centres[duplex.pairs] + sign * shift_nm + moved
            states.append((positions, velocities, 10.0 * sign + sign_of_time))
        recorder.add(states, [3.0 * sign_of_time, 4.0])
    motion = recorder.dataset()
    assert motion["pair"].values.tolist() == duplex.labels
    assert motion["sign"].values.tolist() == [1, -1]
    np.testing.assert_allclose(motion["time"], [0.0, 0.02], atol=1e-15)
    # In Å and rad; round-off.
    for sign in (1, -1):
        one = motion.sel(sign=sign)
        np.testing.assert_allclose(
            one["displacement"], np.broadcast_to(10 * sign * shift_nm, (2, 6, 3)), atol=1e-11
        )
        rotation = turn.as_rotvec() if sign == 1 else np.zeros(3)
        np.testing.assert_allclose(
            one["rotation"], np.broadcast_to(rotation, (2, 6, 3)), atol=1e-11
        )
        for frame, speed in enumerate((1, 2)):
            np.testing.assert_allclose(
                one["velocity"][frame] - 10 * sign * speed * linear, 0, atol=1e-11
            )
            np.testing.assert_allclose(
                one["angular_velocity"][frame] - sign * speed * angular, 0, atol=1e-11
            )
    np.testing.assert_allclose(motion["total_energy"].sel(sign=-1), [-9, -8])
    np.testing.assert_allclose(motion["work"].sel(sign=1), [3, 6])
    assert motion["displacement"].attrs["units"] == "angstrom"
    assert motion["time"].attrs["units"] == "ps"
    assert SceneSpec.model_validate_json(motion.attrs["scene"]) == scene
    assert motion.attrs["timestep_fs"] == pytest.approx(2)


def test_recorded_masses_and_inertia_give_back_the_energy_of_a_rigid_motion(
    relaxed: Any, make_scene: Callable[..., SceneSpec], make_kick: Callable[..., dict[str, Any]]
) -> None:
    # Mass in Da, inertia in Da Å², velocities in Å/ps: 1 Da Å²/ps² is 0.01 kJ/mol.
    scene = make_scene(relaxed.duplex, make_kick("bend"))
    motion = run_member(relaxed.duplex, scene, Plan(0.002, 1, 1), "x1", {}).dataset()
    v, omega = (motion[name].values[0, 0] for name in ("velocity", "angular_velocity"))
    energy = np.sum(motion["mass"].values[:, None] * v**2) / 2
    energy += np.einsum("pi,pij,pj->", omega, motion["inertia"].values, omega) / 2
    recorded = motion["difference_kinetic_energy"].values[0]
    assert energy / 100 == pytest.approx(recorded, rel=1e-12)


def test_antisymmetric_part() -> None:
    plus, minus = np.array([3.0, 1.0]), np.array([-1.0, 1.0])
    np.testing.assert_array_equal(antisymmetric([plus, minus]), [2.0, 0.0])
    np.testing.assert_array_equal(antisymmetric([plus]), plus)
