"""Drive frequencies: given, in a range, by mode number; each with its ramp and its record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.finite_rod import COORDINATE_SETS, FiniteRod
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.models import Environment, NamedDuplex, SceneSpec, SystemSpec
from dnawaves.trajectory.drive import mode_frequency_GHz
from dnawaves.trajectory.plan import make_plan
from dnawaves.units import GHZ_PER_RAD_PER_PS

HELD = {"first": "held", "last": "held"}
# Two values that no rod of the paper has.
ESTIMATES = {"extension": 15.0, "twist": 6.0}
PAIRS, SPACING_A = 24, 3.3
LENGTH_A = (PAIRS - 1) * SPACING_A


@pytest.fixture(scope="module")
def driven(make_scene: Callable[..., SceneSpec]) -> Callable[..., SceneSpec]:
    spec = SystemSpec(
        duplex=NamedDuplex(name="long", sequence="CGATCAGTCAGCTAGCATGCGTAC"),
        environment_name="condensed",
        environment=Environment(),
    )

    def make(wave: str, ends: Any = HELD, **more: Any) -> SceneSpec:
        amplitude = "force_pN" if wave in ("extension", "shear") else "torque_pN_nm"
        excitation = {"kind": "periodic", "wave": wave, amplitude: 20, **more}
        return make_scene(SimpleNamespace(spec=spec), excitation, ends)

    return make


def mode_GHz(scene: SceneSpec, mode: int, spacing_A: float = SPACING_A) -> float:
    return mode_frequency_GHz(scene, mode, ESTIMATES, spacing_A)


@pytest.mark.parametrize(("wave", "speed"), ESTIMATES.items())
@pytest.mark.parametrize("mode", [1, 2, 3])
def test_axial_modes_of_the_measured_rod(
    driven: Callable[..., SceneSpec], wave: str, speed: float, mode: int
) -> None:
    found = mode_GHz(driven(wave, modes=[mode], rod="measured"), mode)
    # n V/2L of the continuous rod, lowered by the lattice as sin(x)/x with x = pi n/(2 (N - 1)).
    phase = np.pi * mode / 2 / (PAIRS - 1)
    expected = 1e3 * mode * speed / (2 * LENGTH_A) * np.sin(phase) / phase
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("ends", "halves"),
    [
        (HELD, 2),
        # A quarter wave fits between a free end and a held one, at either end.
        ({"first": "free", "last": "held"}, 1),
        ({"first": "held", "last": "free"}, 1),
        ({"first": "free", "last": "free"}, 2),
        (
            {"first": "restrained", "last": "restrained", "stiffness_pN_per_nm": 1000},
            2,
        ),
    ],
)
def test_the_lowest_mode_follows_from_the_ends(
    driven: Callable[..., SceneSpec], ends: dict[str, Any], halves: int
) -> None:
    # Periodic scenes have both ends held; the theory knows the others too.
    scene = driven("twist", modes=[1], rod="paper")
    scene = scene.model_copy(update={"ends": type(scene.ends).model_validate(ends)})
    speed = short_wave_speeds_A_per_ps(Rod.paper())["twist"]
    quarters_GHz = 1e3 * speed / (4 * LENGTH_A)
    # The lattice of 24 base pairs is up to half a step longer than the rod at each free end.
    assert mode_GHz(scene, 1) == pytest.approx(halves * quarters_GHz, rel=1 / (PAIRS - 1))


@pytest.mark.parametrize(("mode", "tolerance"), [(1, 0.005), (2, 0.005), (3, 0.005)])
def test_bend_modes_are_those_of_the_exact_timoshenko_rod(
    driven: Callable[..., SceneSpec], mode: int, tolerance: float
) -> None:
    rod = FiniteRod(Rod.paper(), LENGTH_A / 10, ("held", "held"), COORDINATE_SETS["bend"])
    exact_GHz = rod.frequencies_rad_per_ps(3) * GHZ_PER_RAD_PER_PS
    found = mode_GHz(driven("bend", modes=[mode], rod="paper"), mode)
    # The lattice differs by about (q a)²/24, q the wavenumber of mode 3: 0.7 %.
    assert found == pytest.approx(exact_GHz[mode - 1], rel=tolerance)
    # Clamped, the lowest bend is far from the rule n V/2L of the other waves.
    assert found < 0.5 * 1e3 * mode * 8.2 / (2 * LENGTH_A)


def test_shear_modes_start_at_the_cut_off(driven: Callable[..., SceneSpec]) -> None:
    rod = replace(Rod.paper(), spacing_nm=SPACING_A / 10)
    # Of waves of one phase everywhere: sqrt(C/I).
    cut_off_GHz = np.sqrt(rod.stiffness[0, 0] / rod.inertia_Da_nm[0, 0]) * GHZ_PER_RAD_PER_PS
    scene = driven("shear", modes=[1, 2, 3], rod="paper")
    found = [mode_GHz(scene, mode) for mode in (1, 2, 3)]
    # Above it, and near: the branch rises with the wavenumber squared at first.
    assert cut_off_GHz < found[0] < found[1] < found[2] < 1.3 * cut_off_GHz


def test_a_mode_that_the_chain_does_not_have_is_refused(driven: Callable[..., SceneSpec]) -> None:
    scene = driven("shear", {**HELD, "pairs": 3}, modes=[20], rod="paper")
    # Of 24 base pairs, two at either end are beyond what holds the wave.
    with pytest.raises(InputError, match="mode 20 of 20 base pairs"):
        mode_GHz(scene, 20)


def test_each_mode_has_its_member_its_ramp_and_its_record(
    driven: Callable[..., SceneSpec],
) -> None:
    scene = driven("extension", modes=[3, 1], rod="measured", periods=4, ramp_periods=1.5)
    assert scene.members == ("f1", "f2")
    plans = [make_plan(scene, member, ESTIMATES, LENGTH_A, SPACING_A) for member in scene.members]
    assert [plan.drive_mode for plan in plans] == [3, 1]
    for plan, mode in zip(plans, (3, 1), strict=True):
        assert plan.frequency_GHz == pytest.approx(mode_GHz(scene, mode), rel=1e-12)
        period_ps = 1e3 / plan.frequency_GHz
        assert plan.ramp_ps == pytest.approx(1.5 * period_ps, rel=1e-12)
        # Four periods, rounded up to a frame.
        assert 0 <= (plan.frames - 1) * plan.interval_ps - 4 * period_ps < plan.interval_ps


def test_a_range_is_driven_in_equal_steps(driven: Callable[..., SceneSpec]) -> None:
    scene = driven("shear", range_GHz={"from": 50, "to": 80, "points": 4})
    plans = [make_plan(scene, member, ESTIMATES, LENGTH_A, SPACING_A) for member in scene.members]
    assert [plan.frequency_GHz for plan in plans] == pytest.approx([50, 60, 70, 80], rel=1e-12)
    assert {plan.drive_mode for plan in plans} == {None}
    # As the file of a frozen scene is read again.
    assert SceneSpec.model_validate_json(scene.model_dump_json()) == scene


def test_replicas_of_one_frequency_are_driven_alike(driven: Callable[..., SceneSpec]) -> None:
    from dnawaves.trajectory.drive import drive_of

    scene = driven("twist", frequencies_GHz=[40, 60])
    found = [
        drive_of(scene, member, ESTIMATES, LENGTH_A, SPACING_A).frequency_GHz
        for member in ("f1r1", "f1r2", "f2r1")
    ]
    assert found == [40, 40, 60]
