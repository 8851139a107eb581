"""A scene contains what it calls for and nothing else, and says so before it runs."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse
import xarray as xr
import yaml

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, write_netcdf
from dnawaves.motion.fields import wave_fields
from dnawaves.scene.excitations import Static
from dnawaves.scene.load import load_scenes
from dnawaves.scene.models import NamedDuplex, SceneSpec
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.modes import normal_modes
from dnawaves.system.steps import built_structure
from dnawaves.trajectory.explain import PURPOSES, explain, force_names
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.load import relax_under_load
from dnawaves.trajectory.plan import Plan, make_plan
from dnawaves.trajectory.record import SIGNS, base_atoms
from dnawaves.trajectory.run import run_member

CONFIG = Path(__file__).resolve().parents[2] / "config"
SHIPPED = {
    name: scene
    for file in ("config.yaml", "smoke.yaml", "paper.yaml")
    for name, scene in load_scenes(CONFIG / file).items()
}
AMBER = {"HarmonicBondForce", "HarmonicAngleForce", "PeriodicTorsionForce", "NonbondedForce"}
MOTION = {
    *("displacement", "rotation", "velocity", "angular_velocity", "total_energy", "work"),
    *("difference_kinetic_energy", "mass", "inertia", "centre", "pivot", "direction"),
}
PUT_IN = {"injected_momentum", "injected_angular_momentum"}
WAVES = ("extension", "twist", "bend", "shear", "bend_across", "shear_across")
FIELDS = {f"{wave}_{kind}" for wave in WAVES for kind in ("displacement", "velocity")} | {
    *("kinetic_energy", "energy_put_in"),
}
SEQUENCE = "CGATCG"


def one_of_each() -> list[str]:
    """Return a scene for each way in which the shipped ones differ in what is there to record."""
    found: dict[str, str] = {}
    for name, scene in SHIPPED.items():
        excitation = scene.excitation
        way = (
            *(excitation.kind, getattr(excitation, "wave", None), scene.method),
            *(scene.ends, scene.observation.helical, scene.thermostat, bool(scene.masses)),
            scene.system.environment.model_dump_json(exclude={"relaxation", "equilibration"}),
        )
        found.setdefault(repr(way), name)
    return sorted(found.values())


def small(scene: SceneSpec) -> SceneSpec:
    """Return the same scene of a shorter duplex, if in water then in a smaller box."""
    environment = scene.system.environment
    if environment.water is not None:
        water = environment.water.model_copy(update={"padding_nm": 0.3})
        environment = environment.model_copy(update={"water": water})
    duplex = NamedDuplex(name="small", sequence=SEQUENCE)
    system = scene.system.model_copy(update={"duplex": duplex, "environment": environment})
    return scene.model_copy(update={"system": system})


def expected_forces(scene: SceneSpec) -> set[str]:
    """Return what a scene calls for, in OpenMM's words."""
    environment, forces = scene.system.environment, set(AMBER)
    if environment.solvent in ("OBC2", "GBn2"):
        native = environment.solvent == "OBC2" and environment.salt_M == 0
        forces.add("GBSAOBCForce" if native else "CustomGBForce")
    if "restrained" in (scene.ends.first, scene.ends.last):
        forces.add("CustomExternalForce")
    return forces


@pytest.mark.parametrize("name", one_of_each())
def test_the_forces_of_a_shipped_scene_are_those_it_calls_for_and_no_other(name: str) -> None:
    scene = small(SHIPPED[name])
    topology, positions_nm = built_structure(scene.system)
    duplex = SimulatedDuplex(scene.system, topology, positions_nm)
    names = force_names(duplex, scene)
    assert sorted(names) == sorted(expected_forces(scene))
    assert set(names) <= set(PURPOSES)
    # Bonds to hydrogen, three sides of each rigid water, or nothing.
    constraints = duplex.system.getNumConstraints()
    waters = sum(residue.name == "HOH" for residue in topology.residues())
    hydrogens = sum(
        atom.element is not None and atom.element.symbol == "H"
        for atom in islice(topology.atoms(), duplex.solute)
    )
    rigid = scene.system.environment.constraints == "hbonds"
    assert constraints == 3 * waters + rigid * hydrogens
    assert (waters > 0) == scene.system.explicit
    # Where a barostat acts at all, it is in the equilibration.
    assert not any("Barostat" in force.getName() for force in duplex.system.getForces())


