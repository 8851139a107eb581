"""Separable least squares: amplitudes are solved for, the other parameters are searched for.

Golub & Pereyra (1973), SIAM J. Numer. Anal. 10, 413: variable projection. The amplitudes are
eliminated, so a start needs none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]

# Relative change of the sum of squares at which a search ends, and at which its start is dropped.
FINE, COARSE = 1e-8, 1e-3
# Far more than a search needs that has somewhere to go.
MOST_STEPS = 60
# Residual, in parts of the data's norm, where the model does not exist: finite, so that a search
# that looks across the border has a slope and turns round.
NOWHERE = 1e3


@dataclass(frozen=True, eq=False)
class Minimum:
    """Parameters of the smallest sum of squares, and what is left there."""

    parameters: Array
    sum_of_squares: float


@dataclass(frozen=True, eq=False)
class Separable:
    """Data (n,) and a model that is linear in amplitudes: columns(parameters) is (amplitudes, n).

    A model may return None where it does not exist: the search steps back from there.
    """

    data: Array
    columns: Callable[[Array], Array | None]

    def amplitudes(self, parameters: Array) -> Array:
        columns = self.columns(parameters)
        if columns is None:
            raise ValueError("the model does not exist at these parameters")
        return _solve(columns, self.data)

    def fitted(self, parameters: Array) -> Array:
        columns = self.columns(parameters)
        if columns is None:
            return np.full_like(self.data, np.inf)
        return _solve(columns, self.data) @ columns

    def sum_of_squares(self, parameters: Array) -> float:
        return float(np.sum((self.data - self.fitted(parameters)) ** 2))

    def minimise(
        self, start: Array, fixed: Mapping[int, float] | None = None, tolerance: float = FINE
    ) -> Minimum:
        """Return the minimum next to a start, some parameters kept at given values."""
        full = np.array(start, dtype=float)
        for index, value in (fixed or {}).items():
            full[index] = value
        free = np.setdiff1d(np.arange(len(full)), list(fixed or {}))
        if len(free) == 0:
            return Minimum(full, self.sum_of_squares(full))
        scale = max(float(np.sqrt(np.sum(self.data**2))), np.finfo(float).tiny)

        def residual(values: Array) -> Array:
            full[free] = values
            left = (self.data - self.fitted(full)) / scale
            return left if np.isfinite(left).all() else np.full_like(left, NOWHERE)

        found = least_squares(
            residual, full[free], x_scale="jac", ftol=tolerance, max_nfev=MOST_STEPS
        )
        full[free] = found.x
        return Minimum(full, float(2 * found.cost) * scale**2)

    def best(self, starts: Array, refined: int) -> Minimum:
        """Return the least of the minima near the most promising of many starts."""
        costs = np.array([self.sum_of_squares(start) for start in starts])
        order = np.argsort(costs)[:refined]
        near = [self.minimise(starts[i], tolerance=COARSE) for i in order]
        return self.minimise(min(near, key=lambda m: m.sum_of_squares).parameters)

    def sensitivity(self, parameters: Array, index: int) -> Array:
        """Return the derivative (n,) of the fitted values, free of what the others can mimic."""
        slopes = np.array([self._slope(parameters, i) for i in range(len(parameters))])
        columns = self.columns(parameters)
        others = np.delete(slopes, index, axis=0)
        basis = np.concatenate([others, columns]) if columns is not None else others
        return slopes[index] - _solve(basis, slopes[index]) @ basis

    def _slope(self, parameters: Array, index: int) -> Array:
        step = np.zeros(len(parameters))
        step[index] = 1e-4 * max(abs(parameters[index]), 0.1)
        return (self.fitted(parameters + step) - self.fitted(parameters - step)) / (2 * step[index])


def _solve(columns: Array, data: Array) -> Array:
    if len(columns) == 1:
        norm = float(columns[0] @ columns[0])
        return np.array([float(columns[0] @ data) / norm if norm > 0 else 0.0])
    return np.asarray(np.linalg.lstsq(columns.T, data, rcond=None)[0])
