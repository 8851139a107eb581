"""Frequencies and mass-normalised shapes of K x = w^2 M x, from K or from its strain root."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from dnawaves.errors import InputError

FloatArray = NDArray[np.float64]
Modes = tuple[FloatArray, FloatArray]

# relative to the largest squared frequency: below it lies the round-off of the eigensolver
ZERO_MODE = 1e-12
# relative to the largest frequency: below it lies the round-off of singular values
ZERO_SINGULAR_VALUE = 1e-13


def modes_of_stiffness(stiffness: FloatArray, mass: FloatArray, zero_mode: float) -> Modes:
    """Return frequencies (modes,), ascending, and shapes (modes, n); mass is (n, n) or (n,).

    Overwrites `stiffness`. Squared frequencies below `zero_mode` times the largest are zero.
    Raises InputError if one is negative beyond that.
    """
    if mass.ndim == 1:
        if not np.all(mass > 0):
            raise InputError("the masses of the chain are not positive")
        scale = 1 / np.sqrt(mass)
        stiffness *= scale
        stiffness *= scale[:, np.newaxis]
        # the transpose of a symmetric matrix: LAPACK's order, so that nothing is copied
        squared, vectors = scipy.linalg.eigh(stiffness.T, overwrite_a=True)
        vectors *= scale[:, np.newaxis]
    else:
        try:
            squared, vectors = scipy.linalg.eigh(stiffness, mass)
        except scipy.linalg.LinAlgError as error:
            raise InputError("the masses of the chain are not positive definite") from error
    squared[np.abs(squared) < zero_mode * np.abs(squared).max()] = 0.0
    if squared[0] < 0:
        raise InputError("the stiffness of the chain is not positive: it has no stable rest")
    return np.sqrt(squared), vectors.T


def modes_of_strain(strain_root: FloatArray, mass: FloatArray) -> Modes:
    """Return the same for the stiffness B^T B of a strain root B (r, n), without forming it.

    The frequencies are the singular values of B M^(-1/2): soft modes keep their digits beside
    stiff ones, and motions without strain have the frequency 0. Coordinates that do not act on
    each other are solved apart, so that degenerate modes of different motions do not mix.
    """
    pattern = scipy.sparse.csr_array((strain_root != 0).astype(float))
    coupling = pattern.T @ pattern + scipy.sparse.csr_array((mass != 0).astype(float))
    count, label = connected_components(coupling, directed=False)
    n = strain_root.shape[1]
    frequencies, shapes, filled = np.zeros(n), np.zeros((n, n)), 0
    for part in range(count):
        columns = np.flatnonzero(label == part)
        root = strain_root[:, columns]
        part_modes = _modes_of_part(root[root.any(axis=1)], mass[np.ix_(columns, columns)])
        here = slice(filled, filled + len(columns))
        frequencies[here], shapes[here, columns] = part_modes
        filled += len(columns)
    frequencies[frequencies < ZERO_SINGULAR_VALUE * frequencies.max()] = 0.0
    order = np.argsort(frequencies, kind="stable")
    return frequencies[order], shapes[order]


def _modes_of_part(strain_root: FloatArray, mass: FloatArray) -> Modes:
    try:
        mass_root = scipy.linalg.cholesky(mass, lower=True)
    except scipy.linalg.LinAlgError as error:
        raise InputError("the masses of the chain are not positive definite") from error
    rows, columns = strain_root.shape
    whitened = scipy.linalg.solve_triangular(mass_root, strain_root.T, lower=True).T
    # more coordinates than strains: the remaining right vectors are the motions without strain
    _, values, vectors = scipy.linalg.svd(whitened, full_matrices=rows < columns)
    frequencies = np.zeros(columns)
    frequencies[: len(values)] = values
    return frequencies, scipy.linalg.solve_triangular(mass_root, vectors.T, trans="T", lower=True).T
