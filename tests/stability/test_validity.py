"""The checks of physical_validation see what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.stability import validity
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K


@pytest.mark.parametrize(("factor", "sound"), [(1.0, True), (1.05, False)])
def test_a_thermostat_that_is_off_by_five_per_cent_shows(factor: float, sound: bool) -> None:
    freedom, temperature_K = 750, 300.0
    half_kT = 0.5 * BOLTZMANN_KJ_PER_MOL_K * temperature_K * factor
    kinetic = half_kT * np.random.default_rng(1).chisquare(freedom, 400)
    data = validity.simulation_data(250, temperature_K, kinetic, kinetic)
    # The mean of 400 samples is known to sqrt(2/750/400) = 0.26 %: 5 % are 20 standard errors.
    assert (validity.off_theory(data) < 3.5) == sound
