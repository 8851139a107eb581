"""A chain of rigid base pairs whose steps and masses differ from place to place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from dnawaves.errors import InputError
from dnawaves.rod.rod import FloatArray, Rod, cross_matrix, require_positive_definite


@dataclass(frozen=True, eq=False)
class StepSequence:
    """Base pairs and the steps between them, each with constants of its own.

    Step j joins base pairs j and j + 1. Its strain is (E x_{j+1} - E^-1 x_j)/a with
    E = exp(a A_j/2) (mid-frame strains) and its energy a/2 strain.K_j.strain; x are the coordinates
    of each base pair's own frame.

    Parameters
    ----------
    stiffness : (steps, 6, 6)
        In units of `Rod`: the stiffness of a step (kJ/mol/nm^2, kJ/mol/nm, kJ/mol) times a.
    gamma0 : (steps, 3)
    omega0_rad_per_nm : (steps, 3)
        Intrinsic strains of each step, as of `Rod`.
    mass : (steps + 1, 6, 6)
        Mass of each base pair: Da, Da nm, Da nm^2.
    spacing_nm : float

    Raises
    ------
    InputError
        If a shape is wrong or a stiffness or mass is not symmetric and positive definite.
    """

    stiffness: FloatArray
    gamma0: FloatArray
    omega0_rad_per_nm: FloatArray
    mass: FloatArray
    spacing_nm: float

    def __post_init__(self) -> None:
        steps = len(self.stiffness)
        if steps < 1:
            raise InputError("a chain has at least 2 base pairs, so one step")
        if not (np.isfinite(self.spacing_nm) and self.spacing_nm > 0):
            raise InputError(f"the spacing is {self.spacing_nm} nm; it must be positive")
        for name, shape in (
            ("stiffness", (steps, 6, 6)),
            ("gamma0", (steps, 3)),
            ("omega0_rad_per_nm", (steps, 3)),
            ("mass", (steps + 1, 6, 6)),
        ):
            array = np.array(getattr(self, name), dtype=float)
            if array.shape != shape or not np.isfinite(array).all():
                raise InputError(
                    f"{name} of the steps has shape {array.shape}; it must be {shape} and finite"
                )
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        require_positive_definite("the stiffness of a step", self.stiffness)
        require_positive_definite("the mass of a base pair", self.mass)

    @classmethod
    def uniform(cls, rod: Rod, pairs: int, mass_blocks: ArrayLike | None = None) -> StepSequence:
        """Return the chain of a rod; `mass_blocks` (6, 6) or (pairs, 6, 6) replace its mass."""
        if pairs < 2:
            raise InputError(f"a chain has at least 2 base pairs, not {pairs}")
        mass = rod.spacing_nm * rod.mass if mass_blocks is None else np.asarray(mass_blocks, float)
        if mass.shape not in ((6, 6), (pairs, 6, 6)):
            raise InputError(
                f"mass_blocks have shape {mass.shape}; they must be (6, 6) or ({pairs}, 6, 6)"
            )
        return cls(
            stiffness=np.tile(rod.stiffness, (pairs - 1, 1, 1)),
            gamma0=np.tile(rod.gamma0, (pairs - 1, 1)),
            omega0_rad_per_nm=np.tile(rod.omega0_rad_per_nm, (pairs - 1, 1)),
            mass=np.broadcast_to(mass, (pairs, 6, 6)),
            spacing_nm=rod.spacing_nm,
        )

    @property
    def pairs(self) -> int:
        return len(self.mass)

    def with_steps(self, steps: slice, rod: Rod) -> StepSequence:
        """Return this chain with some steps of another rod: softer, stiffer or bent."""
        if not np.isclose(rod.spacing_nm, self.spacing_nm, rtol=1e-9, atol=0):
            raise InputError(
                f"the steps' spacing is {rod.spacing_nm} nm, that of the chain {self.spacing_nm} nm"
            )
        changed = {
            name: np.array(getattr(self, name))
            for name in ("stiffness", "gamma0", "omega0_rad_per_nm")
        }
        for name, array in changed.items():
            array[steps] = getattr(rod, name)
        return replace(self, **changed)  # type: ignore[arg-type]

    def with_bound(self, pair: int, body: FloatArray) -> StepSequence:
        """Return this chain with a body bound rigidly to a base pair (see `body_mass`)."""
        if not -self.pairs <= pair < self.pairs:
            raise InputError(f"base pair {pair} is not in a chain of {self.pairs}")
        mass = np.array(self.mass)
        mass[pair] += body
        return replace(self, mass=mass)

    def links(self) -> FloatArray:
        """Return B (steps, 6, 12): the energy of step j is |B_j (x_j, x_{j+1})|^2/2."""
        connection = np.zeros((len(self.stiffness), 6, 6))
        for block, gamma0, omega0 in zip(
            connection, self.gamma0, self.omega0_rad_per_nm, strict=True
        ):
            block[:3, :3] = block[3:, 3:] = cross_matrix(omega0)
            block[:3, 3:] = cross_matrix(gamma0)
        different, where = np.unique(connection, axis=0, return_inverse=True)
        half = different * self.spacing_nm / 2
        strain = np.concatenate([-scipy.linalg.expm(-half), scipy.linalg.expm(half)], axis=-1)
        root = np.linalg.cholesky(self.stiffness / self.spacing_nm).transpose(0, 2, 1)
        return root @ strain[where.ravel()]

    def matrices(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return strain root B (6 steps, n), stiffness B^T B and mass (n, n), n = 6 pairs."""
        links, n = self.links(), 6 * self.pairs
        root, stiffness = np.zeros((n - 6, n)), np.zeros((n, n))
        for start, link in zip(range(0, n - 6, 6), links, strict=True):
            root[start : start + 6, start : start + 12] = link
            stiffness[start : start + 12, start : start + 12] += link.T @ link
        return root, stiffness, scipy.linalg.block_diag(*self.mass)


def body_mass(
    mass_Da: float, inertia_Da_nm2: ArrayLike = 0.0, centre_nm: ArrayLike = (0.0, 0.0, 0.0)
) -> FloatArray:
    """Return the mass (6, 6) of a rigid body in the frame of the base pair that it is bound to.

    The inertia, (3, 3), (3,) or a number, is about its own centre of mass, which lies at `centre`.
    """
    inertia = np.asarray(inertia_Da_nm2, dtype=float)
    inertia = inertia if inertia.ndim == 2 else inertia * np.eye(3)
    arm = cross_matrix(centre_nm)
    return np.block(
        [
            [mass_Da * np.eye(3), -mass_Da * arm],
            [mass_Da * arm, inertia + mass_Da * arm.T @ arm],
        ]
    )
