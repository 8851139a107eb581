"""Normal modes of a duplex at its minimum, and what each is to the rigid-body motion of its pairs.

In mass-weighted coordinates the modes of the free atoms are orthonormal, so the answer to anything
that moves or pushes base pairs as rigid bodies needs only their frequencies and the rigid-body
motion of each pair in each mode.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.linalg import eigh

from dnawaves.errors import InputError, SimulationError
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.rigid_body import RigidBodies

Array = NDArray[np.float64]

RIGID_MODES = 6
# Along a mode of -1e-4 ps⁻² the difference of two runs grows by 1 % in 14 ps, longer than a
# crossing of 24 base pairs; differences of forces leave rigid modes within 2e-6 ps⁻² of zero.
EIGENVALUE_TOLERANCE_PER_PS2 = 1e-4


@dataclass(frozen=True)
class NormalModes:
    """Normal modes of bodies whose other degrees of freedom follow without being looked at.

    Parameters
    ----------
    bodies : the base pairs; masses and inertia of those that are held count as well
    eigenvalues_per_ps2 : (modes,) ascending
    shapes : (modes, N, 6) velocity and angular velocity (x, y, z) of each pair in a mode whose
        mass-weighted coordinate changes by 1 nm √Da per ps; zero for held pairs
    rigid : number of rigid motions among the modes: those of smallest modulus are taken for them
    """

    bodies: RigidBodies
    eigenvalues_per_ps2: Array
    shapes: Array
    rigid: int

    @property
    def vibrations(self) -> NDArray[np.bool_]:
        """Which modes are no rigid motions, (modes,)."""
        moves = np.ones(len(self.eigenvalues_per_ps2), dtype=bool)
        moves[np.argsort(np.abs(self.eigenvalues_per_ps2))[: self.rigid]] = False
        return moves

    @property
    def frequencies_rad_per_ps(self) -> Array:
        """Frequencies (modes,); exactly zero for rigid motions.

        Raises
        ------
        SimulationError
            When a mode is unstable beyond the tolerance.
        """
        lowest = float(self.eigenvalues_per_ps2[0])
        if lowest < -EIGENVALUE_TOLERANCE_PER_PS2:
            raise SimulationError(
                f"the structure is no minimum: its lowest eigenvalue is {lowest:.3g} ps^-2, "
                f"allowed is at least {-EIGENVALUE_TOLERANCE_PER_PS2:g}"
            )
        squared = np.where(self.vibrations, np.maximum(self.eigenvalues_per_ps2, 0.0), 0.0)
        return np.sqrt(squared)

    @property
    def static_eigenvalues_per_ps2(self) -> Array:
        """Eigenvalues of the vibrations, by which the answers to what is constant are divided.

        Raises
        ------
        SimulationError
            When one is not positive, also within the tolerance: such an answer has no bound.
        """
        values = self.eigenvalues_per_ps2[self.vibrations]
        if not (values > 0).all():
            raise SimulationError(
                f"the structure is no minimum: a vibration has the eigenvalue {values.min():.3g} "
                "ps^-2, allowed is above 0"
            )
        return values

    def amplitudes(self, momenta: Array) -> Array:
        """Return each mode's share (modes,) of rigid-body momenta (N, 6), or of forces alike.

        Momentum in Da nm/ps and angular momentum about the centre of mass of pairs that move as
        rigid bodies give √Da nm/ps; forces and torques that accelerate them so, √Da nm/ps².
        """
        return np.einsum("mnc,nc->m", self.shapes, momenta)

    def motion(self, coordinates: Array) -> Array:
        """Return the pairs' motion (..., N, 6) from the modes' coordinates (..., modes)."""
        return np.tensordot(coordinates, self.shapes, axes=1)

    def static_response(self, forces: Array) -> Array:
        """Return displacement and rotation (N, 6) under constant forces and torques (N, 6).

        Raises
        ------
        InputError
            When the forces push the whole duplex and nothing holds it.
        SimulationError
            When a vibration's eigenvalue is not positive.
        """
        amplitudes, moves = self.amplitudes(forces), self.vibrations
        if np.abs(amplitudes[~moves]).max(initial=0.0) > 1e-6 * np.abs(amplitudes).max():
            raise InputError("the forces or torques do not balance, and no end is held")
        coordinates = np.zeros_like(amplitudes)
        coordinates[moves] = amplitudes[moves] / self.static_eigenvalues_per_ps2
        return self.motion(coordinates)

    def compliance(self, shapes: Array) -> Array:
        """Return ⟨x x⟩ / kBT (..., ...) of coordinates x that move as `shapes` (modes, ...) say.

        Rigid motions are left out. Raises `SimulationError` as `static_response` does.
        """
        values = self.static_eigenvalues_per_ps2
        flat = shapes[self.vibrations].reshape(len(values), -1)
        product = flat.T @ (flat / values[:, None])
        return product.reshape(*shapes.shape[1:], *shapes.shape[1:])


def normal_modes(
    hessian: scipy.sparse.csr_array,
    masses_Da: Array,
    bodies: RigidBodies,
    free: NDArray[np.bool_],
) -> NormalModes:
    """Return the normal modes of the free atoms; the others do not move.

    Parameters
    ----------
    hessian : (3 atoms, 3 atoms) in kJ/mol/nm²
    free : (atoms,) which atoms move
    """
    moving = np.repeat(free, 3)
    weights = np.repeat(1 / np.sqrt(masses_Da), 3)[moving]
    weighted = hessian[moving][:, moving].toarray()
    weighted *= weights
    weighted *= weights[:, None]
    # Divide and conquer: all modes several times sooner than by SciPy's default driver.
    values, vectors = eigh(weighted, driver="evd", overwrite_a=True, check_finite=False)
    vectors *= weights[:, None]
    shapes = bodies.velocity_map()[:, moving] @ vectors
    return NormalModes(
        bodies, values, shapes.T.reshape(len(values), -1, 6), RIGID_MODES if free.all() else 0
    )


def participation(modes: NormalModes, duplex: SimulatedDuplex) -> dict[str, Array]:
    """Return the share of each mode's kinetic energy in each wave and base pair, (modes, N).

    Half of velocity times momentum, and of angular velocity times angular momentum, at the point
    of the helix axis at the pair; along and about the axis and across it. The shares of one mode
    add up to that of rigid-body motion; what is left of 1 moves inside the pairs. A single share
    can be slightly negative, because the centre of mass lies beside the axis.
    """
    bodies = duplex.bodies
    momenta = bodies.momenta(modes.shapes)
    lever = duplex.pivots_nm - bodies.centres_nm
    linear, angular = modes.shapes[..., :3], modes.shapes[..., 3:]
    velocity = linear + np.cross(angular, lever)
    moment = momenta[..., 3:] - np.cross(lever, momenta[..., :3])
    axes = duplex.frame.directions.T
    along = (velocity @ axes) * (momenta[..., :3] @ axes)
    about = (angular @ axes) * (moment @ axes)
    return {
        "extension": along[..., 2],
        "twist": about[..., 2],
        "bend": about[..., :2].sum(axis=-1),
        "shear": along[..., :2].sum(axis=-1),
    }
