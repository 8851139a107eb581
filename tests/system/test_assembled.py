"""Every environment's System, as it is assembled: force, mass, and who is water."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.files import write_json
from dnawaves.scene.models import Environment, NamedDuplex, SystemSpec
from dnawaves.scene.structure_file import digest_of_file
from dnawaves.system.duplex import SimulatedDuplex, read_built
from dnawaves.system.hessian import ReferenceForces
from dnawaves.system.steps import build_step, built_structure
from dnawaves.system.stiffness import base_pair_frames

AsBuilt = Callable[..., SimulatedDuplex]
WARM = {"temperature_K": 300}
WATER = {"water": {"padding_nm": 0.3}, "cutoff_nm": 0.8, "switch_nm": 0.7}
ENVIRONMENTS: dict[str, dict[str, Any]] = {
    "none": {},
    "heavier hydrogens": {"hydrogen_mass_Da": 3},
    "warm none, rigid bonds": {**WARM, "constraints": "hbonds"},
    "OBC2": {**WARM, "solvent": "OBC2"},
    "OBC2 with salt and surface": {
        **WARM,
        "solvent": "OBC2",
        "salt_M": 0.15,
        "surface_area": True,
    },
    "GBn2": {**WARM, "solvent": "GBn2", "salt_M": 0.1},
    "bsc1": {**WARM, "force_field": "bsc1", "solvent": "OBC2"},
    "OL15": {**WARM, "force_field": "OL15", "solvent": "OBC2"},
}


def spec_of(duplex: NamedDuplex, **environment: Any) -> SystemSpec:
    return SystemSpec(
        duplex=duplex,
        environment_name="warm",
        environment=Environment.model_validate(environment),
    )


def in_water(**environment: Any) -> SimulatedDuplex:
    spec = spec_of(NamedDuplex(name="small", sequence="CGAT"), **WARM, **WATER, **environment)
    topology, positions = built_structure(spec)
    box = np.array(topology.getUnitCellDimensions()._value)
    return SimulatedDuplex(spec, topology, positions, box_nm=box)


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_force_is_minus_the_gradient(as_built: AsBuilt, name: str) -> None:
    duplex = as_built("CGAT", **ENVIRONMENTS[name])
    evaluate = ReferenceForces(duplex.system)
    generator = np.random.default_rng(2)
    # Away from the built duplex, whose symmetry might hide a sign.
    place = duplex.positions_nm + generator.normal(scale=0.002, size=duplex.positions_nm.shape)
    direction = generator.normal(size=place.shape)
    direction /= np.linalg.norm(direction)
    step = 1e-5
    slope = (evaluate(place - step * direction)[0] - evaluate(place + step * direction)[0]) / (
        2 * step
    )
    # The third derivative of bonds, 1e7 kJ/mol/nm³, times step²/6, and round-off 1e-12/1e-5.
    assert slope == pytest.approx(float(np.sum(evaluate(place)[1] * direction)), abs=1e-3)


def test_a_cutoff_beyond_half_the_box_is_refused() -> None:
    """Twice 2.5 nm do not fit into 2.2 nm of DNA with 0.3 nm of water on either side."""
    duplex = NamedDuplex(name="small", sequence="CGAT")
    wide = WATER | {"cutoff_nm": 2.5}
    with pytest.raises(InputError, match=r"cutoff_nm: found 2\.5; allowed: below 1"):
        built_structure(spec_of(duplex, **WARM, **wide, solvent="TIP3P"))


@pytest.mark.parametrize("solvent", ["OPC", "TIP3P"])
@pytest.mark.parametrize("force_field", ["OL21", "bsc1"])
def test_force_is_minus_the_gradient_in_water(solvent: str, force_field: str) -> None:
    duplex = in_water(solvent=solvent, force_field=force_field, constraints="hbonds")
    context = openmm.Context(
        duplex.system,
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("Reference"),
    )

    def evaluate(place: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        context.setPositions(place)
        context.computeVirtualSites()
        state = context.getState(energy=True, forces=True)
        return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value

    place, step = duplex.positions_nm, 1e-6
    forces = evaluate(place)[1].copy()
    # One atom at a time: the energy jumps by some 0.01 kJ/mol where a pair crosses the cutoff.
    for name in ("P", "C1'", "Na", "O"):
        atom = [one.index for one in duplex.topology.atoms() if one.name == name][-1]
        shift = np.zeros_like(place)
        shift[atom] = step * np.array([0.6, 0.0, 0.8])
        slope = (evaluate(place - shift)[0] - evaluate(place + shift)[0]) / (2 * step)
        # Round-off: 1e-16 of 1e6 kJ/mol of pair terms over the step.
        assert slope == pytest.approx(forces[atom] @ shift[atom] / step, rel=1e-5, abs=2e-2)


def test_heavier_hydrogens_and_added_mass_go_together(as_built: AsBuilt) -> None:
    plain, heavy = as_built("CGAT"), as_built("CGAT", hydrogen_mass_Da=3)
    # What hydrogens gain their neighbours lose: to the digits of a sum of 250 masses.
    np.testing.assert_allclose(heavy.bodies.masses_Da, plain.bodies.masses_Da, rtol=1e-12)
    hydrogens = [a.index for a in plain.topology.atoms() if a.element.symbol == "H"]
    np.testing.assert_allclose(heavy.masses_Da[hydrogens], 3.0)
    added = heavy.with_added_mass({1: 500.0})
    gained = added.bodies.masses_Da - heavy.bodies.masses_Da
    # Round-off of sums of 1e3 Da.
    np.testing.assert_allclose(gained, [0, 500, 0, 0], atol=1e-9)


def test_mass_can_be_added_in_water_and_the_box_be_another() -> None:
    duplex = in_water(solvent="TIP3P")
    added = duplex.with_added_mass({0: 1000.0})
    assert (added.masses_Da - duplex.masses_Da).sum() == pytest.approx(1000)
    np.testing.assert_array_equal(
        added.masses_Da[duplex.solute :], duplex.masses_Da[duplex.solute :]
    )
    assert duplex.box_nm is not None
    smaller = replace(duplex, box_nm=0.99 * duplex.box_nm)
    vectors = smaller.system.getDefaultPeriodicBoxVectors()
    assert [vectors[k][k]._value for k in range(3)] == pytest.approx(list(0.99 * duplex.box_nm))
    # The box stands along the helix axis, upright from base pair 1 to N.
    np.testing.assert_allclose(duplex.frame.axis, [0, 0, 1], atol=1e-6)
    alone = duplex.without_solvent(duplex.positions_nm[: duplex.solute])
    assert alone.topology.getNumAtoms() == alone.solute == duplex.solute
    assert alone.labels == duplex.labels
    np.testing.assert_array_equal(alone.heights_nm, duplex.heights_nm)
    # Water has no bases.
    for frames in zip(base_pair_frames(duplex), base_pair_frames(alone), strict=True):
        np.testing.assert_array_equal(*frames)


@pytest.fixture(scope="module")
def by_sequence(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the PDB file of a duplex that was built from its sequence."""
    folder = tmp_path_factory.mktemp("by_sequence")
    spec = spec_of(NamedDuplex(name="small", sequence="CGAT"))
    write_json(folder / "system.json", spec.model_dump(mode="json"))
    build_step(folder / "system.json", folder / "built.pdb")
    return folder / "built.pdb"


