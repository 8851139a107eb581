"""Dispersion of the general rod against closed forms, and the errata of the paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigvals
from scipy.optimize import brentq

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import (
    bend_shear_branches,
    dispersion,
    eq46_expanded_residual,
    eq46_factorised_residual,
    lattice_frequency,
    lattice_speed_from_frequency,
    strain_operator,
    transverse_constants,
)
from dnawaves.rod.rod import BEND_1, BEND_2, Rod, short_wave_speeds_A_per_ps

PAPER = Rod.paper()
TWISTED = Rod.paper(twisted=True)
TWIST = TWISTED.omega0_rad_per_nm[2]
SPEED = short_wave_speeds_A_per_ps(PAPER)
ZONE_EDGE = np.pi / PAPER.spacing_nm
WAVENUMBERS = np.linspace(-1.2, 1.2, 61) * ZONE_EDGE


def closed_forms(rod: Rod, wavenumbers: np.ndarray, transverse: list, lattice: bool) -> np.ndarray:
    """All six frequencies: extension and twist at k, bend and shear at the given wavenumbers."""
    if lattice:
        axial = [lattice_frequency(wavenumbers, SPEED[w], rod.spacing_nm) for w in AXIAL_WAVES]
    else:
        axial = [np.abs(wavenumbers) * SPEED[w] / 10 for w in AXIAL_WAVES]
    branches = [bend_shear_branches(rod, q, lattice=lattice) for q in transverse]
    return np.sort(np.concatenate([np.stack(axial, -1), *branches], axis=-1), axis=-1)


AXIAL_WAVES = ("extension", "twist")


@pytest.mark.parametrize("lattice", [False, True])
def test_untwisted_isotropic_rod_has_the_closed_form_dispersion(lattice: bool) -> None:
    expected = closed_forms(PAPER, WAVENUMBERS, [WAVENUMBERS] * 2, lattice)
    # round-off of singular values, absolute in units of the largest frequency (13 rad/ps)
    assert dispersion(PAPER, WAVENUMBERS, lattice=lattice) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("lattice", [False, True])
def test_twist_is_a_gauge_of_the_isotropic_rod(lattice: bool) -> None:
    shifted = [WAVENUMBERS + TWIST, WAVENUMBERS - TWIST]
    expected = closed_forms(PAPER, WAVENUMBERS, shifted, lattice)
    # round-off, as above
    assert dispersion(TWISTED, WAVENUMBERS, lattice=lattice) == pytest.approx(expected, abs=1e-12)


def test_cut_off_of_the_upper_branch_and_long_wave_bend() -> None:
    lower, upper = bend_shear_branches(PAPER, 0.01, lattice=False)
    # reference 1.423 rad/ps rounded to 0.001
    assert upper == pytest.approx(1.423, abs=0.0006)
    # sqrt(D/rho) = 28.96 A^2/ps rounded to 0.01; q = 0.001/A; corrections of order 1e-5
    assert lower / 0.001**2 == pytest.approx(28.96, abs=0.006)


def test_the_two_branches_reach_the_short_wave_speeds_only_far_beyond_the_zone_edge() -> None:
    q = np.array([1e3, ZONE_EDGE])
    speeds = bend_shear_branches(PAPER, q, lattice=False) / q[:, np.newaxis] * 10
    # at 1000/nm the cut-off contributes (1.4/850)^2
    assert speeds[0] == pytest.approx([SPEED["shear"], SPEED["bend"]], rel=1e-4)
    # at the zone edge of base pairs the upper branch is still off by more than a per cent
    assert speeds[1, 1] / SPEED["bend"] - 1 > 0.01


@pytest.mark.parametrize(("wavelength_bp", "error_percent"), [(12, -1.1), (6, -4.5), (4, -10.0)])
def test_lattice_error_of_extension(wavelength_bp: int, error_percent: float) -> None:
    k = 2 * np.pi / (wavelength_bp * PAPER.spacing_nm)
    speed = lattice_frequency(k, SPEED["extension"], PAPER.spacing_nm) / k * 10
    # the reference is rounded to 0.1 %
    assert 100 * (speed / SPEED["extension"] - 1) == pytest.approx(error_percent, abs=0.06)


def test_speed_from_lattice_frequency_inverts_the_dispersion() -> None:
    k = np.linspace(0.1, 9, 20)
    frequency = lattice_frequency(k, 15.4, 0.334)
    # round-off
    assert lattice_speed_from_frequency(frequency, k, 0.334) == pytest.approx(15.4, rel=1e-13)
    with pytest.raises(InputError, match="wavenumber 0"):
        lattice_speed_from_frequency(0.1, 0.0, 0.334)


@pytest.mark.parametrize(
    ("ratio", "pair"), [(1, (0.600, 0.600)), (2, (0.548, 0.668)), (4, (0.515, 0.739))]
)
def test_anisotropic_bend_splits_the_wave_of_one_pitch(ratio: float, pair: tuple) -> None:
    stiffness = TWISTED.stiffness.copy()
    harmonic_mean = stiffness[BEND_1, BEND_1]
    stiffness[BEND_1, BEND_1] = harmonic_mean * (1 + ratio) / 2
    stiffness[BEND_2, BEND_2] = harmonic_mean * (1 + 1 / ratio) / 2
    frequencies = dispersion(replace(TWISTED, stiffness=stiffness), [0.0], lattice=False)[0]
    # the reference is rounded to 0.001
    assert frequencies[2:4] == pytest.approx(pair, abs=0.0006)


def test_two_branches_touch_zero_at_rest_and_one_at_each_wave_of_one_pitch() -> None:
    frequencies = dispersion(TWISTED, [0.0, TWIST, -TWIST, 0.5], lattice=False)
    # round-off of singular values against the smallest finite frequency of 0.25 rad/ps
    assert list((frequencies < 1e-12).sum(axis=1)) == [2, 1, 1, 0]
    untwisted = dispersion(PAPER, [0.0], lattice=False)
    assert (untwisted < 1e-12).sum() == 4


def roots_of_the_twisted_rod() -> tuple[np.ndarray, np.ndarray]:
    """Return (k, omega) of the four bend/shear branches, 0.1 to 15 rad/nm."""
    k = np.linspace(0.1, 15, 150)
    omega = np.concatenate(
        [bend_shear_branches(PAPER, k + s * TWIST, lattice=False) for s in (1, -1)], axis=1
    )
    return np.broadcast_to(k[:, np.newaxis], omega.shape), omega


def test_eq46_holds_when_corrected_and_fails_as_printed() -> None:
    k, omega = roots_of_the_twisted_rod()
    # the reference's 3e-13: round-off, grown by the poles of the expanded form near some roots
    assert np.max(eq46_expanded_residual(TWISTED, k, omega)) < 3e-13
    printed = eq46_expanded_residual(TWISTED, k, omega, as_printed=True)
    # a relation that held would give 1e-12 here; 0.99 is the reference's upper end
    assert np.median(printed) > 0.1
    assert np.max(printed) > 0.99


def test_how_far_the_printed_eq46_is_off_has_no_lower_end() -> None:
    # The reference's 0.06 belongs to a grid. The misprint drops out where k or omega is zero and
    # in very short waves, and on one branch the residual passes through zero at 0.651 rad/A.
    at_zero = brentq(lambda k: signed_misprint(k, -TWIST, 1), 6.0, 7.0, xtol=1e-12)
    assert at_zero == pytest.approx(6.51, abs=0.005)
    upper = bend_shear_branches(PAPER, at_zero - TWIST, lattice=False)[1]
    assert eq46_expanded_residual(TWISTED, at_zero, upper, as_printed=True) < 1e-9
    slow = bend_shear_branches(PAPER, 1.8 - TWIST, lattice=False)[0]
    # 2.5e-4 at 0.18 rad/A, near the wave of one pitch, whose frequency is zero
    assert eq46_expanded_residual(TWISTED, 1.8, slow, as_printed=True) == pytest.approx(
        2.5e-4, rel=0.02
    )


def signed_misprint(k: float, shift: float, branch: int) -> float:
    """Return left minus right of the printed eq. 46, P^2 - Q^2, at a root of the true one."""
    omega = float(bend_shear_branches(PAPER, k + shift, lattice=False)[branch])
    constants = transverse_constants(TWISTED)
    w2, misprint = omega**2, (TWIST / 10) ** 4 * 100
    detuning = constants.inertia * w2 - constants.bend * (k**2 + TWIST**2)
    coupling = constants.density * constants.shear * constants.stretch**2 * w2
    coupling /= detuning**2 - 4 * (k * constants.bend) ** 2 * misprint
    diagonal = constants.density * w2 - constants.shear * (k**2 + TWIST**2) - coupling * detuning
    return diagonal**2 - (2 * k * TWIST * (constants.shear + coupling * constants.bend)) ** 2


def test_factorised_eq46_vanishes_at_the_roots_and_only_there() -> None:
    k, omega = roots_of_the_twisted_rod()
    nearest = np.abs(eq46_factorised_residual(TWISTED, k, omega)).min(axis=-1)
    # round-off of a difference of two terms relative to their sum
    assert nearest.max() < 1e-14
    # |k + twist| sqrt(D/I) is the spurious root that clearing the denominators brings in
    spurious = np.abs(k[:, 0] + TWIST) * SPEED["bend"] / 10
    assert np.abs(eq46_factorised_residual(TWISTED, k[:, 0], spurious)).min() > 1e-4


def test_closed_forms_refuse_a_rod_they_do_not_describe() -> None:
    stiffness = PAPER.stiffness.copy()
    stiffness[BEND_1, BEND_1] *= 1.1
    for change in ({"stiffness": stiffness}, {"centre_nm": np.array([0.1, 0.0, 0.0])}):
        with pytest.raises(InputError, match="averaged_about_axis"):
            bend_shear_branches(replace(PAPER, **change), 1.0, lattice=False)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    k=st.floats(0.0, 15.0),
    lattice=st.booleans(),
)
def test_every_stable_rod_has_real_frequencies_even_in_the_wavenumber(
    seed: int, k: float, lattice: bool
) -> None:
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(6, 6)), rng.normal(size=(3, 3))
    rod = replace(
        PAPER,
        stiffness=PAPER.stiffness + 100 * roots[0] @ roots[0].T,
        inertia_Da_nm=PAPER.inertia_Da_nm + 100 * roots[1] @ roots[1].T,
        gamma0=np.array([0.1, -0.1, 1.0]) * rng.normal(1, 0.1, 3),
        omega0_rad_per_nm=rng.normal(size=3),
    )
    plus, minus = dispersion(rod, [k, -k], lattice=lattice)
    # M w^2 v = L* K L v, solved without use of its symmetry
    strain = strain_operator(rod, [k], lattice=lattice)[0]
    squared = eigvals(strain.conj().T @ rod.stiffness @ strain, rod.mass)
    # round-off relative to the largest squared frequency
    tolerance = 1e-9 * np.abs(squared).max()
    assert np.abs(squared.imag).max() < tolerance
    assert np.sort(squared.real) == pytest.approx(plus**2, abs=tolerance)
    # round-off relative to the largest frequency
    assert plus == pytest.approx(minus, abs=1e-12 * plus.max())
