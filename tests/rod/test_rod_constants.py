"""The constants of the paper's rod, its limiting speeds, and what a rod refuses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.limits import long_wave_speeds_A_per_ps
from dnawaves.rod.rod import (
    BEND_1,
    BEND_2,
    EXTENSION,
    SHEAR_1,
    TWIST,
    Rod,
    cross_matrix,
    short_wave_speeds_A_per_ps,
)
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K


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


def test_scales_of_the_papers_rod() -> None:
    rod = Rod.paper()
    speeds = short_wave_speeds_A_per_ps(rod)
    inertia, shear = rod.inertia_Da_nm[0, 0], rod.stiffness[SHEAR_1, SHEAR_1]
    # G = 1.626, 1/gyration radius 0.283 /A, zone edge 0.924 /A, twist 0.176 rad/A: all rounded
    assert speeds["bend"] / speeds["shear"] == pytest.approx(1.626, abs=6e-4)
    assert np.sqrt(rod.density_Da_per_nm / inertia) / 10 == pytest.approx(0.283, abs=6e-4)
    assert np.pi / rod.spacing_nm / 10 == pytest.approx(0.924, abs=6e-4)
    assert Rod.paper(twisted=True).omega0_rad_per_nm[2] / 10 == pytest.approx(0.176, abs=6e-4)
    # V/a of extension, 2.409 /ps
    assert speeds["extension"] / (10 * rod.spacing_nm) == pytest.approx(2.409, abs=6e-4)
    cut_off = rod.gamma0[2] * np.sqrt(shear / inertia)
    assert cut_off / (2 * np.pi) == pytest.approx(0.2265, abs=6e-5)
    assert 2 * np.pi / cut_off == pytest.approx(4.416, abs=6e-4)


def test_the_papers_inertia_is_half_of_a_cylinders_and_its_pairs_of_speeds_are_no_accident() -> (
    None
):
    rod = Rod.paper()
    # a homogeneous cylinder of 1 nm: rho R^2/4 = 8.05e-34 kg m, twice the paper's 4.03e-34
    cylinder = rod.density_Da_per_nm / 4
    assert rod.inertia_Da_nm[0, 0] / cylinder == pytest.approx(0.5, abs=2e-3)
    solid = replace(rod, inertia_Da_nm=np.diag([cylinder, cylinder, 2 * cylinder]))
    speeds = short_wave_speeds_A_per_ps(solid)
    # 5.79 and 3.58 A/ps are rounded to 0.01
    assert speeds["bend"] == pytest.approx(5.79, abs=0.006)
    assert speeds["twist"] == pytest.approx(3.58, abs=0.006)
    # D/C3 = I/rho makes bend as fast as extension, D3/C = I3/rho twist as fast as shear; the
    # paper's constants, of three digits, obey that to 0.3 and 1 %
    stiffness, gyration = np.diag(rod.stiffness), np.diag(rod.inertia_Da_nm) / rod.density_Da_per_nm
    assert stiffness[BEND_1] / stiffness[EXTENSION] == pytest.approx(gyration[0], rel=3e-3)
    assert stiffness[TWIST] / stiffness[SHEAR_1] == pytest.approx(gyration[2], rel=1e-2)


def test_half_the_stretch_modulus_is_slower_by_the_root_of_two() -> None:
    stiffness = Rod.paper().stiffness.copy()
    stiffness[EXTENSION, EXTENSION] *= 1090 / 2160
    slower = short_wave_speeds_A_per_ps(replace(Rod.paper(), stiffness=stiffness))
    # 5.8 A/ps is rounded to 0.1; half the speed would be 4.1
    assert slower["extension"] == pytest.approx(5.8, abs=0.06)


def test_50_nm_of_persistence_are_the_papers_twist_stiffness() -> None:
    # kT at 300 K in kJ/mol; 2.06e-28 N m^2 is given to 3 digits, 50 nm rounded to 1
    thermal = BOLTZMANN_KJ_PER_MOL_K * 300
    assert Rod.paper().stiffness[TWIST, TWIST] / thermal == pytest.approx(50, abs=0.5)
    assert Rod.paper().stiffness[BEND_1, BEND_1] / thermal == pytest.approx(65, abs=0.5)


@pytest.mark.parametrize("twist_rad_per_nm", [0.0, 1.76])
@pytest.mark.parametrize("centre_nm", [0.0, -0.118])
def test_long_waves_of_a_coupled_rod_follow_the_relaxed_stiffness(
    twist_rad_per_nm: float, centre_nm: float
) -> None:
    rod = replace(
        coupled_rod(),
        omega0_rad_per_nm=np.array([0.0, 0.0, twist_rad_per_nm]),
        centre_nm=np.array([centre_nm, 0.0, 0.0]),
    )
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
    rod = replace(
        coupled_rod(),
        omega0_rad_per_nm=np.array([0.0, 0.0, 1.76]),
        centre_nm=np.array([-0.118, 0.02, 0.0]),
    )
    wavenumber = 1e-3
    twisted = dispersion(rod, [wavenumber], lattice=False)[0]
    averaged = dispersion(rod.averaged_about_axis(), [wavenumber], lattice=False)[0]
    # at k -> 0 the two axial waves touch zero; bend sits at k = twist in this frame.
    # corrections are of order (k/1.42 per nm)^2 < 1e-5
    assert twisted[:2] == pytest.approx(averaged[2:4], rel=1e-5)


def test_a_centre_of_mass_beside_the_origin_couples_the_blocks_of_the_mass() -> None:
    centre = np.array([-0.118, 0.02, 0.03])
    rod = replace(Rod.paper(), centre_nm=centre)
    velocity, rotation = np.random.default_rng(1).normal(size=(2, 3))
    of_centre = velocity + np.cross(rotation, centre)
    energy = rod.density_Da_per_nm * of_centre @ of_centre + rotation @ rod.inertia_Da_nm @ rotation
    six = np.concatenate([velocity, rotation])
    # round-off
    assert six @ rod.mass @ six == pytest.approx(energy, rel=1e-13)


def test_where_the_origin_lies_does_not_change_a_rods_frequencies() -> None:
    # the origin moves off the centre of mass by -c: v -> v + w x c for motions and for strains
    centre = np.array([-0.118, 0.02, 0.03])
    rod = replace(coupled_rod(), omega0_rad_per_nm=np.array([0.1, 0.0, 1.76]))
    move = np.block([[np.eye(3), -cross_matrix(centre)], [np.zeros((3, 3)), np.eye(3)]])
    moved = replace(
        rod,
        stiffness=move.T @ rod.stiffness @ move,
        gamma0=rod.gamma0 - np.cross(rod.omega0_rad_per_nm, centre),
        centre_nm=centre,
    )
    k = np.linspace(0, 9, 5)
    for lattice in (False, True):
        # round-off relative to the highest frequency
        assert dispersion(moved, k, lattice=lattice) == pytest.approx(
            dispersion(rod, k, lattice=lattice), abs=1e-13
        )


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
