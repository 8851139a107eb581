"""Frequency-wavenumber maps of waves of known frequency and wavenumber."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.rod.chain import ScalarChain
from dnawaves.waves.estimators.spectrum import frequency_wavenumber

PAIRS, SPACING_NM, SPEED = 24, 0.34, 10.0


@pytest.mark.parametrize("held", [(0, -1), (-1,), (0,), ()])
@pytest.mark.parametrize("mode", [2, 7])
def test_one_mode_of_the_chain_is_one_spot_of_the_map(held: tuple[int, ...], mode: int) -> None:
    chain = ScalarChain.from_speed(PAIRS, SPEED, SPACING_NM, held)
    moving = np.flatnonzero(chain.frequencies_rad_per_ps > 1e-9)
    index = moving[mode - 1]
    omega = chain.frequencies_rad_per_ps[index]
    times = np.arange(600) * 0.05
    velocity = np.cos(omega * times)[:, None] * chain.shapes[index]
    power = frequency_wavenumber(times, velocity, SPACING_NM, held)
    row, column = np.unravel_index(int(np.argmax(power.values)), power.shape)
    assert row == mode - 1
    # The map is drawn on a grid; its peak lies within a quarter of the map's resolution.
    found_GHz = float(power["frequency"][column])
    expected_GHz = 1e3 * omega / (2 * np.pi)
    assert found_GHz == pytest.approx(expected_GHz, abs=0.25 * power.attrs["resolution_GHz"])
    # The wavenumber of that row obeys the chain's own dispersion relation exactly.
    k = float(power["wavenumber"][row])
    half = 10 * SPACING_NM / 2
    assert SPEED / half * np.sin(k * half) == pytest.approx(omega, rel=1e-9)
