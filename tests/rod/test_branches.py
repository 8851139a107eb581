"""Branches through crossings, avoided crossings and degenerate waves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.rod.branches import follow_branches
from dnawaves.rod.dispersion import bend_shear_branches, lattice_frequency
from dnawaves.rod.lab_frame import laboratory_shares
from dnawaves.rod.plane_waves import MOTIONS, PlaneWaves
from dnawaves.rod.rod import BEND_1, BEND_2, Rod, short_wave_speeds_A_per_ps

PAPER = Rod.paper()
TWISTED = Rod.paper(twisted=True)
TURN = TWISTED.omega0_rad_per_nm[2]
SPEED = short_wave_speeds_A_per_ps(PAPER)
ZONE_EDGE = np.pi / PAPER.spacing_nm


def with_bends(ratio: float) -> Rod:
    """The paper's twisted rod with D1/D2 = ratio, harmonic mean kept."""
    stiffness = TWISTED.stiffness.copy()
    mean = stiffness[BEND_1, BEND_1]
    stiffness[BEND_1, BEND_1] = mean * (1 + ratio) / 2
    stiffness[BEND_2, BEND_2] = mean * (1 + 1 / ratio) / 2
    return replace(TWISTED, stiffness=stiffness)


def smoothness(waves: PlaneWaves) -> np.ndarray:
    """Return the smallest overlap (branches,) of a polarisation with that at the next step."""
    return np.abs(np.einsum("kib,kib->kb", waves.motion[1:].conj(), waves.motion[:-1])).min(axis=0)


@pytest.mark.parametrize("lattice", [False, True])
@pytest.mark.parametrize("points", [2, 12, 301])
def test_branches_of_the_isotropic_rod_go_straight_on_through_every_crossing(
    lattice: bool, points: int
) -> None:
    k = np.linspace(0.05, ZONE_EDGE, points)
    waves = follow_branches(TWISTED, k, lattice=lattice)
    if lattice:
        axial = [lattice_frequency(k, SPEED[w], PAPER.spacing_nm) for w in ("extension", "twist")]
    else:
        axial = [k * SPEED[w] / 10 for w in ("extension", "twist")]
    bends = [bend_shear_branches(PAPER, k + s, lattice=lattice).T for s in (TURN, -TURN)]
    closed = np.vstack([*axial, *bends]).T
    # found by their order at the first wavenumber alone; round-off of singular values
    assert waves.frequencies_rad_per_ps == pytest.approx(
        closed[:, np.argsort(closed[0])], abs=1e-13 * closed.max()
    )
    # they do cross
    assert np.any(np.diff(waves.frequencies_rad_per_ps[-1]) < 0)
    # an extension stays an extension
    extension = waves.strain_shares()[:, :, list(MOTIONS).index("extension")]
    assert np.isclose(extension.min(axis=0), 1, atol=1e-9).sum() == 1


def test_group_velocities_of_followed_branches_are_their_slopes() -> None:
    k = np.linspace(-2.0, 2.0, 401)
    waves = follow_branches(TWISTED, k, lattice=True)
    slope = np.gradient(waves.frequencies_rad_per_ps, k, axis=0)
    smooth = np.abs(k) > 0.02
    smooth &= np.abs(np.abs(k) - TURN) > 0.02
    # central differences at steps of 0.01/nm; kinks where a frequency is zero are left out
    assert waves.group_velocities_nm_per_ps[smooth][1:-1] == pytest.approx(
        slope[smooth][1:-1], abs=1e-3
    )


def test_branches_that_avoid_each_other_exchange_their_character() -> None:
    k = np.linspace(-0.5, 0.5, 41)
    waves = follow_branches(with_bends(2), k, lattice=False)
    # the pair of one pitch: 0.548 and 0.668 rad/ps at k = 0 (reference rounded to 0.001)
    pair = np.argsort(np.abs(waves.frequencies_rad_per_ps[20] - 0.6))[:2]
    lower, upper = waves.frequencies_rad_per_ps[:, np.sort(pair)].T
    assert (lower[20], upper[20]) == pytest.approx((0.548, 0.668), abs=0.0006)
    assert np.all(lower < upper)
    # from wholly f+ to wholly f- and back
    plus = laboratory_shares(waves)[:, :, 2]
    for branch in pair:
        assert abs(plus[0, branch] - plus[-1, branch]) > 0.9
        assert plus[20, branch] == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize(("excess", "avoided"), [(1e-3, True), (1e-5, True), (0.0, False)])
def test_a_narrow_gap_is_avoided_and_none_is_crossed_on_any_grid(
    excess: float, avoided: bool
) -> None:
    rod = with_bends(1 + excess)
    k = np.array([-0.4, -0.15, 0.17, 0.4])
    waves = follow_branches(rod, k, lattice=False)
    pair = np.argsort(np.abs(waves.frequencies_rad_per_ps[0] - 0.6))[:2]
    before, after = np.diff(waves.frequencies_rad_per_ps[[0, -1]][:, pair], axis=1)[:, 0]
    assert (before * after > 0) == avoided


def test_equal_waves_keep_their_plane() -> None:
    # axes that are not those of the numbers: equal to round-off, not bit by bit
    turn = np.kron(np.eye(2), Rotation.from_rotvec([0, 0, 0.3]).as_matrix())
    rod = replace(PAPER, stiffness=turn @ PAPER.stiffness @ turn.T)
    k = np.linspace(0.05, ZONE_EDGE, 50)
    waves = follow_branches(rod, k, lattice=False)
    # every bend is double; at the steps taken a polarisation changes by less than a tenth
    assert smoothness(waves).min() > 0.9
    # all bends stay in the plane that they have at the first wavenumber: u along one line
    across = waves.velocity_vectors[:, :2] / np.linalg.norm(
        waves.velocity_vectors[:, :2], axis=1, keepdims=True
    ).clip(1e-6)
    in_plane = np.abs(np.einsum("kib,ib->kb", across.conj(), across[0]))
    moving = np.linalg.norm(across[0], axis=0) > 0.5
    assert moving.sum() == 4
    # round-off over the smallest share of u in a wave's motion
    assert in_plane[:, moving] == pytest.approx(np.ones((50, 4)), abs=1e-9)


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), lattice=st.booleans())
def test_branches_of_any_rod_are_continuous_and_the_same_on_a_finer_grid(
    seed: int, lattice: bool
) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(6, 6))
    rod = replace(
        TWISTED,
        stiffness=PAPER.stiffness + 20 * root @ root.T,
        inertia_Da_nm=np.diag([780.0, 62.0, 820.0]),
        centre_nm=np.array([-0.118, 0.0, 0.0]),
    )
    coarse, fine = (np.linspace(0.0, ZONE_EDGE, n) for n in (13, 193))
    first, second = (follow_branches(rod, k, lattice=lattice) for k in (coarse, fine))
    # branches of a generic rod do not cross: both are sorted, whatever the steps
    assert first.frequencies_rad_per_ps == pytest.approx(
        second.frequencies_rad_per_ps[::16], abs=1e-12
    )
    assert np.all(np.diff(first.frequencies_rad_per_ps, axis=1) > -1e-9)


def test_wavenumbers_that_do_not_ascend_are_refused() -> None:
    with pytest.raises(InputError, match="ascend"):
        follow_branches(PAPER, [0.0, 1.0, 0.5], lattice=False)
