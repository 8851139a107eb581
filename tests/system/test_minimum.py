"""The minimiser on functions whose minimum is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import rosen, rosen_der, rosen_hess
from scipy.stats import ortho_group

from dnawaves.errors import SimulationError
from dnawaves.system.minimum import BasinLeftError, minimise, shifted_factor

Array = NDArray[np.float64]
TOLERANCE = 1e-6


def stiff_quadratic() -> tuple[Array, Array]:
    """Return a matrix with eigenvalues over nine decades, as a duplex has, and the minimum."""
    generator = np.random.default_rng(12)
    vectors = ortho_group.rvs(40, random_state=generator)
    matrix = (vectors * np.logspace(-2, 7, 40)) @ vectors.T
    return (matrix + matrix.T) / 2, generator.normal(0, 0.01, 40)


def test_exact_hessian_preconditions_a_stiff_quadratic() -> None:
    matrix, lowest = stiff_quadratic()
    minimum = minimise(
        lambda x: (float((x - lowest) @ matrix @ (x - lowest) / 2), matrix @ (lowest - x)),
        lambda x: matrix.copy(),
        np.zeros(40),
        TOLERANCE,
    )
    assert minimum.rms_force_kJ_per_mol_nm <= TOLERANCE
    # The softest eigenvalue is 1e-2: a force of 1e-6 √40 leaves 6e-4 nm at most.
    np.testing.assert_allclose(minimum.coordinates_nm, lowest, atol=6.4e-4)
    # The smallest shift is a tenth of the softest eigenvalue: each step of plain iteration gains
    # a factor of ten. Without the factor nine decades would take thousands of steps.
    assert minimum.evaluations < 20


def test_rosenbrocks_valley() -> None:
    minimum = minimise(
        lambda x: (float(rosen(x)), -rosen_der(x)), rosen_hess, np.full(6, -0.3), TOLERANCE
    )
    # The softest eigenvalue at the minimum is about 0.5: the force over it.
    np.testing.assert_allclose(minimum.coordinates_nm, 1, atol=1e-5)
    assert minimum.energy_kJ_per_mol == pytest.approx(0, abs=1e-10)


def test_leaves_a_point_where_the_energy_curves_down() -> None:
    # A double well beside its barrier, with a stiff second coordinate.
    def evaluate(x: Array) -> tuple[float, Array]:
        energy = (x[0] ** 2 - 1) ** 2 + 500 * x[1] ** 2
        return float(energy), np.array([-4 * x[0] * (x[0] ** 2 - 1), -1000 * x[1]])

    def hessian(x: Array) -> Array:
        return np.diag([12 * x[0] ** 2 - 4, 1000.0])

    assert hessian(np.array([0.1, 0.0]))[0, 0] < 0
    minimum = minimise(evaluate, hessian, np.array([0.1, 0.02]), TOLERANCE)
    # Eigenvalue 8: the force over it.
    np.testing.assert_allclose(minimum.coordinates_nm, [1, 0], atol=1e-6)


def test_no_step_is_longer_than_allowed() -> None:
    visited = [np.array([1.0])]

    def evaluate(x: Array) -> tuple[float, Array]:
        visited.append(x.copy())
        return float(x @ x / 2), -x

    minimise(evaluate, lambda x: np.eye(1), visited[0], TOLERANCE)
    # 0.03 nm, of 1 nm to go.
    assert np.abs(np.diff(visited, axis=0)).max() < 0.03 + 1e-12
    assert len(visited) > 33


def test_a_start_at_the_minimum_needs_no_hessian() -> None:
    def hessian(x: Array) -> Array:
        raise AssertionError("asked for a Hessian")

    minimum = minimise(lambda x: (0.0, -x), hessian, np.zeros(3), TOLERANCE)
    assert minimum.evaluations == 1


def test_a_slope_without_end_is_no_minimum() -> None:
    with pytest.raises(SimulationError, match="no minimum after 2 Hessians: rms force 1"):
        minimise(
            lambda x: (-float(x.sum()), np.ones(3)),
            lambda x: np.zeros((3, 3)),
            np.zeros(3),
            TOLERANCE,
            cycles=2,
            evaluations_per_cycle=5,
        )


def test_falling_out_of_the_basin_is_noticed() -> None:
    # A washboard so steep that none of its troughs holds.
    def evaluate(x: Array) -> tuple[float, Array]:
        return -float(np.cos(x[0])) - 3 * float(x[0]), np.array([-np.sin(x[0]) + 3.0])

    with pytest.raises(BasinLeftError, match=r"below the -5\.000 kJ/mol"):
        minimise(
            evaluate,
            lambda x: np.array([[np.cos(x[0])]]),
            np.array([0.5]),
            TOLERANCE,
            lowest_energy=-5.0,
        )


@pytest.mark.parametrize("lowest", [-3000.0, -0.5, 0.0, 2.0])
def test_shift_makes_an_indefinite_matrix_positive(lowest: float) -> None:
    vectors = ortho_group.rvs(12, random_state=13)
    values = np.append(lowest, np.linspace(1, 1e4, 11))
    matrix = (vectors * values) @ vectors.T
    matrix = (matrix + matrix.T) / 2
    (factor, lower), shift = shifted_factor(matrix.copy())
    triangle = np.tril(factor) if lower else np.triu(factor).T
    # Round-off of 1e4.
    np.testing.assert_allclose(triangle @ triangle.T, matrix + shift * np.eye(12), atol=1e-10 * 1e4)
    assert shift > -lowest
    # The first of 1e-3, 3e-3, 9e-3, ... that will do.
    assert shift <= max(1e-3, 3 * -lowest) * (1 + 1e-12)


def test_a_matrix_that_is_no_hessian_of_a_molecule_is_refused() -> None:
    with pytest.raises(SimulationError, match=r"eigenvalue below -1e\+06"):
        shifted_factor(np.diag([1.0, -1e7]))