def test_a_built_duplex_given_as_a_file_is_the_same_system(
    by_sequence: Path, tmp_path: Path
) -> None:
    digest = digest_of_file(by_sequence)
    own = NamedDuplex(name="mine", sequence="CGAT", file=str(by_sequence), digest=digest)
    write_json(tmp_path / "system.json", spec_of(own).model_dump(mode="json"))
    build_step(tmp_path / "system.json", tmp_path / "built.pdb")
    energies = []
    for duplex, file in (
        (NamedDuplex(name="small", sequence="CGAT"), by_sequence),
        (own, tmp_path / "built.pdb"),
    ):
        built = read_built(spec_of(duplex), file)
        energies.append(ReferenceForces(built.system)(built.positions_nm)[0])
    # Not a digit of a coordinate differs.
    assert energies[0] == energies[1]
    assert (tmp_path / "built.pdb").read_text() == by_sequence.read_text()


def test_a_file_that_has_changed_is_refused(by_sequence: Path, tmp_path: Path) -> None:
    file = tmp_path / "mine.pdb"
    file.write_text(by_sequence.read_text())
    own = NamedDuplex(name="mine", sequence="CGAT", file=str(file), digest=digest_of_file(file))
    file.write_text(by_sequence.read_text().replace("REMARK", "REMARK  "))
    with pytest.raises(InputError, match="found another content than when 'mine-warm' was"):
        built_structure(spec_of(own))


def test_a_structure_of_another_system_is_refused(by_sequence: Path) -> None:
    with pytest.raises(InputError, match="found CGAT; allowed: CGGT"):
        read_built(spec_of(NamedDuplex(name="small", sequence="CGGT")), by_sequence)
    water = spec_of(NamedDuplex(name="small", sequence="CGAT"), **WARM, **WATER, solvent="OPC")
    with pytest.raises(InputError, match="found no box; allowed: one with solvent OPC"):
        read_built(water, by_sequence)
