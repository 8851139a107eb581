"""Speeds of any rod in very long and very short waves, and the axis of a bent rod."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.limits import STRAINS, long_wave_speeds_A_per_ps, short_waves
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps

PAPER = Rod.paper()
# a real base pair's inertia and stiffness, pN and pN nm^2 in kJ/mol and nm
REAL = Rod(
    1850.0,
    np.diag([95.0, 1050.0, 1080.0]),
    0.602214 * np.diag([350.0, 570, 1100, 290, 155, 230]),
    0.34,
)
BENT = [
    ([0.0, 0.5, 1.7], [0.0, 0.0, 1.0], 5.361, 3.442),
    ([0.0, 0.0, 1.77], [0.0, -0.3, 0.97], 5.454, 3.496),
    ([0.0, -0.5, 1.7], [0.0, -0.3, 0.97], 5.773, 3.518),
]


def random_rod(seed: int) -> Rod:
    random = np.random.default_rng(seed)
    root, body = random.normal(size=(6, 6)), random.normal(size=(3, 3))
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 20 * root @ root.T,
        inertia_Da_nm=PAPER.inertia_Da_nm + 50 * body @ body.T,
        omega0_rad_per_nm=np.array([0, 0, 1.7]) + 0.4 * random.normal(size=3),
        gamma0=np.array([0, 0, 1.0]) + 0.2 * random.normal(size=3),
        centre_nm=0.1 * random.normal(size=3),
    )


@pytest.mark.parametrize(("omega0", "gamma0", "extension", "twist"), BENT)
def test_long_waves_of_bent_rods(
    omega0: list[float], gamma0: list[float], extension: float, twist: float
) -> None:
    rod = replace(REAL, omega0_rad_per_nm=np.array(omega0), gamma0=np.array(gamma0))
    speeds = long_wave_speeds_A_per_ps(rod)
    # slopes of the frequencies near k = 0, rounded to 0.001
    assert [speeds["extension"], speeds["twist"]] == pytest.approx([extension, twist], abs=6e-4)
    straight = replace(REAL, omega0_rad_per_nm=np.array([0.0, 0.0, np.linalg.norm(omega0)]))
    # what the roll or slide takes away
    assert 1.03 < long_wave_speeds_A_per_ps(straight)["extension"] / speeds["extension"] < 1.125
    # corrections of order (k/pitch)^2 = 1e-6
    lowest = dispersion(rod, [1e-3], lattice=True)[0, :2] / 1e-3 * 10
    assert lowest == pytest.approx(sorted(speeds.values()), rel=1e-5)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), left_handed=st.booleans(), twisted=st.booleans())
def test_a_rod_seen_from_its_axis_is_the_same_rod(
    seed: int, left_handed: bool, twisted: bool
) -> None:
    rod = random_rod(seed)
    turn = rod.omega0_rad_per_nm * twisted * (-1 if left_handed else 1)
    rod = replace(rod, omega0_rad_per_nm=turn)
    straight = rod.on_axis()
    k = np.linspace(0, 9, 5)
    for lattice in (False, True):
        before = dispersion(rod, k, lattice=lattice)
        # round-off relative to the highest frequency
        assert dispersion(straight, k, lattice=lattice) == pytest.approx(
            before, abs=1e-12 * before.max()
        )
    assert np.all(straight.gamma0[:2] == 0) and straight.gamma0[2] > 0
    assert np.all(straight.omega0_rad_per_nm[:2] == 0)
    assert straight.omega0_rad_per_nm[2] == pytest.approx(
        np.sign(turn @ rod.gamma0) * np.linalg.norm(turn), rel=1e-12
    )


@pytest.mark.parametrize(("omega0", "gamma0", "extension", "twist"), BENT)
def test_long_waves_of_a_bent_rod_are_those_of_its_average(
    omega0: list[float], gamma0: list[float], extension: float, twist: float
) -> None:
    rod = replace(REAL, omega0_rad_per_nm=np.array(omega0), gamma0=np.array(gamma0))
    average = rod.averaged_about_axis()
    assert long_wave_speeds_A_per_ps(average) == pytest.approx(
        # both are exact: round-off
        long_wave_speeds_A_per_ps(rod),
        rel=1e-10,
    )
    q = 0.01
    bend = dispersion(rod, [np.linalg.norm(omega0) + q], lattice=False)[0, 0]
    # corrections of order q/twist, 6e-3, squared and over
    assert dispersion(average, [q], lattice=False)[0, 0] == pytest.approx(bend, rel=1e-3)


def test_rods_without_an_axis_or_a_pitch_are_refused() -> None:
    with pytest.raises(InputError, match="no part along the axis"):
        replace(PAPER, omega0_rad_per_nm=np.array([0.0, 0.5, 0.0])).on_axis()
    with pytest.raises(InputError, match="nothing is averaged"):
        PAPER.averaged_about_axis()


def test_short_waves_are_those_of_the_dispersion_relation() -> None:
    rod = random_rod(4)
    k = 1e5
    highest = dispersion(rod, [k], lattice=False)[0] / k * 10
    found = short_waves(rod)
    # the rod's own scales are a few per nm: corrections of some 1e-5
    assert sorted(found.speeds_A_per_ps) == pytest.approx(highest, rel=1e-4)


def test_short_waves_of_an_anisotropic_rod_run_in_two_planes() -> None:
    found = dict(zip(STRAINS, short_waves(REAL).speeds_A_per_ps, strict=True))
    # without couplings each wave is one strain; round-off
    assert short_waves(REAL).shares == pytest.approx(np.ones(6), rel=1e-12)
    # sqrt(C/rho) and sqrt(D/I) of each axis, 1 pN = 0.602214 Da nm/ps^2
    for wave, stiffness, mass in (
        ("shear 1", 350, 1850),
        ("shear 2", 570, 1850),
        ("bend 1", 290, 95),
        ("bend 2", 155, 1050),
    ):
        assert found[wave] == pytest.approx(10 * np.sqrt(0.602214 * stiffness / mass), rel=1e-9)
    papers = short_wave_speeds_A_per_ps(PAPER)
    for wave, speed in zip(STRAINS, short_waves(PAPER).speeds_A_per_ps, strict=True):
        # the isotropic rod's; round-off
        assert speed == pytest.approx(papers[wave.split()[0]], rel=1e-12)
