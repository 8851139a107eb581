"""Stiffness of a rod from the covariance of its strains along the axis: by segments and by waves.

Compliances per length are what adds up along a rod, so they are averaged, as of springs in a row.
A rod has the same at every length and wavelength; a molecule has where its steps move
independently of each other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.segments import inner_pairs

Array = NDArray[np.float64]

# Places in the order of `structure_factor.COORDINATES`.
SHEARS, BENDS, AXIAL = [0, 1], [3, 4], [2, 5]
MATRIX = ("stretch_modulus_pN", "twist_rigidity_pN_nm2", "twist_stretch_coupling_pN_nm")
RELAXED = ("stretch_modulus_relaxed_pN", "twist_rigidity_relaxed_pN_nm2")
ACROSS = ("bend_rigidity_pN_nm2", "shear_stiffness_pN")
STIFFNESS = (*MATRIX, *RELAXED, *ACROSS)
# Lengths of the waves, in steps.
WAVES_IN_STEPS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48)
# All positive but the coupling.
SIGNED = ("twist_stretch_coupling_pN_nm",)


def segments_compliance(covariance: Array, heights_A: Array, steps: int) -> Array:
    """Return the compliance per length (segment, 6, 6) of every segment of so many steps.

    `covariance` (step, 6, step, 6) is that of the strains along the axis over kBT: Å and rad per
    kJ/mol; the compliance is per Å.
    """
    inside = inner_pairs(len(heights_A))
    found = []
    for first in inside[: len(inside) - steps]:
        part = covariance[first : first + steps, :, first : first + steps]
        length = heights_A[first + steps] - heights_A[first]
        found.append(part.sum(axis=(0, 2)) / length)
    return np.array(found)


def kinds_compliance(covariance: Array, heights_A: Array, sequence: str) -> dict[str, Array]:
    """Return the mean compliance per length (6, 6) of the inner steps of each kind of sequence.

    `sequence` is that of strand I; a step has one name, read along either strand (AG for AG, CT).
    """
    every = segments_compliance(covariance, heights_A, 1)
    kinds = np.array(_inner_kinds(sequence))
    return {kind: every[kinds == kind].mean(axis=0) for kind in step_kinds(sequence)}


def step_kinds(sequence: str) -> list[str]:
    """Return the kinds of the inner steps of a sequence, each once, in alphabetical order."""
    return sorted(set(_inner_kinds(sequence)))


def _inner_kinds(sequence: str) -> list[str]:
    return [step_kind(*sequence[i : i + 2]) for i in inner_pairs(len(sequence))[:-1]]


def step_kind(first: str, second: str) -> str:
    """Return one name of a step read along either strand: AG for AG and CT."""
    pair = {"A": "T", "T": "A", "C": "G", "G": "C"}
    return min(first + second, pair[second] + pair[first])


def wave_compliance(covariance: Array, heights_A: Array, steps: float) -> Array:
    """Return the compliance per length (6, 6) that a wave of so many steps meets.

    S(q) = Σ cos(q(j - j')) ⟨ε_j ε_j'⟩/(kBT L) over the inner steps, in units of
    `segments_compliance`; infinitely many steps are q = 0.
    """
    inside = inner_pairs(len(heights_A))
    chosen = slice(inside[0], inside[-1])
    index = np.arange(inside[0], inside[-1])
    phases = np.cos(2 * np.pi / steps * np.subtract.outer(index, index))
    length = heights_A[inside[-1]] - heights_A[inside[0]]
    return np.asarray(np.einsum("st,sitj->ij", phases, covariance[chosen, :, chosen]) / length)


def stiffness_of(compliance: Array) -> dict[str, float]:
    """Return the rod's constants, by the names of `STIFFNESS`, of a compliance per length (6, 6).

    Extension and twist keep their coupling; of bend and shear the mean compliance of the two
    directions across counts, all other strains free to follow.
    """
    axial = compliance[np.ix_(AXIAL, AXIAL)]
    matrix = np.linalg.inv(axial)
    # kJ/mol/Å is ten kJ/mol/nm.
    force = A_PER_NM / KJ_PER_MOL_PER_PN_NM
    torque, area = force / A_PER_NM, force / A_PER_NM**2
    across = np.diag(compliance)
    return {
        "stretch_modulus_pN": force * matrix[0, 0],
        "twist_rigidity_pN_nm2": area * matrix[1, 1],
        "twist_stretch_coupling_pN_nm": torque * matrix[0, 1],
        "stretch_modulus_relaxed_pN": force / axial[0, 0],
        "twist_rigidity_relaxed_pN_nm2": area / axial[1, 1],
        "bend_rigidity_pN_nm2": area / across[BENDS].mean(),
        "shear_stiffness_pN": force / across[SHEARS].mean(),
    }
