"""Long waves of a duplex, and the lattices of a plane and of springs to two neighbours."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.rod.chain import PlaneChain
from dnawaves.rod.rod import Rod
from dnawaves.waves.estimators.lattice_fit import Observation, fit_lattice
from dnawaves.waves.estimators.lattices import ScalarLattice
from dnawaves.waves.estimators.long_waves import long_wave_count, lowest_waves, standing_waves
from dnawaves.waves.estimators.next_nearest import SHARE, NextNearestLattice
from dnawaves.waves.estimators.plane_lattice import PlaneLattice
from dnawaves.waves.estimators.sources import kick

PAIRS, SPACING_NM = 24, 0.34
TIMES_PS = np.arange(0, 9, 0.15)


@pytest.mark.parametrize(
    ("held", "count"),
    # Wavelengths 2L/n, 4L/(2n - 1); of the free duplex 2L/n again, after the uniform motion.
    [([0, 23], 2), ([23], 2), ([0], 2), ([], 3), ([0, 1, 22, 23], 2)],
)
def test_long_waves_are_those_as_long_as_the_duplex(held: list[int], count: int) -> None:
    assert long_wave_count(PAIRS, held) == count


def test_projection_on_all_waves_loses_nothing() -> None:
    scales = (3.0, 2.0)
    field = np.random.default_rng(1).standard_normal((7, 2 * (PAIRS - 1)))
    seen = lowest_waves(PAIRS, [0], PAIRS - 1, scales).whiten(field)
    weighted = field * np.tile(scales, PAIRS - 1)
    # An orthogonal transformation of the weighted channels.
    assert np.sum(seen**2) == pytest.approx(np.sum(weighted**2), rel=1e-12)
    assert len(standing_waves(PAIRS, [0])) == PAIRS - 1


def test_long_waves_of_a_stiff_defect_are_those_of_the_rest() -> None:
    """A vibration of one pair, which a full fit sees, leaves the long waves' speed alone."""
    lattice = ScalarLattice(PAIRS, SPACING_NM, [23], kick(TIMES_PS), np.eye(PAIRS)[0])
    wave = lattice.velocity({"speed_A_per_ps": 12.0, "friction_per_ps": 0.05})
    field = np.zeros((len(TIMES_PS), PAIRS))
    field[:, :23] = wave
    size = np.abs(wave[:, 5:]).max()
    # Two neighbours against each other, at 9 rad/ps: no long wave has any of it.
    vibration = size * np.cos(9.0 * TIMES_PS)
    field[:, 9] += vibration
    field[:, 10] -= vibration
    whole = fit_lattice([Observation(field, lattice)], intervals=[])
    long = fit_lattice([Observation(field, lattice, lowest_waves(PAIRS, [23], 2))], intervals=[])
    assert whole.model_class.misfit > 5 * long.model_class.misfit
    # What the vibration has of the two longest waves is a twelfth of it in either pair, with
    # opposite signs: it moves the speed by less than a percent.
    assert long["speed_A_per_ps"].value == pytest.approx(12.0, rel=0.01)


@pytest.mark.parametrize("held", [[23], [0, 23], []])
def test_plane_lattice_is_the_chain_of_timoshenko(held: list[int]) -> None:
    mass, inertia, shear, bend = 600.0, 180.0, 5.5, 9.0
    density, tilt = mass / SPACING_NM, inertia / SPACING_NM
    stiffness = np.diag([density * (shear / 10) ** 2] * 3 + [tilt * (bend / 10) ** 2] * 3)
    chain = PlaneChain(Rod(density, tilt * np.eye(3), stiffness, SPACING_NM), PAIRS, held)
    pattern = np.zeros((PAIRS, 2))
    pattern[2:5] = 0.01, 0.02
    lattice = PlaneLattice(PAIRS, SPACING_NM, held, kick(TIMES_PS), pattern, (mass, inertia))
    found = lattice.velocity(dict(zip(lattice.names, (shear, bend, 0.1), strict=True)))
    expected = chain.kick_response(TIMES_PS, pattern, 0.1)[1][:, lattice.moving]
    # Two eigensolvers, one of them with rigid motions that are zero to 1e-10 of the largest square.
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("share", [-0.5, 0.0, 0.6])
def test_next_nearest_springs_leave_the_speed_of_long_waves(share: float) -> None:
    pairs = 400
    lattice = NextNearestLattice(pairs, SPACING_NM, [], kick([0.0, 1.0]), np.eye(pairs)[0])
    first, second = lattice.springs
    total = 144 * ((1 - share) * first + share * second)
    lowest = np.sqrt(np.linalg.eigvalsh(total)[1])
    # omega = V pi/L up to (ka)²/24, 3e-6 of it, and the two springs that the ends lack.
    assert lowest == pytest.approx(1.2 * np.pi / (pairs * SPACING_NM), rel=2e-3)


def test_next_nearest_fit_finds_the_share() -> None:
    pattern = np.eye(PAIRS)[0]
    lattice = NextNearestLattice(PAIRS, SPACING_NM, [23], kick(TIMES_PS), pattern)
    truth = {"speed_A_per_ps": 15.0, SHARE: -0.3, "friction_per_ps": 0.1}
    field = np.zeros((len(TIMES_PS), PAIRS))
    field[:, :23] = lattice.velocity(truth)
    fit = fit_lattice([Observation(field, lattice)], intervals=[SHARE])
    for name, value in truth.items():
        # The optimiser's tolerance.
        assert fit[name].value == pytest.approx(value, rel=1e-3)
    assert fit[SHARE].low <= fit[SHARE].value <= fit[SHARE].high
