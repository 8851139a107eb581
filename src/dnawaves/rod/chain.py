"""Finite chains of base pairs: the full six-coordinate rod, one bending plane, one coordinate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from dnawaves.errors import InputError
from dnawaves.rod.modal import ModalChain, free_pairs
from dnawaves.rod.rod import BEND_2, SHEAR_1, FloatArray, Rod
from dnawaves.units import A_PER_NM


class FiniteChain(ModalChain):
    """Lattice of rigid base pairs with the rod's constants; fields (pairs, 6).

    The strain of link j is (E x_{j+1} - E^-1 x_j)/a with E = exp(aA/2) (mid-frame strains), its
    energy a/2 strain.K.strain. Coordinates are those of each base pair's own frame: nm and rad,
    velocities nm/ps and rad/ps, forces kJ/mol/nm and kJ/mol.

    Parameters
    ----------
    rod : Rod
    pairs : int
        Number of base pairs.
    held : sequence of int
        Base pairs (0 is the first, -1 the last) all of whose coordinates stay zero.
    mass_blocks : (6, 6) or (pairs, 6, 6), optional
        Mass of each base pair, Da, Da nm, Da nm^2; the rod's mass times its spacing by default.
    """

    def __init__(
        self,
        rod: Rod,
        pairs: int,
        held: Sequence[int] = (),
        mass_blocks: ArrayLike | None = None,
    ) -> None:
        free = np.repeat(free_pairs(pairs, held)[:, np.newaxis], 6, axis=1)
        mass = _mass_matrix(rod, pairs, mass_blocks)
        super().__init__(_stiffness_matrix(rod, pairs), mass, free)


class PlaneChain(ModalChain):
    """Bend and shear of a straight untwisted lattice in one plane; fields (pairs, 2) = (u1, th2).

    Arguments as `FiniteChain`. Raises InputError if the plane is coupled to other motion.
    """

    def __init__(self, rod: Rod, pairs: int, held: Sequence[int] = ()) -> None:
        in_plane = np.tile(np.isin(np.arange(6), [SHEAR_1, BEND_2]), pairs)
        stiffness = _stiffness_matrix(rod, pairs)
        mass = _mass_matrix(rod, pairs, None)
        for matrix in (stiffness, mass):
            if np.any(np.abs(matrix[np.ix_(in_plane, ~in_plane)]) > 1e-9 * np.abs(matrix).max()):
                raise InputError(
                    "bending in this plane is coupled to other motion; "
                    "see Rod.averaged_about_axis for the straight, untwisted rod"
                )
        free = np.repeat(free_pairs(pairs, held)[:, np.newaxis], 2, axis=1)
        plane = np.ix_(in_plane, in_plane)
        super().__init__(stiffness[plane], mass[plane], free)


class ScalarChain(ModalChain):
    """Masses on a line joined by springs, for extension or twist alone; fields (pairs,).

    Parameters
    ----------
    masses : (pairs,)
        Da, or Da nm^2 for twist.
    link_stiffness : float or (pairs - 1,)
        kJ/mol/nm^2, or kJ/mol for twist.
    held : sequence of int
        Base pairs (0 is the first, -1 the last) that do not move.
    """

    def __init__(
        self, masses: ArrayLike, link_stiffness: ArrayLike, held: Sequence[int] = ()
    ) -> None:
        mass = np.asarray(masses, dtype=float)
        if mass.ndim != 1 or not np.all(mass > 0):
            raise InputError("the masses of a scalar chain are one positive number per base pair")
        free = free_pairs(len(mass), held)
        links = np.broadcast_to(np.asarray(link_stiffness, dtype=float), (len(mass) - 1,))
        if not np.all(links > 0):
            raise InputError("the link stiffness of a scalar chain must be positive")
        strain = np.diff(np.eye(len(mass)), axis=0)
        super().__init__(strain.T @ (links[:, np.newaxis] * strain), np.diag(mass), free)

    @classmethod
    def from_speed(
        cls,
        pairs: int,
        speed_A_per_ps: float,
        spacing_nm: float,
        held: Sequence[int] = (),
        masses: ArrayLike | None = None,
    ) -> ScalarChain:
        """Return the uniform chain whose long waves have this speed.

        The stiffness of each link is mean(masses) (V/a)^2; masses are all 1 by default. For a fit
        of the speed, build one chain and use `scaled`.
        """
        if not speed_A_per_ps > 0:
            raise InputError(f"the speed is {speed_A_per_ps} A/ps; it must be positive")
        mass = np.ones(pairs) if masses is None else np.asarray(masses, dtype=float)
        if mass.shape != (pairs,):
            raise InputError(f"masses have shape {mass.shape} for a chain of {pairs} base pairs")
        return cls(mass, mass.mean() * (speed_A_per_ps / A_PER_NM / spacing_nm) ** 2, held)


def _stiffness_matrix(rod: Rod, pairs: int) -> FloatArray:
    half_step = scipy.linalg.expm(rod.spacing_nm * rod.connection / 2)
    strain = np.hstack([-np.linalg.inv(half_step), half_step]) / rod.spacing_nm
    link = rod.spacing_nm * strain.T @ rod.stiffness @ strain
    matrix = np.zeros((6 * pairs, 6 * pairs))
    for start in range(0, 6 * (pairs - 1), 6):
        matrix[start : start + 12, start : start + 12] += link
    return matrix


def _mass_matrix(rod: Rod, pairs: int, mass_blocks: ArrayLike | None) -> FloatArray:
    blocks = rod.spacing_nm * rod.mass if mass_blocks is None else np.asarray(mass_blocks, float)
    if blocks.shape not in ((6, 6), (pairs, 6, 6)):
        raise InputError(
            f"mass_blocks have shape {blocks.shape}; they must be (6, 6) or ({pairs}, 6, 6)"
        )
    return scipy.linalg.block_diag(*np.broadcast_to(blocks, (pairs, 6, 6)))
