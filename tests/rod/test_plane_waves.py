"""Velocities, polarisations and participation of the plane waves of a rod."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import bend_shear_branches, dispersion, strain_operator
from dnawaves.rod.limits import long_wave_speeds_A_per_ps
from dnawaves.rod.plane_waves import MOTIONS, PlaneWaves, plane_waves
from dnawaves.rod.rod import (
    BEND_1,
    TWIST,
    Rod,
    axial_stiffness,
    short_wave_speeds_A_per_ps,
)

PAPER = Rod.paper()
TWISTED = Rod.paper(twisted=True)
TURN = TWISTED.omega0_rad_per_nm[2]
SPEED = short_wave_speeds_A_per_ps(PAPER)


def random_rod(seed: int) -> Rod:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(6, 6))
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 100 * root @ root.T,
        inertia_Da_nm=np.diag([780.0, 62.0, 820.0]),
        gamma0=np.array([0.2, -0.2, 1.0]) * rng.normal(1, 0.2, 3),
        omega0_rad_per_nm=rng.normal(size=3),
        centre_nm=0.1 * rng.normal(size=3),
    )


def share(waves: PlaneWaves, motion: str) -> np.ndarray:
    return waves.strain_shares()[:, :, list(MOTIONS).index(motion)]


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), k=st.floats(0.05, 9.0), lattice=st.booleans())
def test_waves_solve_the_equation_of_motion_and_carry_the_slope_of_their_branch(
    seed: int, k: float, lattice: bool
) -> None:
    rod = random_rod(seed)
    waves = plane_waves(rod, [k, -k], lattice=lattice)
    omega = waves.frequencies_rad_per_ps
    v = waves.velocity_vectors[0]
    strain = strain_operator(rod, [k], lattice=lattice)[0]
    dynamic = strain.conj().T @ rod.stiffness @ strain
    # round-off relative to the largest terms
    assert dynamic @ v == pytest.approx(
        rod.mass @ v * omega[0] ** 2, abs=1e-11 * np.abs(dynamic @ v).max()
    )
    assert v.conj().T @ rod.mass @ v == pytest.approx(np.eye(6), abs=1e-12)
    # the strain of each wave is its frequency times the normalised strain
    assert strain @ v == pytest.approx(
        waves.strain_vectors[0] * omega[0], abs=1e-11 * np.abs(strain @ v).max()
    )
    h = 1e-5
    beside = dispersion(rod, [k - 2 * h, k - h, k + h, k + 2 * h], lattice=lattice)
    slope = (beside[0] - 8 * beside[1] + 8 * beside[2] - beside[3]) / (12 * h)
    gap = np.diff(omega[0]).min(initial=omega[0, 0])
    # five-point rule: round-off 1e-14/h, and h^4 over the fourth power of an avoided gap
    tolerance = 1e-7 + (10 * h / gap) ** 4
    assert waves.group_velocities_nm_per_ps[0] == pytest.approx(slope, abs=tolerance)
    # omega is even in k, so its slope is odd, and where waves are simple so are all of them
    if gap > 1e-6:
        assert waves.group_velocities_nm_per_ps[1] == pytest.approx(
            -waves.group_velocities_nm_per_ps[0], abs=1e-8
        )
    for shares in (waves.kinetic_shares(), waves.strain_shares()):
        assert shares.sum(axis=-1) == pytest.approx(np.ones((2, 6)), abs=1e-12)


def test_at_rest_a_straight_rod_has_four_free_motions_two_of_them_acoustic() -> None:
    waves = plane_waves(PAPER, [0.0], lattice=False)
    # flexural bends start flat, twist and extension at their speeds, the cut-off pair flat
    assert waves.group_velocities_A_per_ps[0] == pytest.approx(
        [0, 0, SPEED["twist"], SPEED["extension"], 0, 0], abs=1e-12
    )
    phase = waves.phase_velocities_A_per_ps[0]
    assert phase[:4] == pytest.approx([0, 0, SPEED["twist"], SPEED["extension"]], abs=1e-12)
    assert np.isinf(phase[4:]).all()
    # to first order in k what moves is pure: bend, bend, twist, extension; the cut-off is shear
    assert share(waves, "bend")[0] == pytest.approx([1, 1, 0, 0, 0, 0], abs=1e-12)
    assert share(waves, "twist")[0] == pytest.approx([0, 0, 1, 0, 0, 0], abs=1e-12)
    assert share(waves, "extension")[0] == pytest.approx([0, 0, 0, 1, 0, 0], abs=1e-12)
    assert share(waves, "shear")[0] == pytest.approx([0, 0, 0, 0, 1, 1], abs=1e-12)


@pytest.mark.parametrize("lattice", [False, True])
@pytest.mark.parametrize("twist", [0.0, TURN])
def test_acoustic_slopes_of_a_coupled_straight_rod_follow_the_relaxed_stiffness(
    twist: float, lattice: bool
) -> None:
    root = np.random.default_rng(6).normal(size=(6, 6))
    rod = replace(
        PAPER,
        stiffness=PAPER.stiffness + 50 * root @ root.T,
        omega0_rad_per_nm=np.array([0, 0, twist]),
        inertia_Da_nm=np.diag([780.0, 62.0, 820.0]),
        centre_nm=np.array([-0.118, 0.03, 0.0]),
    )
    slopes = plane_waves(rod, [0.0], lattice=lattice).group_velocities_A_per_ps[0]
    acoustic = slopes[:2] if twist else slopes[2:4]
    # both are exact: round-off
    assert acoustic == pytest.approx(relaxed_speeds(rod), rel=1e-10)
    assert acoustic == pytest.approx(sorted(long_wave_speeds_A_per_ps(rod).values()), rel=1e-10)


def relaxed_speeds(rod: Rod) -> list[float]:
    """Speeds of extension and twist of a straight rod, A/ps: the Schur complement's closed form.

    A twisted rod turns about the line of its origins, an untwisted one about its centres of mass,
    because its axis gives way to a force across it at no cost.
    """
    twisted = rod.omega0_rad_per_nm[2] != 0
    inertia = rod.mass[TWIST, TWIST] if twisted else rod.inertia_Da_nm[2, 2]
    squared = scipy.linalg.eigh(
        axial_stiffness(rod), np.diag([rod.density_Da_per_nm, inertia]), eigvals_only=True
    )
    return list(10 * np.sqrt(squared))


def test_the_full_schur_complement_needs_intrinsic_twist() -> None:
    # roll and twist coupled: where the axis is straight and untwisted the bend cannot relax
    stiffness = PAPER.stiffness.copy()
    coupling = 0.4 * np.sqrt(stiffness[BEND_1, BEND_1] * stiffness[TWIST, TWIST])
    stiffness[BEND_1, TWIST] = stiffness[TWIST, BEND_1] = coupling
    straight = replace(PAPER, stiffness=stiffness)
    twisted = replace(straight, omega0_rad_per_nm=np.array([0, 0, TURN]))
    relaxed = 1 / np.linalg.inv(stiffness)[TWIST, TWIST]
    # 1 - 0.4^2 = 0.84 of the stiffness, 0.917 of the speed; closed forms, round-off
    assert relaxed == pytest.approx(0.84 * stiffness[TWIST, TWIST], rel=1e-12)
    assert axial_stiffness(twisted)[1, 1] == pytest.approx(relaxed, rel=1e-12)
    assert axial_stiffness(straight)[1, 1] == pytest.approx(stiffness[TWIST, TWIST], rel=1e-12)
    slow, fast = (
        plane_waves(rod, [0.0], lattice=False).group_velocities_A_per_ps[0, branch]
        for rod, branch in ((twisted, 0), (straight, 2))
    )
    assert slow == pytest.approx(np.sqrt(0.84) * SPEED["twist"], rel=1e-10)
    assert fast == pytest.approx(SPEED["twist"], rel=1e-10)


def test_the_upper_branch_is_shear_in_long_waves_and_bend_in_short_ones() -> None:
    waves = plane_waves(PAPER, [0.01, 1000.0], lattice=False)
    bend, shear = share(waves, "bend"), share(waves, "shear")
    # corrections of order (k/2.83 per nm)^2 and its inverse, here 1e-5
    assert bend[0, :2] == pytest.approx([1, 1], abs=1e-4)
    assert shear[0, 4:] == pytest.approx([1, 1], abs=1e-4)
    order = np.argsort(bend[1])
    # at 1000/nm the upper bends (8.185 A/ps) lie just below extension (8.190 A/ps)
    assert waves.phase_velocities_A_per_ps[1, order[-2:]] == pytest.approx(
        [SPEED["bend"]] * 2, rel=1e-4
    )
    assert shear[1, :2] == pytest.approx([1, 1], abs=1e-4)
    assert waves.phase_velocities_A_per_ps[1, :2] == pytest.approx([SPEED["shear"]] * 2, rel=1e-4)


def closed_slope(k: float, shift: float, branch: int) -> float:
    h = 1e-4
    beside = bend_shear_branches(PAPER, [k + shift - h, k + shift + h], lattice=False)[:, branch]
    return float(beside[1] - beside[0]) / (2 * h) * 10


def test_at_an_exact_crossing_each_wave_keeps_its_own_slope_and_polarisation() -> None:
    def gap(k: float) -> float:
        lower = bend_shear_branches(PAPER, [k + TURN], lattice=False)[0, 0]
        return lower - k * SPEED["extension"] / 10

    k = brentq(gap, 0.5, 9.0, xtol=1e-15)
    waves = plane_waves(TWISTED, [k], lattice=False)
    first = int(np.argmin(np.diff(waves.frequencies_rad_per_ps[0])))
    assert np.diff(waves.frequencies_rad_per_ps[0])[first] < 1e-13
    slopes = waves.group_velocities_A_per_ps[0, first : first + 2]
    # the closed form's slope is a central difference: h^2 = 1e-8
    assert slopes == pytest.approx([closed_slope(k, TURN, 0), SPEED["extension"]], abs=1e-6)
    # slopes tell the two apart to round-off over their difference
    assert share(waves, "extension")[0, first : first + 2] == pytest.approx([0, 1], abs=1e-9)


def test_at_rest_the_waves_of_one_pitch_run_to_both_sides() -> None:
    slopes = plane_waves(TWISTED, [0.0], lattice=False).group_velocities_A_per_ps[0]
    bend, shear = closed_slope(0.0, TURN, 0), closed_slope(0.0, TURN, 1)
    # twist and extension from rest; central differences as above
    assert slopes == pytest.approx(
        [SPEED["twist"], SPEED["extension"], -bend, bend, -shear, shear], abs=1e-6
    )


def test_kinetic_shares_of_an_extension_of_a_twist_and_of_a_long_bend() -> None:
    waves = plane_waves(PAPER, [0.01], lattice=True)
    kinetic = waves.kinetic_shares()[0]
    names = list(MOTIONS)
    # a long bend moves across the axis; its rotation carries (k gyration radius)^2 = 1e-5
    assert kinetic[0, names.index("shear")] == pytest.approx(1, abs=1e-4)
    assert kinetic[2, names.index("twist")] == pytest.approx(1, abs=1e-12)
    assert kinetic[3, names.index("extension")] == pytest.approx(1, abs=1e-12)


def test_wavenumbers_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        plane_waves(PAPER, [0.0, np.nan], lattice=False)
