"""The constants of the paper's rod, its limiting speeds, and what a rod refuses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.rod import (
    BEND_1,
    BEND_2,
    EXTENSION,
    SHEAR_1,
    TWIST,
    Rod,
    long_wave_speeds_A_per_ps,
    short_wave_speeds_A_per_ps,
)


def coupled_rod() -> Rod:
    """A straight rod with unequal bends and twist-stretch, roll-twist, shift-rise coupling."""
    stiffness = Rod.paper().stiffness.copy()
    stiffness[BEND_1, BEND_1] *= 2
    for i, j, share in ((EXTENSION, TWIST, -0.3), (BEND_2, TWIST, 0.4), (SHEAR_1, EXTENSION, 0.2)):
        coupling = share * np.sqrt(stiffness[i, i] * stiffness[j, j])
        stiffness[i, j] = stiffness[j, i] = coupling
    return replace(Rod.paper(), stiffness=stiffness)


@pytest.mark.parametrize(
    ("wave", "speed_A_per_ps"),
    [("shear", 5.034), ("extension", 8.190), ("bend", 8.185), ("twist", 5.056)],
)
def test_short_wave_speeds_of_the_paper(wave: str, speed_A_per_ps: float) -> None:
    # the reference is rounded to 0.001
    assert short_wave_speeds_A_per_ps(Rod.paper())[wave] == pytest.approx(
        speed_A_per_ps, abs=0.0006
    )


def test_mass_per_base_pair_and_moduli_in_daltons_and_kJ_per_mol() -> None:
    rod = Rod.paper()
    # 659 Da/bp is rounded to 1 Da
    assert rod.density_Da_per_nm * rod.spacing_nm == pytest.approx(659, abs=0.5)
    # 2160 pN is 2160/1.66054 kJ/mol/nm; the constant is quoted to 6 digits
    assert rod.stiffness[EXTENSION, EXTENSION] == pytest.approx(2160 / 1.66054, rel=1e-5)
    # D3 = 206 pN nm^2
    assert rod.stiffness[TWIST, TWIST] == pytest.approx(206 / 1.66054, rel=1e-5)


@pytest.mark.parametrize("twist_rad_per_nm", [0.0, 1.76])
def test_long_waves_of_a_coupled_rod_follow_the_relaxed_stiffness(twist_rad_per_nm: float) -> None:
    rod = replace(coupled_rod(), omega0_rad_per_nm=np.array([0.0, 0.0, twist_rad_per_nm]))
    wavenumber = 1e-3
    # at k = 0 the two flexural branches of the untwisted rod lie below the axial ones
    first = 0 if twist_rad_per_nm else 2
    frequencies = dispersion(rod, [wavenumber], lattice=False)[0, first : first + 2]
    speeds = long_wave_speeds_A_per_ps(rod)
    # corrections are of order (k/1.42 per nm)^2 < 1e-5
    assert sorted(speeds.values()) == pytest.approx(frequencies / wavenumber * 10, rel=1e-5)
    unrelaxed = short_wave_speeds_A_per_ps(rod)
    # the couplings chosen soften the waves by several per cent: the two must not agree
    assert abs(speeds["twist"] / unrelaxed["twist"] - 1) > 0.02


def test_long_waves_of_a_coupled_twisted_rod_are_those_of_the_rod_averaged_about_its_axis() -> None:
    rod = replace(coupled_rod(), omega0_rad_per_nm=np.array([0.0, 0.0, 1.76]))
    wavenumber = 1e-3
    twisted = dispersion(rod, [wavenumber], lattice=False)[0]
    averaged = dispersion(rod.averaged_about_axis(), [wavenumber], lattice=False)[0]
    # at k -> 0 the two axial waves touch zero; bend sits at k = twist in this frame.
    # corrections are of order (k/1.42 per nm)^2 < 1e-5
    assert twisted[:2] == pytest.approx(averaged[2:4], rel=1e-5)


def test_long_bends_of_an_anisotropic_twisted_rod_see_the_harmonic_mean() -> None:
    stiffness = Rod.paper().stiffness.copy()
    stiffness[BEND_1, BEND_1] *= 3
    twist, q = 1.76, 0.01
    rod = replace(Rod.paper(), stiffness=stiffness, omega0_rad_per_nm=np.array([0.0, 0.0, twist]))
    bend = dispersion(rod, [twist + q], lattice=False)[0, 0]
    averaged = dispersion(rod.averaged_about_axis(), [q], lattice=False)[0, 0]
    # harmonic mean of D1, D2: corrections of order (q/twist)^2 = 3e-5
    assert bend == pytest.approx(averaged, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"density_Da_per_nm": -1.0}, "density"),
        ({"spacing_nm": np.nan}, "spacing"),
        ({"inertia_Da_nm": np.diag([1.0, 1.0, -1.0])}, "not positive definite"),
        ({"stiffness": np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])}, "not positive definite"),
        ({"stiffness": np.eye(6) + np.eye(6, k=1)}, "not symmetric"),
        ({"stiffness": np.eye(3)}, "shape"),
        ({"gamma0": np.array([0.0, 0.0, np.inf])}, "not finite"),
    ],
)
def test_impossible_rods_are_refused(change: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(Rod.paper(), **change)
