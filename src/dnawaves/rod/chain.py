"""Finite chains of base pairs: all six coordinates, one bending plane, one coordinate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.modal import ModalChain, free_pairs
from dnawaves.rod.rod import BEND_2, SHEAR_1, Rod
from dnawaves.rod.sequence import StepSequence
from dnawaves.units import A_PER_NM

PLANE = [SHEAR_1, BEND_2]


class SequenceChain(ModalChain):
    """Chain of rigid base pairs whose steps and masses may differ; fields (pairs, 6).

    Coordinates are those of each base pair's own frame: nm and rad, velocities nm/ps and rad/ps,
    forces kJ/mol/nm and kJ/mol.

    Parameters
    ----------
    sequence : StepSequence
    held : sequence of int
        Base pairs (0 is the first, -1 the last) all of whose coordinates stay zero.
    pinned : sequence of int
        Base pairs whose position stays, while they rotate freely.
    """

    def __init__(
        self, sequence: StepSequence, held: Sequence[int] = (), pinned: Sequence[int] = ()
    ) -> None:
        root, stiffness, mass = sequence.matrices()
        super().__init__(stiffness, mass, _free_coordinates(sequence.pairs, held, pinned), root)


class FiniteChain(SequenceChain):
    """Uniform chain of rigid base pairs with the constants of a rod; see `SequenceChain`.

    `mass_blocks` (6, 6) or (pairs, 6, 6), Da, Da nm, Da nm^2, are the mass of each base pair; by
    default the rod's mass times its spacing.
    """

    def __init__(
        self,
        rod: Rod,
        pairs: int,
        held: Sequence[int] = (),
        mass_blocks: ArrayLike | None = None,
        pinned: Sequence[int] = (),
    ) -> None:
        super().__init__(StepSequence.uniform(rod, pairs, mass_blocks), held, pinned)


class PlaneChain(ModalChain):
    """Bend and shear of a straight untwisted lattice in one plane; fields (pairs, 2) = (u1, th2).

    Arguments as `FiniteChain`. Raises InputError if the plane is coupled to other motion.
    """

    def __init__(
        self, rod: Rod, pairs: int, held: Sequence[int] = (), pinned: Sequence[int] = ()
    ) -> None:
        in_plane = np.tile(np.isin(np.arange(6), PLANE), pairs)
        root, stiffness, mass = StepSequence.uniform(rod, pairs).matrices()
        for matrix in (stiffness, mass):
            if np.any(np.abs(matrix[np.ix_(in_plane, ~in_plane)]) > 1e-9 * np.abs(matrix).max()):
                raise InputError(
                    "bending in this plane is coupled to other motion; "
                    "see Rod.averaged_about_axis for the straight, untwisted rod"
                )
        plane = np.ix_(in_plane, in_plane)
        free = _free_coordinates(pairs, held, pinned)[:, PLANE]
        super().__init__(stiffness[plane], mass[plane], free, root[:, in_plane])


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
        root = np.sqrt(links)[:, np.newaxis] * np.diff(np.eye(len(mass)), axis=0)
        super().__init__(root.T @ root, np.diag(mass), free, root)

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


def _free_coordinates(pairs: int, held: Sequence[int], pinned: Sequence[int]) -> NDArray[np.bool_]:
    """Return which coordinates (pairs, 6) may move."""
    free = np.repeat(free_pairs(pairs, held)[:, np.newaxis], 6, axis=1)
    free[~free_pairs(pairs, pinned), :3] = False
    return free
