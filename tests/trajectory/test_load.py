"""A static load: the minimum under it, held against the linear response of the Hessian."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.scene.models import SceneSpec
from dnawaves.system.guided import GuidedEnd
from dnawaves.system.hessian import ReferenceForces
from dnawaves.trajectory.load import relax_under_load
from dnawaves.trajectory.plan import Plan
from dnawaves.units import PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]
Load = Callable[[str, float], xr.Dataset]
GUIDED = {"first": "held", "last": "guided"}
PLAN = Plan(timestep_ps=0.002, steps_per_frame=1, frames=1)
# 5 pN stretch B-DNA by 0.5 %, 5 pN nm turn it by about a degree per step.
AMPLITUDES = {"extension": "force_pN", "twist": "torque_pN_nm"}


@pytest.fixture(scope="module")
def load(relaxed: Any, make_scene: Callable[..., SceneSpec]) -> Load:
    made: dict[tuple[str, float], xr.Dataset] = {}

    def relax(wave: str, scale: float) -> xr.Dataset:
        if (wave, scale) not in made:
            excitation = {
                "kind": "static",
                "wave": wave,
                AMPLITUDES[wave]: 5.0,
                "scales": (scale,),
            }
            scene = make_scene(relaxed.duplex, excitation, GUIDED)
            made[wave, scale] = relax_under_load(
                relaxed.duplex, scene, PLAN, scale, relaxed.hessian
            )
        return made[wave, scale]

    return relax


def moved(dataset: xr.Dataset, wave: str) -> Array:
    """Return slide in nm or turn in rad of each base pair along or about the axis, (sign, pair)."""
    axis = dataset["direction"].sel(axis="helix").values
    if wave == "extension":
        return dataset["displacement"].values[:, 0] @ axis / 10
    return dataset["rotation"].values[:, 0] @ axis


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_a_small_load_displaces_as_the_hessian_says(relaxed: Any, load: Load, wave: str) -> None:
    dataset = load(wave, 1.0)
    assert dataset.attrs["left_basin"] == ""
    reduced = GuidedEnd(relaxed.duplex, wave, 1).hessian(relaxed.hessian)
    push = np.zeros(len(reduced))
    push[-1] = 5.0 / PN_PER_KJ_PER_MOL_NM
    slide = np.linalg.solve(reduced, push)[-1]
    plus, minus = moved(dataset, wave)[:, -1]
    # Odd in the load to third order; the even part, anharmonic, cancels: a few per cent of it.
    assert (plus - minus) / 2 == pytest.approx(slide, rel=0.01)
    assert plus > 0 > minus
    # What is recorded is Å/pN or rad/(pN nm).
    per_unit = slide / 5.0 * (10 if wave == "extension" else 1)
    recorded = dataset["linear_response"].sel(lock="nothing")
    # The factored Hessian is stiffened by 1e-3 kJ/mol/nm².
    assert float(recorded) == pytest.approx(per_unit, rel=1e-4)


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_twice_the_load_moves_twice_as_far(load: Load, wave: str) -> None:
    single, double = (moved(load(wave, scale), wave) for scale in (1.0, 2.0))
    single, double = (0.5 * (field[0] - field[1]) for field in (single, double))
    # Third order in the load: 2 % at 5 pN or pN nm would be 6 % here.
    np.testing.assert_allclose(double, 2 * single, atol=0.02 * np.abs(double).max())
    assert load(wave, 2.0).attrs["left_basin"] == ""
    # The displacement grows from the held to the guided end.
    assert single[0] == pytest.approx(0, abs=1e-12)
    assert np.argmax(np.abs(single)) == 5


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_ends_move_as_they_may(relaxed: Any, load: Load, wave: str) -> None:
    dataset = load(wave, 1.0)
    held, guided = dataset.isel(pair=0, time=0), dataset.isel(pair=-1, time=0)
    for name in ("displacement", "rotation"):
        np.testing.assert_allclose(held[name], 0, atol=1e-11)  # round-off of the pose
    axis = dataset["direction"].sel(axis="helix").values
    for sign in (1, -1):
        shift_A = guided["displacement"].sel(sign=sign).values
        turn = guided["rotation"].sel(sign=sign).values
        if wave == "extension":
            np.testing.assert_allclose(turn, 0, atol=1e-11)
            np.testing.assert_allclose(shift_A, (shift_A @ axis) * axis, atol=1e-11)
        else:
            np.testing.assert_allclose(turn, (turn @ axis) * axis, atol=1e-11)
            # The centre goes around the helix axis with it.
            arm_A = (guided["centre"] - guided["pivot"]).values
            carried = Rotation.from_rotvec(turn).apply(arm_A) - arm_A
            np.testing.assert_allclose(shift_A, carried, atol=1e-9)


def test_energy_paid_is_half_of_what_the_load_gave(relaxed: Any, load: Load) -> None:
    # At a linear minimum the load's work F x goes half into strain.
    dataset = load("extension", 1.0)
    work = 5.0 / PN_PER_KJ_PER_MOL_NM * np.abs(moved(dataset, "extension")[:, -1])
    loaded = dataset["total_energy"].values[:, 0] - relaxed.record.energy_kJ_per_mol
    # The loaded energy is the strain's less the load's work: -F x/2. Anharmonic: 10 %.
    np.testing.assert_allclose(loaded, -work / 2, rtol=0.1)


def test_a_load_that_nothing_withstands_is_named(load: Load) -> None:
    # 1,000 times 5 pN pull any double helix apart.
    dataset = load("extension", 1000.0)
    assert "+1" in dataset.attrs["left_basin"]
    assert dataset.attrs["load"] == 5000.0
    # In place of another structure's: the linear response, finite and ten times that of a tenth.
    response = float(dataset["linear_response"].sel(lock="nothing"))
    plus = moved(dataset, "extension")[0, -1]
    assert plus * 10 == pytest.approx(response * 5000, rel=1e-3)


def test_base_pairs_are_at_rest_at_the_minimum(relaxed: Any, load: Load) -> None:
    dataset = load("twist", 1.0)
    assert not dataset["velocity"].values.any()
    assert dataset.sizes["time"] == 1
    # The unloaded energy is the relaxed structure's: what the response is counted from.
    energy, _ = ReferenceForces(relaxed.duplex.system)(relaxed.duplex.positions_nm)
    assert energy == pytest.approx(relaxed.record.energy_kJ_per_mol, rel=1e-12)
