"""The B-DNA verdict on structures that are it, and that are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.motion.structure import (
    b_form_verdict,
    heavy_atom_rmsd_A,
    inspect_structure,
    kinked_steps,
)
from dnawaves.scene.models import Environment, NamedDuplex, SystemSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import load_force_field

SEQUENCE = "CGATCAGTCG"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[SimulatedDuplex, Path]:
    environment = Environment()
    topology, positions = build_duplex(SEQUENCE, load_force_field(environment))
    spec = SystemSpec(
        duplex=NamedDuplex(name="test", sequence=SEQUENCE),
        environment_name="vacuum",
        environment=environment,
    )
    path = tmp_path_factory.mktemp("built") / "built.pdb"
    write_pdb(topology, positions, path)
    return SimulatedDuplex(spec, topology, positions), path


def test_the_fibre_model_is_b_dna(built: tuple[SimulatedDuplex, Path]) -> None:
    duplex, path = built
    dataset = inspect_structure(duplex, path, path)
    assert dataset.attrs["verdict"] == "B-DNA"
    # The fibre's screw, 3.375 Å and 36°, as mid-step parameters: sequence moves them a little.
    assert dataset.attrs["interior_rise_A"] == pytest.approx(3.375, abs=0.05)
    assert dataset.attrs["interior_twist_deg"] == pytest.approx(36.0, abs=1.0)
    # mdtraj superposes in single precision: the root of its round-off is 0.006 Å.
    assert dataset.attrs["rmsd_to_built_A"] == pytest.approx(0.0, abs=0.01)
    expected = [3 if base in "GC" else 2 for base in SEQUENCE]
    assert dataset["hydrogen_bonds"].values.tolist() == expected


def test_an_opened_pair_is_named(built: tuple[SimulatedDuplex, Path], tmp_path: Path) -> None:
    duplex, path = built
    moved = duplex.positions_nm.copy()
    first, _ = duplex.topology.chains()
    atoms = [atom.index for atom in list(first.residues())[4].atoms()]
    # 0.6 nm outwards: no hydrogen bond reaches that far.
    out = moved[atoms].mean(axis=0) * [1, 1, 0]
    moved[atoms] += 0.6 * out / np.linalg.norm(out)
    opened = tmp_path / "opened.pdb"
    write_pdb(duplex.topology, moved, opened)
    dataset = inspect_structure(duplex.with_positions(moved), path, opened)
    assert dataset.attrs["lost_pairs"] == "A:5-B:6"
    assert dataset.attrs["verdict"].startswith("not B-DNA")


def test_rmsd_is_that_after_superposition(
    built: tuple[SimulatedDuplex, Path], tmp_path: Path
) -> None:
    duplex, path = built
    turned = Rotation.from_rotvec([0.4, 1.0, -0.3]).apply(duplex.positions_nm) + 1.5
    other = tmp_path / "turned.pdb"
    write_pdb(duplex.topology, turned, other)
    # As above; the files round to 0.001 Å.
    assert heavy_atom_rmsd_A(path, other) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(
    ("rise", "twist", "lost", "fault"),
    [(3.93, 36, [], "rise"), (3.3, 28.7, [], "twist"), (3.3, 36, ["A:1-B:4"], "A:1-B:4")],
)
def test_each_fault_is_in_the_verdict(
    rise: float, twist: float, lost: list[str], fault: str
) -> None:
    assert fault in b_form_verdict(rise, twist, lost, [])
    assert b_form_verdict(3.3, 36.0, [], []) == "B-DNA"


def test_a_kink_shows_although_the_mean_is_that_of_b_dna(
    built: tuple[SimulatedDuplex, Path],
) -> None:
    duplex, path = built
    dataset = inspect_structure(duplex, path, path)
    assert kinked_steps(dataset) == []
    # One unstacked step, as DNA relaxed without solvent shows it.
    dataset["roll"][4] = -68.0
    dataset["rise"][4] = 5.42
    (kink,) = kinked_steps(dataset)
    assert "A:5-B:6/A:6-B:5" in kink and "5.4 Å" in kink and "-68°" in kink
    assert b_form_verdict(3.4, 37.0, [], [kink]).startswith("B-DNA on average, kinked at A:5")
    # Nor is a step stacked that has no frame.
    dataset["roll"][4], dataset["rise"][4] = 0.0, np.nan
    (kink,) = kinked_steps(dataset)
    assert "A:5-B:6/A:6-B:5" in kink