def short(scene: SceneSpec) -> Plan:
    speeds = {"extension": 15.0, "twist": 10.0}
    plan = make_plan(scene, scene.members[0], speeds, 20.0, 3.3, [12.0] * len(scene.needs))
    return replace(plan, timestep_ps=0.001, steps_per_frame=2, frames=3)


def recorded(scene: SceneSpec, duplex: SimulatedDuplex, relaxed: Any, folder: Path) -> xr.Dataset:
    """Return the first member's record, three frames long, of a small duplex."""
    plan = short(scene)
    if scene.method == "harmonic":
        free = ~np.isin(duplex.pairs, held_pairs(scene.ends, duplex.pair_count))
        hessian = scipy.sparse.csr_array(relaxed.hessian)
        modes = normal_modes(hessian, duplex.masses_Da, duplex.bodies, free)
        return respond(duplex, modes, scene, plan, 1.0, 0.0)
    if isinstance(scene.excitation, Static):
        return relax_under_load(duplex, scene, plan, 0.01, relaxed.hessian)
    files = {SIGNS[sign]: folder / f"{sign}.dcd" for sign in scene.signs}
    files = files if scene.observation.helical else {}
    recorder = run_member(duplex, scene, plan, scene.members[0], files)
    atoms = recorder.frames().get("atoms")
    if scene.observation.helical:
        assert atoms is not None and atoms.shape[2] == len(base_atoms(duplex))
    else:
        assert atoms is None
    return recorder.dataset()


@pytest.mark.parametrize("name", one_of_each())
def test_a_shipped_scene_records_and_derives_what_it_calls_for(
    name: str, relaxed: Any, equilibrated: Any, tmp_path: Path
) -> None:
    scene = small(SHIPPED[name])
    if scene.system.thermal:
        environment = scene.system.environment.model_dump(exclude={"equilibration"})
        snapshots = equilibrated(SEQUENCE, **environment)
        scene, duplex = scene.model_copy(update={"system": snapshots.spec}), snapshots[1]
    else:
        duplex = relaxed.duplex
        scene = scene.model_copy(update={"system": duplex.spec})
    motion = recorded(scene, duplex, relaxed, tmp_path)
    extra = {"linear_response"} if isinstance(scene.excitation, Static) else PUT_IN
    extra = extra | ({"kinetic_temperature_K"} if scene.system.thermal else set())
    assert set(motion.data_vars) == MOTION | extra
    assert motion.sizes["sign"] == len(scene.signs)
    # Nothing of the water is kept.
    assert motion.sizes["pair"] == len(SEQUENCE)
    assert set(wave_fields(motion).data_vars) == FIELDS


@pytest.fixture
def config(relaxed: Any, tmp_path: Path) -> Path:
    """Return a configuration of the small relaxed duplex."""
    spec = relaxed.duplex.spec
    held, place = {"first": "held", "last": "held"}, {"duplex": "small", "environment": "condensed"}
    drive = {"kind": "periodic", "wave": "twist", "torque_pN_nm": 9, "frequencies_GHz": [200]}
    load = {"kind": "static", "wave": "twist", "torque_pN_nm": 9}
    content = {
        "structures": "duplexes.yaml",
        "environments": {"condensed": spec.environment.model_dump(mode="json")},
        "scenes": {
            "driven": {
                **place,
                "ends": held,
                "excitation": drive,
                "observation": {"duration_ps": 1, "interval_fs": 20, "helical": True},
            },
            "loaded": {**place, "ends": {**held, "last": "guided"}, "excitation": load},
        },
    }
    (tmp_path / "duplexes.yaml").write_text(f"small: {spec.duplex.sequence}\n")
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(content))
    return tmp_path / "config.yaml"


