"""What follows from speed and friction: attenuation, diffusion, distance from a lag, trends."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dnawaves.errors import InputError
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.waves.constants.rod_stiffness import step_kind
from dnawaves.waves.derived import (
    Measured,
    attenuation_length_A,
    by_kind,
    crossover,
    distance_from_lag,
    driven_attenuation_length_A,
    flexural_crossover_per_A,
    front_lags,
    lag_ruler,
    trend,
)

SPEEDS = st.floats(2.0, 50.0)
FRICTIONS = st.floats(0.01, 10.0)


def test_the_front_of_a_damped_chain_falls_as_the_length_says() -> None:
    # 200 base pairs, 10 Å/ps: the front at 300 Å against the one at 100 Å, by friction alone.
    pairs, spacing_nm, speed, friction = 200, 0.34, 10.0, 0.05
    chain = ScalarChain.from_speed(pairs, speed, spacing_nm)
    source, times = np.eye(pairs)[0], np.arange(0, 45, 0.05)
    peaks = {}
    for damping in (0.0, friction):
        velocity = chain.kick_response(times, source, damping)[1]
        peaks[damping] = [np.abs(velocity[:, pair]).max() for pair in (30, 90)]
    measured = np.log((peaks[0.0][1] / peaks[0.0][0]) / (peaks[friction][1] / peaks[friction][0]))
    expected = 60 * 10 * spacing_nm / attenuation_length_A(speed, friction)
    # The lattice's peak is 4 % late at base pair 30, 2 % at 90, and damped for longer.
    assert measured == pytest.approx(expected, rel=0.03)


@settings(max_examples=30, deadline=None)
@given(SPEEDS, FRICTIONS)
def test_driven_waves_fade_as_a_front_above_and_as_heat_below_the_crossover(
    speed: float, friction: float
) -> None:
    found = crossover(speed, friction)
    fast, slow = 1e3 * found.frequency_rad_per_ps, 1e-4 * found.frequency_rad_per_ps
    # Corrections are (g/w)^2/8 above and w/2g below.
    front = attenuation_length_A(speed, friction)
    assert driven_attenuation_length_A(fast, speed, friction) == pytest.approx(front, rel=1e-4)
    heat = np.sqrt(2 * found.diffusion_A2_per_ps / slow)
    assert driven_attenuation_length_A(slow, speed, friction) == pytest.approx(heat, rel=1e-4)
    assert found.wavelength_A == pytest.approx(2 * np.pi * front, rel=1e-12)


def test_where_propagation_ends() -> None:
    # At 1 /ps the lowest standing wave of 24 base pairs is overdamped, that of 12 is not.
    spacing_nm, speed = 0.34, short_wave_speeds_A_per_ps(Rod.paper())["extension"]
    longest = crossover(speed, 1.0, spacing_nm).wavelength_A
    assert 2 * 11 * 3.4 < longest < 2 * 23 * 3.4
    # And nothing propagates above 4V/a = 9.6 /ps.
    assert crossover(speed, 9.5, spacing_nm).wavelength_A > 2 * 3.4
    assert crossover(speed, 9.7, spacing_nm).wavelength_A == 0.0
    # Above the lattice's edge, 2V/a, a drive does not get far even without friction.
    assert driven_attenuation_length_A(6.0, speed, 0.0, spacing_nm) < 3.4
    assert driven_attenuation_length_A(1.0, speed, 0.0) == np.inf
    # Long bends, 29 Å²/ps k²: at 0.58 /ps and 0.1 /Å.
    assert flexural_crossover_per_A(29.0**2, 0.58) == pytest.approx(0.1, rel=1e-12)
    with pytest.raises(InputError, match="allowed: above 0"):
        crossover(speed, 0.0)


@settings(max_examples=30, deadline=None)
@given(st.floats(10.0, 500.0), SPEEDS, st.floats(1.2, 3.0))
def test_distance_from_the_lag_of_two_waves(distance: float, twist: float, ratio: float) -> None:
    extension = ratio * twist
    arrivals = Measured(distance / extension, 0.01), Measured(distance / twist, 0.02)
    speeds = Measured(extension, 0.03 * extension), Measured(twist, 0.02 * twist)
    found = distance_from_lag(*arrivals, *speeds)
    assert found.value == pytest.approx(distance, rel=1e-9)
    # The error is that of many draws, to first order: at 3 % and a lag of 1/6 at the least, 20 %.
    rng = np.random.default_rng(1)
    t1, t2, v1, v2 = (one.value + one.sd * rng.standard_normal(4000) for one in arrivals + speeds)
    drawn = (t2 - t1) / (1 / v2 - 1 / v1)
    middle = np.quantile(drawn, [0.16, 0.84])
    assert found.sd == pytest.approx((middle[1] - middle[0]) / 2, rel=0.2)


def test_equal_speeds_measure_nothing() -> None:
    with pytest.raises(InputError, match="never come apart"):
        distance_from_lag(Measured(1.0), Measured(1.0), Measured(8.0), Measured(8.0))


def test_a_ruler_of_lags_on_a_chain() -> None:
    # Fronts of two chains after the same kick: the lag tells the distance within a base pair.
    pairs, spacing_nm, times = 24, 0.34, np.arange(0, 16, 0.05)
    source = np.where(np.arange(pairs) < 3, 1.0, 0.0)
    waves = [
        (times, ScalarChain.from_speed(pairs, v, spacing_nm).kick_response(times, source)[1])
        for v in (15.0, 8.0)
    ]
    inner = range(6, 22)
    arrivals = front_lags(waves[0], waves[1], inner)
    assert set(arrivals) == set(inner)
    lags = [twist.value - extension.value for extension, twist in arrivals.values()]
    heights = 3.4 * np.array(list(arrivals))
    ruler = lag_ruler(heights, lags)
    # The front's width grows as x^(1/3): the slope is that of the speeds within 5 %.
    assert ruler.A_per_ps == pytest.approx(1 / (1 / 8.0 - 1 / 15.0), rel=0.05)
    assert ruler.error_A < 0.5
    assert ruler.distance_A(lags[3]) == pytest.approx(heights[3], abs=1.0)
    with pytest.raises(InputError, match="three different lags"):
        lag_ruler([1.0, 2.0], [1.0, 2.0])


def test_trend_has_the_errors_of_its_values() -> None:
    temperatures, slope = [100.0, 200.0, 300.0, 400.0], -0.01
    rng, inside = np.random.default_rng(2), 0
    for _ in range(200):
        values = [Measured(12 + slope * t + 0.3 * rng.standard_normal(), 0.3) for t in temperatures]
        found = trend(temperatures, values)
        inside += found.low <= slope <= found.high
    # 95 % of 200, four standard errors are 12; scatter by chance only widens it.
    assert inside >= 178
    exact = trend([100.0, 300.0], [Measured(10.0, 0.3), Measured(8.0, 0.3)])
    assert exact.slope == pytest.approx(-0.01, rel=1e-12)
    assert exact.high - exact.slope == pytest.approx(1.96 * 0.3 * np.sqrt(2) / 200, rel=1e-3)
    with pytest.raises(InputError, match="two or more different places"):
        trend([300.0, 300.0], [Measured(1.0, 0.1), Measured(2.0, 0.1)])


def test_steps_are_alike_read_along_either_strand() -> None:
    assert step_kind("A", "G") == step_kind("C", "T") == "AG"
    assert step_kind("T", "A") == "TA"
    found = by_kind(["AG", "TA", "AG"], [10.0, 5.0, 12.0])
    assert (found["AG"].mean, found["AG"].sd, found["TA"].number) == (11.0, 1.0, 1)
    assert found["TA"].sd == np.inf
