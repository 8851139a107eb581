"""The Pareto front, the distance from it, and the order of a method: known sets."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dnawaves.accuracy.front import excess, on_front, order

# Cost, error; the third costs more than the second and errs more, the last is as good as the first.
COSTS = [1.0, 2.0, 3.0, 4.0, 1.0]
ERRORS = [8.0, 2.0, 3.0, 1.0, 8.0]


def test_front_of_a_known_set() -> None:
    assert on_front(COSTS, ERRORS).tolist() == [True, True, False, True, True]


def test_a_beaten_setting_is_as_far_off_as_the_farther_of_cost_and_error() -> None:
    # The third: another errs no more at 2/3 of its cost, and 2/3 of its error costs no more.
    assert np.allclose(excess(COSTS, ERRORS), [0, 0, 0.5, 0, 0])


def test_costs_within_the_noise_of_timing_are_the_same() -> None:
    # Half the error at a cost that only the clock's noise tells apart: the first is beaten.
    assert np.allclose(excess([1.0, 1.05], [2.0, 1.0]), [1.0, 0.0])


@given(
    st.lists(
        st.tuples(st.floats(0.125, 8), st.floats(0.001, 1)),
        min_size=1,
        max_size=12,
    )
)
def test_every_setting_is_beaten_or_matched_by_one_on_the_front(
    points: list[tuple[float, float]],
) -> None:
    costs, errors = np.array(points).T
    front = on_front(costs, errors)
    for cost, error in points:
        assert np.any(front & (costs <= cost) & (errors <= error))


def test_order_of_a_second_order_method() -> None:
    """An oscillator by leapfrog: its phase error after a time falls as the square of the step."""
    omega, time = 1.0, 20.0
    steps = np.array([0.05, 0.1, 0.2])
    # Exact for leapfrog: sin(w h / 2) = omega h / 2.
    errors = np.abs(2 * np.arcsin(omega * steps / 2) / steps - omega) * time
    # The next term is of relative size (omega h)^2, at most 4 % here.
    assert abs(order(steps, errors) - 2) < 0.02