def test_explain_says_what_runs(config: Path, relaxed: Any) -> None:
    results = config.parent / "results"
    duplex = relaxed.duplex
    atoms, held = len(duplex.pairs), int(((duplex.pairs == 0) | (duplex.pairs == 5)).sum())
    said = explain(config, "driven", results)
    for force in AMBER:
        assert f"  {force}: {PURPOSES[force]}\n" in said
    assert "inside the integrator: the drive" in said
    free = atoms - held
    assert f"particles: {atoms}, of which {free} move: {3 * free} degrees of freedom\n" in said
    assert "runs: 1 (f1) x 2 signs\n" in said
    assert "length: 1.0 ps, 500 steps of 2 fs, 51 frames, by the paper's speeds for now" in said
    assert "time: 1000 steps at " in said
    # 51 frames, two signs: 6 pairs of 96 bytes and base atoms of 12.
    bytes_ = 51 * 2 * (6 * 96 + 12 * len(base_atoms(duplex)))
    assert said.endswith(f"disk: at most {bytes_ / 1e6:.1f} MB")

    system = results / "systems" / "small-condensed"
    system.mkdir(parents=True)
    shutil.copy(relaxed.relaxed_file, system / "relaxed.nc")
    shutil.copy(relaxed.built_file, system / "built.pdb")
    assert "by the relaxed duplex's first estimate" in explain(config, "driven", results)
    # A minimum that another version of the program wrote is left aside.
    other = read_netcdf(relaxed.relaxed_file).assign_attrs(spec='{"force_field": "unknown"}')
    write_netcdf(system / "relaxed.nc", other)
    assert "by the paper's speeds for now" in explain(config, "driven", results)


def test_a_guided_pair_has_one_degree_of_freedom(config: Path, relaxed: Any) -> None:
    pairs = relaxed.duplex.pairs
    freedom = 3 * int(((pairs > 0) & (pairs < 5)).sum()) + 1
    said = explain(config, "loaded", config.parent)
    assert f"move: {freedom} degrees of freedom\n" in said
    assert "relaxed under the load" in said


def test_explain_says_what_runs_above_0_k(tmp_path: Path) -> None:
    content = {
        "structures": "duplexes.yaml",
        "environments": {
            "wet": {
                "temperature_K": 300,
                "solvent": "TIP3P",
                "constraints": "hbonds",
                "water": {"padding_nm": 0.3},
                "equilibration": {"snapshots": 2},
            }
        },
        "scenes": {
            "warm": {
                "duplex": "small",
                "environment": "wet",
                "ends": {"last": "restrained", "stiffness_pN_per_nm": 1e5},
                "excitation": {"kind": "none"},
                "observation": {"duration_ps": 1},
                "thermostat": {"friction_per_ps": 0.5},
                "replicas": 2,
            }
        },
    }
    (tmp_path / "duplexes.yaml").write_text("small: CGCG\n")
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(content))
    said = explain(tmp_path / "config.yaml", "warm", tmp_path / "results")
    assert f"  CustomExternalForce: {PURPOSES['CustomExternalForce']}\n" in said
    assert "inside the integrator: friction of 0.5 /ps and noise of 300 K\n" in said
    match = re.search(
        r"particles: (\d+), of which (\d+) move less (\d+) constraints: (\d+) deg", said
    )
    assert match is not None
    particles, moving, constraints, freedom = map(int, match.groups())
    # 250 atoms, 92 of them hydrogens; rigid water has three atoms and as many constraints.
    assert particles == moving > 1000
    assert freedom == 3 * moving - constraints
    assert (constraints - 92) % 3 == 0
    assert "runs: 2 (r1, r2) x 1 signs\n" in said
    assert "min on one thread, without the equilibration" in said


def test_an_unknown_scene_is_refused_with_the_known(config: Path) -> None:
    with pytest.raises(
        InputError, match=r"'drivn' \(did you mean 'driven'\?\); allowed: driven, loaded"
    ):
        explain(config, "drivn", config.parent)
