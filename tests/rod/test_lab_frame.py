"""The material and the laboratory frame: fields, wavenumbers, circular components."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import bend_shear_branches
from dnawaves.rod.lab_frame import (
    laboratory_shares,
    laboratory_wavenumbers,
    to_laboratory,
    to_material,
)
from dnawaves.rod.plane_waves import plane_waves
from dnawaves.rod.rod import Rod

PAPER = Rod.paper()
TWISTED = Rod.paper(twisted=True)
TURN = TWISTED.omega0_rad_per_nm[2]
PLACES = TWISTED.spacing_nm * np.arange(24)


def test_circular_components_turn_by_the_accumulated_twist() -> None:
    material = np.random.default_rng(1).normal(size=(5, 24, 6))
    laboratory = to_laboratory(TWISTED, material, PLACES)
    for first, second in ((0, 1), (3, 4)):
        circular = material[..., first] + 1j * material[..., second]
        # f+_lab(n) = exp(i phi_n) f+_mat(n); round-off
        assert laboratory[..., first] + 1j * laboratory[..., second] == pytest.approx(
            np.exp(1j * TURN * PLACES) * circular, abs=1e-13
        )
    assert laboratory[..., [2, 5]] == pytest.approx(material[..., [2, 5]], abs=1e-14)
    assert to_material(TWISTED, laboratory, PLACES) == pytest.approx(material, abs=1e-13)


@pytest.mark.parametrize("omega0", [[0, 0, TURN], [0, 0, -TURN], [0.3, -0.2, 1.5]])
def test_a_wave_of_the_material_frame_is_three_waves_in_the_laboratory(omega0: list) -> None:
    rod = replace(PAPER, omega0_rad_per_nm=np.array(omega0))
    k, s = 0.7, np.linspace(0, 30, 61)
    real, imaginary = np.random.default_rng(2).normal(size=(2, 6))
    amplitude = real + 1j * imaginary
    wave = amplitude * np.exp(1j * k * s)[:, None]
    seen = to_laboratory(rod, wave.real, s) + 1j * to_laboratory(rod, wave.imag, s)
    waves = np.exp(1j * np.outer(s, laboratory_wavenumbers(rod, k)))
    misfit = np.linalg.lstsq(waves, seen, rcond=None)[1]
    # three exponentials describe all 61 places to round-off, squared
    assert np.abs(misfit).max() < 1e-24 * s.size


@pytest.mark.parametrize("lattice", [False, True])
def test_an_isotropic_rods_waves_do_not_know_of_its_twist(lattice: bool) -> None:
    k = np.linspace(0.1, 9.0, 20)
    waves = plane_waves(TWISTED, k, lattice=lattice)
    shares = laboratory_shares(waves)
    # each bend or shear is wholly f+ or f-: round-off, grown where two are close to crossing
    assert np.sort(shares, axis=-1)[:, :, 2] == pytest.approx(np.ones((20, 6)), abs=1e-9)
    q = laboratory_wavenumbers(TWISTED, k)
    for index in range(20):
        for sense in (0, 2):
            mine = waves.frequencies_rad_per_ps[index, shares[index, :, sense] > 0.5]
            untwisted = bend_shear_branches(PAPER, q[index, sense], lattice=lattice)
            # one dispersion relation for both, that of the rod without twist; round-off
            assert mine == pytest.approx(untwisted, abs=1e-13)


def test_without_twist_the_frames_agree() -> None:
    fields = np.random.default_rng(4).normal(size=(24, 6))
    assert to_laboratory(PAPER, fields, PLACES) == pytest.approx(fields, abs=1e-15)
    assert laboratory_wavenumbers(PAPER, [0.3]) == pytest.approx(np.full((1, 3), 0.3))
    # f+ and f- of a wave in one plane are equal
    shares = laboratory_shares(plane_waves(PAPER, [1.0], lattice=False))
    assert shares.sum(axis=-1) == pytest.approx(np.ones((1, 6)), abs=1e-13)


def test_fields_that_do_not_fit_the_places_are_refused() -> None:
    with pytest.raises(InputError, match="six numbers for each place"):
        to_laboratory(TWISTED, np.zeros((23, 6)), PLACES)
