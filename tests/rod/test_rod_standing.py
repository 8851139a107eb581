"""Standing waves: the tables of frequencies, and shapes against the chains they belong to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.chain import PlaneChain, ScalarChain
from dnawaves.rod.dispersion import bend_shear_branches
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import (
    HELD_PAIRS,
    Ends,
    axial_frequency_rad_per_ps,
    axial_standing_wave,
    axial_wavenumber,
    bend_standing_wave,
    fixed_fixed_frequency_GHz,
    shear_standing_wave,
)

PAPER = Rod.paper()
SPEED = short_wave_speeds_A_per_ps(PAPER)
GHZ_PER_RAD_PER_PS = 1e3 / (2 * np.pi)
ENDS: list[Ends] = ["held", "one_held", "free"]


@pytest.mark.parametrize(
    ("pairs", "extension_GHz", "twist_GHz"),
    [(12, 100.4, 61.95), (24, 50.2, 30.98), (48, 25.1, 15.5)],
)
def test_fixed_fixed_frequencies_of_the_paper(
    pairs: int, extension_GHz: float, twist_GHz: float
) -> None:
    for wave, expected in (("extension", extension_GHz), ("twist", twist_GHz)):
        frequency = fixed_fixed_frequency_GHz(1, SPEED[wave], pairs * 0.34)
        # the reference holds three digits
        assert frequency == pytest.approx(expected, rel=0.003)


def test_holding_the_end_masses_shortens_the_rod() -> None:
    arguments = (12, 1, SPEED["extension"], 0.34)
    pairs, mode, speed, spacing = arguments
    held, free = (
        axial_frequency_rad_per_ps(pairs, mode, ends, speed, spacing) * GHZ_PER_RAD_PER_PS
        for ends in ("held", "free")
    )
    # the reference is rounded to 0.1 GHz
    assert held == pytest.approx(109.1, abs=0.06)
    assert free == pytest.approx(100.1, abs=0.06)


@pytest.mark.parametrize("ends", ENDS)
def test_axial_standing_waves_are_the_modes_of_the_chain(ends: Ends) -> None:
    pairs = 9
    chain = ScalarChain.from_speed(pairs, SPEED["twist"], 0.34, HELD_PAIRS[ends])
    frequencies = chain.frequencies_rad_per_ps[chain.frequencies_rad_per_ps > 0]
    for mode, expected in enumerate(frequencies, start=1):
        frequency = axial_frequency_rad_per_ps(pairs, mode, ends, SPEED["twist"], 0.34)
        # round-off of the eigenproblem
        assert frequency == pytest.approx(expected, rel=1e-9)
        shape = axial_standing_wave(pairs, mode, ends)
        restoring = (chain.stiffness @ shape)[chain.free]
        # K shape = w^2 M shape with unit masses, to round-off of the largest w^2
        assert restoring == pytest.approx(expected**2 * shape[chain.free], abs=1e-12)
        assert np.all(shape[~chain.free] == 0)
    with pytest.raises(InputError, match="allowed"):
        axial_wavenumber(pairs, len(frequencies) + 1, ends, 0.34)


# (ends, pairs): f1, f2, f3 in GHz
TIMOSHENKO: dict[tuple[Ends, int], tuple[float, float, float]] = {
    ("held", 12): (43.3, 92.7, 150),
    ("held", 24): (13.8, 33.6, 58.4),
    ("held", 48): (3.75, 9.93, 18.6),
    ("free", 12): (49.6, 107, 168),
    ("free", 24): (14.4, 36.0, 62.9),
    ("free", 48): (3.80, 10.1, 19.1),
    ("one_held", 12): (9.18, 44.6, 100),
    ("one_held", 24): (2.40, 13.8, 34.8),
    ("one_held", 48): (0.61, 3.71, 10.0),
}


@pytest.mark.parametrize(("ends", "pairs"), TIMOSHENKO)
def test_bend_of_the_continuous_rod_is_the_limit_of_a_fine_chain(ends: Ends, pairs: int) -> None:
    points = 160
    # cells per rod: held masses lie at its ends, free ones half a cell inside
    cells = points - {"held": 1.0, "one_held": 0.5, "free": 0.0}[ends]
    fine = replace(PAPER, spacing_nm=pairs * 0.34 / cells)
    frequencies = PlaneChain(fine, points, HELD_PAIRS[ends]).frequencies_rad_per_ps
    lowest = frequencies[frequencies > 0][:3] * GHZ_PER_RAD_PER_PS
    # chain error (3 pi/160)^2/24 < 2e-4; the reference is rounded to three digits
    # (0.5 % at worst) and to 0.01 GHz below 1 GHz
    assert lowest == pytest.approx(TIMOSHENKO[ends, pairs], rel=0.0055, abs=0.0055)


@pytest.mark.parametrize(
    ("pairs", "expected"),
    [(12, (24.4, 78.0, 141)), (24, (6.61, 24.4, 49.2)), (48, (1.69, 6.61, 14.3))],
)
def test_pinned_bends_obey_the_half_wavelength_rule(pairs: int, expected: tuple) -> None:
    q = np.arange(1, 4) * np.pi / (pairs * 0.34)
    frequencies = bend_shear_branches(PAPER, q, lattice=False)[:, 0] * GHZ_PER_RAD_PER_PS
    # the reference holds three digits
    assert frequencies == pytest.approx(expected, rel=0.004)


def test_clamped_bends_break_the_half_wavelength_rule() -> None:
    length = 24 * 0.34
    fine = replace(PAPER, spacing_nm=length / 159)
    clamped = PlaneChain(fine, 160, (0, -1)).frequencies_rad_per_ps[:3]
    rule = bend_shear_branches(PAPER, np.arange(1, 4) * np.pi / length, lattice=False)[:, 0]
    # the reference is rounded to 0.01
    assert clamped / rule == pytest.approx([2.08, 1.38, 1.19], abs=0.006)


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize("pairs", [12, 24])
def test_every_vibration_of_the_plane_is_either_bend_or_shear(ends: Ends, pairs: int) -> None:
    chain = PlaneChain(PAPER, pairs, HELD_PAIRS[ends]).frequencies_rad_per_ps
    found = []
    for wave in (bend_standing_wave, shear_standing_wave):
        mode = 1
        while True:
            try:
                found.append(wave(PAPER, pairs, mode, ends).frequency_rad_per_ps)
            except InputError:
                break
            mode += 1
    # the same numbers, only sorted
    assert sorted(found) == pytest.approx(chain[chain > 0], rel=1e-12)


def test_bends_below_the_cut_off_are_pure_and_shear_waves_lie_above_it() -> None:
    cut_off = bend_shear_branches(PAPER, 0.0, lattice=True)[1]
    for ends in ENDS:
        bends = [bend_standing_wave(PAPER, 24, mode, ends) for mode in range(1, 6)]
        assert all(wave.frequency_rad_per_ps < cut_off and wave.share == 1 for wave in bends)
        shear = shear_standing_wave(PAPER, 24, 1, ends)
        assert shear.frequency_rad_per_ps > cut_off
    # the first shear wave between held ends is nearly the uniform rotation of the cut-off itself:
    # at q = pi/(23 pairs) the upper branch is 1.475 rad/ps; end effects shift q by a few per cent
    held = shear_standing_wave(PAPER, 24, 1, "held")
    upper = bend_shear_branches(PAPER, np.pi / (23 * 0.34), lattice=True)[1]
    assert held.frequency_rad_per_ps == pytest.approx(upper, rel=0.01)
    assert held.share > 0.95


def test_where_the_upper_branch_falls_bend_and_shear_are_not_told_apart() -> None:
    inertia, stiffness = PAPER.inertia_Da_nm / 100, PAPER.stiffness.copy()
    stiffness[[0, 1], [0, 1]] *= 100
    slender = replace(PAPER, inertia_Da_nm=inertia, stiffness=stiffness)
    cut_off, edge = bend_shear_branches(slender, [0.0, np.pi / 0.34], lattice=True)[:, 1]
    # I/rho + D/C = 0.0046 nm^2 is less than (a/2)^2 = 0.029 nm^2
    assert edge < cut_off
    with pytest.raises(InputError, match="upper branch falls"):
        bend_standing_wave(slender, 12, 1, "held")


def test_a_kick_in_the_shape_of_a_bend_stays_in_that_shape() -> None:
    wave = bend_standing_wave(PAPER, 12, 1, "held")
    chain = PlaneChain(PAPER, 12, (0, -1))
    kick = np.stack([wave.displacement, wave.rotation_rad_per_nm], axis=1)
    times = np.linspace(0, 20, 50)
    _, velocity = chain.kick_response(times, kick)
    expected = np.cos(wave.frequency_rad_per_ps * times)[:, np.newaxis, np.newaxis] * kick
    # round-off of the eigenvectors
    assert velocity == pytest.approx(expected, abs=1e-10)
    assert np.abs(wave.displacement).max() == 1.0
