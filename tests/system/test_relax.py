"""The relaxed duplex is a true minimum, and the same one every time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dnawaves.duplex.build import watson_crick_bonds
from dnawaves.errors import InputError, SimulationError
from dnawaves.files import write_netcdf
from dnawaves.scene.environment import Relaxation
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.guided import GuidedEnd, line_density
from dnawaves.system.hessian import ReferenceForces
from dnawaves.system.modes import RIGID_MODES
from dnawaves.system.relax import anneal, lowest_modes, read_relaxed, relax


def silent(line: str) -> None:
    pass


def test_no_force_is_left(relaxed: Any) -> None:
    duplex = relaxed.duplex
    energy, force = ReferenceForces(duplex.system)(duplex.positions_nm)
    tolerance = duplex.spec.environment.to_minimum.force_tolerance_kJ_per_mol_nm
    rms = float(np.sqrt(np.mean(force**2)))
    assert rms <= tolerance
    # The same positions evaluated again: round-off of forces of 1e4 that cancel.
    assert relaxed.record.rms_force_kJ_per_mol_nm == pytest.approx(rms, abs=1e-9)
    assert relaxed.record.energy_kJ_per_mol == pytest.approx(energy, rel=1e-12)


def test_energy_went_down_and_hydrogen_bonds_are_kept(relaxed: Any) -> None:
    duplex = relaxed.duplex
    start = duplex.with_positions(duplex.positions_nm)
    assert relaxed.record.energy_kJ_per_mol < -5000  # as built about -4,700
    for bonds in watson_crick_bonds(start.topology)[1:-1]:
        for i, j in bonds:
            # Watson-Crick N-H..N and N-H..O are 2.8 to 3.0 Å; 3.5 Å is the usual bound.
            assert np.linalg.norm(duplex.positions_nm[i] - duplex.positions_nm[j]) < 0.35


def test_six_modes_cost_nothing_and_none_is_unstable(relaxed: Any) -> None:
    values, vectors = lowest_modes(relaxed.hessian, relaxed.duplex.masses_Da, 8)
    # Differences along rigid motions leave 1e-6 ps⁻²; the softest vibration of six base pairs
    # has about 1 ps⁻².
    assert np.abs(values[:RIGID_MODES]).max() < 1e-4
    assert values[RIGID_MODES] > 0.1
    # The same matrix again: round-off of eigenvalues of up to 5e5 ps⁻².
    np.testing.assert_allclose(relaxed.record.lowest_eigenvalue_per_ps2[:8], values, atol=1e-9)
    assert (relaxed.record.negative_modes, relaxed.record.zero_modes) == (0, 6)
    # The six are the rigid ones: each is orthogonal to every vibration, so a shift and a turn of
    # the whole duplex lie among them.
    duplex = relaxed.duplex
    root = np.sqrt(duplex.masses_Da)[:, None]
    for motion in (
        np.broadcast_to([0.0, 0.6, 0.8], duplex.positions_nm.shape),
        np.cross([1.0, 0, 0], duplex.positions_nm),
    ):
        shape = (root * motion).ravel()
        shape /= np.linalg.norm(shape)
        assert np.linalg.norm(vectors[:, :6].T @ shape) == pytest.approx(1, abs=1e-6)


def test_a_search_that_is_given_up_says_what_is_left(
    as_built: Callable[..., SimulatedDuplex],
) -> None:
    # A force that round-off does not let it reach; four base pairs come to a minimum all the same.
    search = {"anneal_ps": 0, "cycles": 1, "force_tolerance_kJ_per_mol_nm": 1e-12}
    with pytest.raises(SimulationError) as caught:
        relax(as_built("CGAT", relaxation=search), 1, silent)
    said = str(caught.value)
    assert said.startswith("no minimum after 1 Hessians: rms force ")
    assert "; no mode is negative. Raise relaxation.cycles, or take another" in said


def test_lowest_modes_of_two_masses_on_a_spring() -> None:
    # Springs along x only: omega² = k (1/m1 + 1/m2).
    hessian = np.zeros((6, 6))
    hessian[np.ix_([0, 3], [0, 3])] = [[50.0, -50.0], [-50.0, 50.0]]
    values, _ = lowest_modes(hessian, np.array([2.0, 3.0]), 6)
    np.testing.assert_allclose(values, [0, 0, 0, 0, 0, 50 * (1 / 2 + 1 / 3)], atol=1e-12)


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_first_estimate_is_the_rods_speed_with_everything_free_to_relax(
    relaxed: Any, wave: str
) -> None:
    duplex = relaxed.duplex
    reduced = GuidedEnd(duplex, wave, held=1).hessian(relaxed.hessian)
    push = np.zeros(len(reduced))
    push[-1] = 1.0
    modulus = np.ptp(duplex.heights_nm) / np.linalg.solve(reduced, push)[-1]
    density = line_density(duplex, wave)
    recorded = relaxed.record.attrs[f"first_estimate_{wave}_A_per_ps"]
    # Two ways to solve one system: round-off times the Hessian's condition of 1e6.
    assert recorded == pytest.approx(10 * np.sqrt(modulus / density), rel=1e-8)
    # Between a third of the paper's slowest and three times the fastest seen in trials.
    assert 2 < recorded < 60


@pytest.mark.parametrize(
    ("attributes", "said"),
    [
        ({"spec": '{"duplex": "CGATCG"}'}, '{"duplex": "CGATCG"}'),  # of another version
        ({}, "no system"),
    ],
)
def test_a_minimum_that_is_not_known_to_be_this_systems_is_refused(
    relaxed: Any, tmp_path: Path, attributes: dict[str, str], said: str
) -> None:
    unknown = relaxed.record.copy()
    unknown.attrs = attributes
    write_netcdf(tmp_path / "relaxed.nc", unknown)
    with pytest.raises(InputError) as caught:
        read_relaxed(relaxed.duplex.spec, relaxed.built_file, tmp_path / "relaxed.nc")
    assert f"relaxed.nc: found the minimum of {said}; allowed: " in str(caught.value)


def test_a_minimum_of_another_system_is_refused(relaxed: Any) -> None:
    other = relaxed.duplex.spec.model_copy(update={"environment_name": "another"})
    with pytest.raises(InputError, match=r"found the minimum of .* allowed: .*another"):
        read_relaxed(other, relaxed.built_file, relaxed.relaxed_file)


def test_saved_hessian_is_symmetric_and_complete(relaxed: Any) -> None:
    atoms = relaxed.duplex.topology.getNumAtoms()
    assert relaxed.hessian.shape == (3 * atoms, 3 * atoms)
    np.testing.assert_array_equal(relaxed.hessian, relaxed.hessian.T)


def test_structure_does_not_depend_on_the_run_but_on_the_seed(
    as_built: Callable[..., SimulatedDuplex],
) -> None:
    duplex = as_built("CGAT")

    def annealed(seed: int) -> np.ndarray:
        return anneal(duplex, Relaxation(anneal_ps=0.2, seed=seed), silent)

    first = annealed(1)
    # Not a digit differs: the relaxed structure is what every scene starts from.
    np.testing.assert_array_equal(annealed(1), first)
    assert np.abs(annealed(2) - first).max() > 1e-4
