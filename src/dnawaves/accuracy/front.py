"""The Pareto front of error and cost, how far a setting is from it, and the order of a method."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Costs closer than this are the same: what two runs of one setting differ by on a busy machine.
SAME_COST = 0.1


def on_front(costs: ArrayLike, errors: ArrayLike) -> NDArray[np.bool_]:
    """Return which settings no other beats in one of cost and error without losing in the other."""
    cost, error = np.asarray(costs, dtype=float), np.asarray(errors, dtype=float)
    no_worse = (cost <= cost[:, None]) & (error <= error[:, None])
    better = (cost < cost[:, None]) | (error < error[:, None])
    return ~np.any(no_worse & better, axis=1)


def excess(costs: ArrayLike, errors: ArrayLike) -> NDArray[np.float64]:
    """Return how far each setting is from the front, as a part of what could be had; 0 on it.

    The larger of two: how much more it costs than another that errs no more, and how much more it
    errs than another that costs no more. Costs within `SAME_COST` count as the same.
    """
    cost, error = np.asarray(costs, dtype=float), np.asarray(errors, dtype=float)
    found = []
    for one_cost, one_error in zip(cost, error, strict=True):
        cheapest = cost[error <= one_error].min()
        cheaper = one_cost / cheapest if one_cost > (1 + SAME_COST) * cheapest else 1.0
        best = error[cost <= (1 + SAME_COST) * one_cost].min()
        found.append(max(cheaper, one_error / best) - 1)
    return np.array(found)


def order(steps: ArrayLike, errors: ArrayLike) -> float:
    """Return the power of the step with which errors fall: the slope of the logarithms."""
    slope, _ = np.polyfit(np.log(np.asarray(steps)), np.log(np.asarray(errors)), 1)
    return float(slope)
