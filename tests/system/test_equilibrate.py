"""A duplex comes to thermal equilibrium, alone or in water, and says whether it did."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from dnawaves.errors import InputError, SimulationError
from dnawaves.files import read_netcdf, write_json
from dnawaves.motion.structure import inspect_step
from dnawaves.scene.models import Environment, NamedDuplex, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex, read_built
from dnawaves.system.effects.constraints import degrees_of_freedom
from dnawaves.system.equilibrate import course_of, equilibrate
from dnawaves.system.equilibration_record import load_record
from dnawaves.system.snapshots import read_equilibrated, read_mean
from dnawaves.system.steps import build_step, equilibrate_step
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

TEMPERATURE_K = 310.0
# High friction: equilibrium within a tenth of a ps.
IMPLICIT = {
    "temperature_K": TEMPERATURE_K,
    "solvent": "OBC2",
    "equilibration": {
        "duration_ps": 1.5,
        "friction_per_ps": 20,
        "snapshots": 2,
        "spacing_ps": 0.1,
        "seed": 3,
    },
}
# As small as PME allows: a box of more than two cutoffs.
EXPLICIT = {
    "temperature_K": 300,
    "solvent": "OPC",
    "water": {"padding_nm": 0.3},
    "constraints": "hbonds",
    "hydrogen_mass_Da": 1.5,
    "cutoff_nm": 0.8,
    "switch_nm": 0.7,
    "equilibration": {
        "duration_ps": 0.4,
        "friction_per_ps": 20,
        "snapshots": 1,
        "pressure_bar": 1,
    },
}


class Equilibrated:
    """The files of one equilibration, by the steps of the pipeline, and what is read from them."""

    def __init__(self, folder: Path, **environment: Any) -> None:
        self.spec = SystemSpec(
            duplex=NamedDuplex(name="small", sequence="CGAT"),
            environment_name="warm",
            environment=Environment.model_validate(environment),
        )
        self.folder = folder
        self.system, self.built, self.file = (
            folder / name for name in ("system.json", "built.pdb", "equilibrated.nc")
        )
        write_json(self.system, self.spec.model_dump(mode="json"))
        build_step(self.system, self.built)
        equilibrate_step(self.system, self.built, self.file, threads=1)
        self.dataset = read_netcdf(self.file)

    def snapshot(self, number: int) -> SimulatedDuplex:
        return read_equilibrated(self.spec, self.built, self.file, number)


@pytest.fixture(scope="module")
def implicit(tmp_path_factory: pytest.TempPathFactory) -> Equilibrated:
    return Equilibrated(tmp_path_factory.mktemp("implicit"), **IMPLICIT)


@pytest.fixture(scope="module")
def explicit(tmp_path_factory: pytest.TempPathFactory) -> Equilibrated:
    return Equilibrated(tmp_path_factory.mktemp("explicit"), **EXPLICIT)


def silent(line: str) -> None:
    pass


def test_the_kinetic_temperature_is_the_thermostats(implicit: Equilibrated) -> None:
    attributes = implicit.dataset.attrs
    freedom = 3 * implicit.snapshot(1).topology.getNumAtoms()
    assert attributes["degrees_of_freedom"] == freedom
    # sqrt(2/(f gamma t)) over the second half, 0.75 ps, at 15 times 1/(2 gamma).
    expected = TEMPERATURE_K * np.sqrt(2 / (freedom * 20 * 0.75))
    assert attributes["temperature_K_mean_standard_error"] == pytest.approx(expected, rel=0.05)
    half = implicit.dataset["temperature_K"].values[15:30]
    assert attributes["temperature_K_mean"] == pytest.approx(half.mean(), rel=1e-12)
    # Three standard errors: one seed in 400 would fail, and this one is fixed.
    assert attributes["temperature_K_mean"] == pytest.approx(TEMPERATURE_K, abs=3 * expected)
    assert attributes["temperature_K_verdict"] == "as set"


def test_snapshots_are_taken_where_declared(implicit: Equilibrated) -> None:
    dataset = implicit.dataset
    # A sample is 25 steps of 2 fs: 30 samples, then 2 more to the second snapshot.
    np.testing.assert_allclose(dataset["time"], 0.05 * np.arange(1, 33))
    assert list(dataset["snapshot"].values) == [1, 2]
    assert "box_nm" not in dataset and "volume_nm3" not in dataset
    for number, sample in ((1, 30), (2, 32)):
        duplex = implicit.snapshot(number)
        ends = duplex.pivots_nm[-1] - duplex.pivots_nm[0]
        # Midpoints of C1' lie 0.2 nm or so beside the axis at most.
        expected = float(dataset["end_to_end_nm"][sample - 1])
        assert np.linalg.norm(ends) == pytest.approx(expected, abs=0.2)


def test_velocities_belong_to_the_time_of_the_positions(implicit: Equilibrated) -> None:
    # The integrator's velocities, half a step late, are Maxwell's. Those at the time of the
    # positions have (1 - (omega dt/2)²) of the kinetic energy in a mode of frequency omega: at 2 fs
    # two thirds in the stiffest, bonds to hydrogen.
    duplex = implicit.snapshot(2)
    kinetic = float(duplex.masses_Da @ np.sum(duplex.velocities_nm_per_ps**2, axis=1))
    temperature_K = kinetic / (degrees_of_freedom(duplex.system) * BOLTZMANN_KJ_PER_MOL_K)
    late_K = float(implicit.dataset["temperature_K"][-1])
    # One in eight degrees of freedom is such a bond: some percent less altogether.
    assert 0.85 < temperature_K / late_K < 1.0


def test_other_snapshots_and_other_systems_are_refused(implicit: Equilibrated) -> None:
    for number in (0, 3):
        with pytest.raises(InputError, match=f"snapshot: found {number}; allowed: 1 to 2"):
            implicit.snapshot(number)
    other = implicit.spec.model_copy(update={"environment_name": "another"})
    with pytest.raises(InputError, match="found the snapshots of"):
        read_equilibrated(other, implicit.built, implicit.file, 1)


def test_the_mean_structure_lies_among_the_snapshots(implicit: Equilibrated) -> None:
    mean = read_mean(implicit.spec, implicit.built, implicit.file)
    apart = [rmsd(mean, implicit.snapshot(number)) for number in (1, 2)]
    apart.append(rmsd(implicit.snapshot(1), implicit.snapshot(2)))
    # Thermal motion of a stacked duplex is an Å or so, and no two structures are alike.
    assert max(apart[:2]) < 0.15
    assert min(apart) > 0.01


def rmsd(one: SimulatedDuplex, other: SimulatedDuplex) -> float:
    first, second = (
        duplex.positions_nm - duplex.positions_nm.mean(axis=0) for duplex in (one, other)
    )
    u, _, vt = np.linalg.svd(first.T @ second)
    u[:, 2] *= np.sign(np.linalg.det(u @ vt))
    return float(np.sqrt(np.mean(np.sum((first @ u @ vt - second) ** 2, axis=1))))


def test_inspect_looks_at_the_mean_structure(implicit: Equilibrated, tmp_path: Path) -> None:
    outputs = [tmp_path / name for name in ("structure.nc", "base_atoms.pdb", "relaxed.pdb")]
    inspect_step(implicit.system, implicit.built, implicit.file, *outputs)
    structure = read_netcdf(outputs[0])
    # As built 3.4 Å; four base pairs at 310 K stay within an Å of the built duplex's heavy atoms.
    assert structure.attrs["rmsd_to_built_A"] < 2
    assert structure.sizes["pair"] == 4


class KilledError(Exception):
    """Ends an equilibration in the middle."""


def test_a_killed_run_ends_as_it_would_have_ended(implicit: Equilibrated, tmp_path: Path) -> None:
    duplex = read_built(implicit.spec, implicit.built)
    checkpoint = tmp_path / "checkpoint.npz"
    whole = equilibrate(duplex, 1, silent, samples_per_piece=12)

    def killed(line: str) -> None:
        if line.startswith("1.20 of"):
            raise KilledError

    with pytest.raises(KilledError):
        equilibrate(duplex, 1, killed, checkpoint, samples_per_piece=12)
    said: list[str] = []
    resumed = equilibrate(duplex, 1, said.append, checkpoint, samples_per_piece=12)
    assert said[0] == "goes on after 1.20 ps"
    # Not a digit differs.
    xr.testing.assert_identical(whole, resumed)


def test_a_checkpoint_of_another_run_is_not_used(
    implicit: Equilibrated, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checkpoint = tmp_path / "checkpoint.npz"
    short = with_equilibration(implicit.spec, duration_ps=0.2, snapshots=1)

    def of_seed(seed: int, report: Callable[[str], None] = silent) -> xr.Dataset:
        duplex = read_built(with_equilibration(short, seed=seed), implicit.built)
        return equilibrate(duplex, 1, report, checkpoint, samples_per_piece=4)

    one = of_seed(1)
    said: list[str] = []
    again = of_seed(1, said.append)
    # All samples are in the checkpoint: nothing is left to be run.
    assert said == ["goes on after 0.20 ps"]
    xr.testing.assert_identical(one, again)
    other = of_seed(2)
    assert "of another run, so not used" in capsys.readouterr().err
    assert np.abs(other["position_nm"] - one["position_nm"]).max() > 1e-3


@pytest.mark.parametrize("content", [b"", b"no zip file", b"PK\x03\x04 cut short"])
def test_a_checkpoint_that_is_no_file_of_arrays_is_not_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes
) -> None:
    checkpoint = tmp_path / "checkpoint.npz"
    checkpoint.write_bytes(content)
    assert load_record(checkpoint, "this run") is None
    assert f"{checkpoint}: cannot be read (" in capsys.readouterr().err


def with_equilibration(spec: SystemSpec, **changes: Any) -> SystemSpec:
    content = spec.model_dump(mode="json")
    content["environment"]["equilibration"] |= changes
    return SystemSpec.model_validate(content)


def test_a_run_that_explodes_stops_and_says_when(implicit: Equilibrated) -> None:
    # Beyond 2/omega of the O-H stretch, 2.86 fs.
    duplex = read_built(
        with_equilibration(implicit.spec, timestep_fs=4, friction_per_ps=0.1), implicit.built
    )
    with pytest.raises(SimulationError, match=r"stopped between 0\.\d+ and 0\.\d+ ps: "):
        equilibrate(duplex, 1, silent)


def test_a_run_that_is_too_short_says_so(
    implicit: Equilibrated, tmp_path: Path, capsys: Any
) -> None:
    spec = with_equilibration(implicit.spec, duration_ps=0.1, snapshots=1)
    write_json(tmp_path / "system.json", spec.model_dump(mode="json"))
    equilibrate_step(tmp_path / "system.json", implicit.built, tmp_path / "short.nc", threads=1)
    told = "not in equilibrium: "
    assert read_netcdf(tmp_path / "short.nc").attrs["warning"].startswith(told)
    assert f"WARNING: {told}" in capsys.readouterr().err
    assert not list(tmp_path.glob(".*"))


def test_water_comes_after_the_duplex(explicit: Equilibrated) -> None:
    duplex = explicit.snapshot(1)
    names = [atom.residue.name for atom in duplex.topology.atoms()]
    assert {*names[: duplex.solute]} == {"DC", "DG", "DA", "DT"}
    assert {*names[duplex.solute :]} == {"HOH", "NA"}
    assert duplex.pairs.shape == (duplex.solute,)
    assert duplex.labels == ["A:1-B:4", "A:2-B:3", "A:3-B:2", "A:4-B:1"]
    masses = duplex.masses_Da
    assert duplex.bodies.masses_Da.sum() == pytest.approx(masses[: duplex.solute].sum())
    # Two each of dA, dC, dG and dT; each phosphate between them adds PO2 less two hydrogens.
    nucleosides = 2 * (251.24 + 227.22 + 267.24 + 242.23)
    # Heavier hydrogens take their mass from their neighbours. Weights to 0.01 Da.
    expected = nucleosides + 6 * (30.974 + 2 * 15.999 - 2 * 1.008)
    assert masses[: duplex.solute].sum() == pytest.approx(expected, abs=0.2)


def test_the_box_follows_the_barostat_and_is_then_fixed(explicit: Equilibrated) -> None:
    volume = explicit.dataset["volume_nm3"].values
    built = read_built(explicit.spec, explicit.built)
    assert built.box_nm is not None
    half = course_of(explicit.spec.environment.to_snapshots).half
    assert abs(volume[half - 1] / built.box_nm.prod() - 1) > 1e-4
    np.testing.assert_array_equal(volume[half:], volume[half])
    box = explicit.snapshot(1).box_nm
    assert box is not None
    assert box.prod() == pytest.approx(volume[-1], rel=1e-12)
    vectors = explicit.snapshot(1).system.getDefaultPeriodicBoxVectors()
    assert [vectors[k][k]._value for k in range(3)] == pytest.approx(list(box))


def test_snapshots_keep_the_constraints(explicit: Equilibrated) -> None:
    duplex = explicit.snapshot(1)
    velocities = duplex.velocities_nm_per_ps
    assert velocities is not None
    system, places = duplex.system, duplex.positions_nm
    pairs = [system.getConstraintParameters(i) for i in range(system.getNumConstraints())]
    i, j = (np.array([pair[k] for pair in pairs]) for k in (0, 1))
    lengths = np.array([pair[2]._value for pair in pairs])
    bonds = places[i] - places[j]
    found = np.linalg.norm(bonds, axis=1)
    # OpenMM's tolerance is 1e-5 by default.
    np.testing.assert_allclose(found, lengths, rtol=3e-5)
    along = np.sum((velocities[i] - velocities[j]) * bonds, axis=1) / found
    # Hydrogens move at 1.6 nm/ps.
    assert np.abs(along).max() < 1e-3
    # One for each of the duplex's hydrogens, three distances for each water.
    hydrogens = sum(
        atom.element is not None and atom.element.symbol == "H" and atom.index < duplex.solute
        for atom in duplex.topology.atoms()
    )
    waters = sum(residue.name == "HOH" for residue in duplex.topology.residues())
    assert len(pairs) == hydrogens + 3 * waters


def test_four_site_water_keeps_its_massless_site(explicit: Equilibrated) -> None:
    duplex = explicit.snapshot(1)
    water = next(r for r in duplex.topology.residues() if r.name == "HOH")
    at = {atom.name: duplex.positions_nm[atom.index] for atom in water.atoms()}
    # Izadi, Anandakrishnan & Onufriev 2014 (J. Phys. Chem. Lett. 5, 3863): 0.1594 A.
    assert np.linalg.norm(at["M"] - at["O"]) == pytest.approx(0.01594, abs=1e-5)
    index = {atom.name: atom.index for atom in water.atoms()}
    velocities = duplex.velocities_nm_per_ps
    assert velocities is not None
    assert degrees_of_freedom(duplex.system) == explicit.dataset.attrs["degrees_of_freedom"]
    assert duplex.masses_Da[index["M"]] == 0


def test_at_rest_there_is_nothing_to_equilibrate(
    as_built: Callable[..., SimulatedDuplex],
) -> None:
    with pytest.raises(InputError, match="temperature_K 0: found no equilibration"):
        equilibrate(as_built("CGAT"), 1, silent)
