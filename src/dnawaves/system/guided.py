"""A duplex held at one end and guided at the other: its static response and rod constants.

The guided base pair slides along the axis, or turns about it, as a rigid body and nothing else: a
free end would buckle. A rod held at one end gives way sideways beyond Euler's load pi² B/(4 L²),
11 pN for 24 base pairs with the paper's bend stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial.transform import Rotation

from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]

STATIC_WAVES = ("extension", "twist")
# What is kept from following the load: nothing; each base pair's displacement across the axis;
# its tilt out of the plane across the axis as well.
LOCKS: dict[str, tuple[str, ...]] = {
    "nothing": (),
    "across": ("shear",),
    "across_and_tilt": ("shear", "bend"),
}


@dataclass(frozen=True)
class GuidedEnd:
    """Coordinates of a duplex whose first pairs are held and whose last pair is guided.

    The coordinates are those of the free atoms in nm and, last, the slide in nm or turn in rad.
    """

    duplex: SimulatedDuplex
    wave: str
    held: int

    @property
    def free(self) -> NDArray[np.bool_]:
        """Atoms that move by themselves, shape (atoms,)."""
        pairs = self.duplex.pairs
        return (pairs >= self.held) & (pairs < self.duplex.pair_count - 1)

    @property
    def guided(self) -> NDArray[np.bool_]:
        """Atoms of the guided base pair, shape (atoms,)."""
        return self.duplex.pairs == self.duplex.pair_count - 1

    def start(self) -> Array:
        """Return the coordinates of the unloaded structure."""
        return np.append(self.duplex.positions_nm[self.free].ravel(), 0.0)

    def positions(self, coordinates: Array) -> Array:
        """Return the positions (atoms, 3) that belong to the coordinates."""
        frame, positions = self.duplex.frame, self.duplex.positions_nm.copy()
        positions[self.free] = coordinates[:-1].reshape(-1, 3)
        if self.wave == "extension":
            positions[self.guided] += coordinates[-1] * frame.axis
        else:
            turn = Rotation.from_rotvec(coordinates[-1] * frame.axis)
            arms = positions[self.guided] - frame.origin_nm
            positions[self.guided] = frame.origin_nm + turn.apply(arms)
        return positions

    def motion(self, positions: Array) -> Array:
        """Return the guided atoms' derivative by the last coordinate, (guided atoms, 3)."""
        frame = self.duplex.frame
        if self.wave == "extension":
            return np.broadcast_to(frame.axis, (int(self.guided.sum()), 3))
        return np.cross(frame.axis, positions[self.guided] - frame.origin_nm)

    def force(self, positions: Array, forces: Array) -> Array:
        """Return the forces on the coordinates that belong to forces (atoms, 3) on the atoms."""
        along = float(np.sum(forces[self.guided] * self.motion(positions)))
        return np.append(forces[self.free].ravel(), along)

    def hessian(self, atoms: Array) -> Array:
        """Return the Hessian in these coordinates from that of the atoms at the start."""
        free = np.repeat(self.free, 3)
        column = np.zeros(len(free))
        column[np.repeat(self.guided, 3)] = self.motion(self.duplex.positions_nm).ravel()
        reduced = np.empty((int(free.sum()) + 1,) * 2)
        reduced[:-1, :-1] = atoms[np.ix_(free, free)]
        product = atoms @ column
        reduced[:-1, -1] = reduced[-1, :-1] = product[free]
        reduced[-1, -1] = column @ product
        return reduced

    def rigid_coordinates(self, waves: tuple[str, ...]) -> Array:
        """Return the free pairs' transverse rigid-body coordinates as rows over the coordinates.

        "shear" is a pair's displacement across the axis at its height, "bend" its rotation about
        the two transverse directions; both are linear in small displacements of the atoms.
        """
        duplex, pairs = self.duplex, slice(self.held, -1)
        columns = duplex.bodies.velocity_map()[:, np.repeat(self.free, 3)].toarray()
        linear, angular = np.split(columns.reshape(duplex.pair_count, 6, -1)[pairs], 2, axis=1)
        lever = (duplex.pivots_nm - duplex.bodies.centres_nm)[pairs, :, None]
        motions = {"shear": linear + np.cross(angular, lever, axis=1), "bend": angular}
        across = duplex.frame.directions[:2]
        rows = np.concatenate([across @ motions[wave] for wave in waves], axis=1)
        return np.pad(rows.reshape(-1, columns.shape[1]), ((0, 0), (0, 1)))


def linear_response(end: GuidedEnd, hessian: Array) -> dict[str, float]:
    """Return the slide (nm) or turn (rad) of the guided end under a unit load, for each lock.

    The load is 1 kJ/mol/nm or 1 kJ/mol. With a lock, Lagrange multipliers keep rigid-body
    coordinates of the free base pairs at zero, while all that is inside them relaxes. A wave too
    fast for the transverse motion to follow sees the locked stiffness.
    """
    reduced = end.hessian(hessian)
    push = np.zeros(len(reduced))
    push[-1] = 1.0
    # Positive definite at a minimum, and no shift: it would stiffen long duplexes.
    factor = cho_factor(reduced, check_finite=False)
    response = cho_solve(factor, push)
    answers = {}
    for lock, waves in LOCKS.items():
        locked = response
        if waves:
            constraints = end.rigid_coordinates(waves)
            solved = cho_solve(factor, constraints.T)
            multipliers = np.linalg.solve(constraints @ solved, constraints @ response)
            locked = response - solved @ multipliers
        answers[lock] = float(locked[-1])
    return answers


def line_density(duplex: SimulatedDuplex, wave: str) -> float:
    """Return mass per length (Da/nm) for extension, moment of inertia per length for twist."""
    per_pair = duplex.bodies.masses_Da if wave == "extension" else duplex.axial_inertia_Da_nm2
    return float(per_pair.mean()) / duplex.spacing_nm


def speed_A_per_ps(duplex: SimulatedDuplex, wave: str, load: float, displacement: float) -> float:
    """Return √(modulus / density) of the rod that a load displaces so far over its whole length.

    Load in kJ/mol/nm or kJ/mol, displacement of the guided end in nm or rad.
    """
    length_nm = float(duplex.heights_nm[-1] - duplex.heights_nm[0])
    modulus = load * length_nm / displacement
    return A_PER_NM * float(np.sqrt(modulus / line_density(duplex, wave)))


def first_estimates_A_per_ps(duplex: SimulatedDuplex, hessian: Array) -> dict[str, float]:
    """Return extension and twist speeds of a rod with the duplex's static linear response.

    Made to choose the length of a record and its frames, not to be reported as a measurement.
    """
    return {
        wave: speed_A_per_ps(
            duplex, wave, 1.0, linear_response(GuidedEnd(duplex, wave, 1), hessian)["nothing"]
        )
        for wave in STATIC_WAVES
    }
