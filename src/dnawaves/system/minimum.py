"""A true minimum: L-BFGS in double precision, preconditioned by the exact Hessian.

OpenMM's minimiser works in single precision, stops at forces of 0.1 to 1 kJ/mol/nm and leaves
negative modes, along which the difference of two runs grows exponentially. Here each cycle takes
the Hessian, shifts it until it is positive definite, and lets its factor precondition L-BFGS.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from dnawaves.errors import SimulationError

Array = NDArray[np.float64]
EnergyAndForce = Callable[[Array], tuple[float, Array]]

LARGEST_MOVE_NM = 0.03
HISTORY = 30
SUFFICIENT_DECREASE = 1e-4
SMALLEST_SHIFT = 1e-3
SHIFT_GROWTH = 3.0
LARGEST_SHIFT = 1e6
BACKTRACK = 0.35
BACKTRACKS = 8


class BasinLeftError(SimulationError):
    """A minimisation left the basin that it was meant to stay in."""


class NoMinimumError(SimulationError):
    """A minimisation came to the end of its cycles; `coordinates_nm` is how far it got."""

    def __init__(self, message: str, coordinates_nm: Array) -> None:
        super().__init__(message)
        self.coordinates_nm = coordinates_nm


@dataclass(frozen=True)
class Minimum:
    """The result of a minimisation: coordinates (n,) in nm and what was reached."""

    coordinates_nm: Array
    energy_kJ_per_mol: float
    rms_force_kJ_per_mol_nm: float
    evaluations: int


def minimise(
    evaluate: EnergyAndForce,
    hessian: Callable[[Array], Array],
    start: Array,
    tolerance: float,
    *,
    cycles: int = 30,
    evaluations_per_cycle: int = 400,
    lowest_energy: float = -np.inf,
    report: Callable[[str], None] = lambda line: None,
) -> Minimum:
    """Go down to a minimum of the energy.

    Parameters
    ----------
    evaluate : of coordinates (n,) in nm: energy in kJ/mol and force (n,) in kJ/mol/nm
    hessian : of coordinates: (n, n) in kJ/mol/nm², which may be overwritten; asked for once a cycle
    tolerance : root-mean-square force per coordinate to stop at, kJ/mol/nm
    lowest_energy : energy in kJ/mol below which the search is over: another basin was entered

    Raises
    ------
    NoMinimumError
        When the tolerance is not reached after `cycles` Hessians.
    BasinLeftError
        When the energy falls below `lowest_energy`.
    """

    def checked(x: Array) -> tuple[float, Array]:
        energy, force = evaluate(x)
        if energy < lowest_energy:
            raise BasinLeftError(
                f"energy {energy:.3f} kJ/mol is below the {lowest_energy:.3f} kJ/mol "
                "that the structure at hand can reach"
            )
        return energy, force

    x = start
    energy, force = checked(x)
    evaluations = 1
    for cycle in range(cycles):
        if _rms(force) <= tolerance:
            break
        factor, shift = shifted_factor(hessian(x))
        x, energy, force, used = _lbfgs(
            checked, factor, x, energy, force, tolerance, evaluations_per_cycle
        )
        evaluations += used
        report(
            f"cycle {cycle + 1}: energy {energy:.4f} kJ/mol, rms force {_rms(force):.2e} "
            f"kJ/mol/nm, shift {shift:.1e} kJ/mol/nm^2, {evaluations} evaluations"
        )
    # NaN is no minimum either.
    if not _rms(force) <= tolerance:
        raise NoMinimumError(
            f"no minimum after {cycles} Hessians: rms force {_rms(force):.3g} kJ/mol/nm, "
            f"wanted {tolerance:.3g}",
            x,
        )
    return Minimum(x, energy, _rms(force), evaluations)


def shifted_factor(hessian: Array) -> tuple[tuple[Array, bool], float]:
    """Return the Cholesky factor of hessian + shift·1 for the first shift that allows one."""
    shift = SMALLEST_SHIFT
    diagonal = np.einsum("ii->i", hessian)
    diagonal += shift
    while shift < LARGEST_SHIFT:
        try:
            return cho_factor(hessian, check_finite=False), shift
        except np.linalg.LinAlgError:
            diagonal += shift * (SHIFT_GROWTH - 1)
            shift *= SHIFT_GROWTH
    raise SimulationError(f"the Hessian has an eigenvalue below {-LARGEST_SHIFT:g} kJ/mol/nm^2")


def _lbfgs(
    evaluate: EnergyAndForce,
    factor: tuple[Array, bool],
    x: Array,
    energy: float,
    force: Array,
    tolerance: float,
    evaluations: int,
) -> tuple[Array, float, Array, int]:
    history: list[tuple[Array, Array]] = []
    used = 0
    while used < evaluations and _rms(force) > tolerance:
        step = _direction(factor, history, force)
        if step @ force <= 0:
            history.clear()
            step = cho_solve(factor, force, check_finite=False)
        step *= min(1.0, LARGEST_MOVE_NM / np.abs(step).max())
        for _ in range(BACKTRACKS):
            new_energy, new_force = evaluate(x + step)
            used += 1
            # Near the minimum the decrease drowns in round-off of the energy: there a smaller
            # force is the better sign.
            if new_energy < energy - SUFFICIENT_DECREASE * (step @ force) or (
                abs(new_energy - energy) < 1e-9 * abs(energy) and _rms(new_force) < _rms(force)
            ):
                break
            step = step * BACKTRACK
        else:
            return x, energy, force, used
        change = force - new_force
        if step @ change > 0:
            history = [*history[-HISTORY + 1 :], (step, change)]
        x, energy, force = x + step, new_energy, new_force
    return x, energy, force, used


def _direction(
    factor: tuple[Array, bool], history: list[tuple[Array, Array]], force: Array
) -> Array:
    """Two-loop recursion of L-BFGS (Nocedal & Wright, algorithm 7.4) with the factor as H0."""
    direction = force.copy()
    weights = []
    for step, change in reversed(history):
        weight = (step @ direction) / (step @ change)
        direction -= weight * change
        weights.append(weight)
    direction = cho_solve(factor, direction, check_finite=False)
    for (step, change), weight in zip(history, reversed(weights), strict=True):
        direction += step * (weight - (change @ direction) / (step @ change))
    return direction


def _rms(force: Array) -> float:
    return float(np.sqrt(np.mean(force**2)))
