"""Where the base pairs and the helix axis of a duplex are."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from openmm import app, unit
from scipy.optimize import least_squares

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class HelixFrame:
    """A straight helix axis with two transverse directions, right-handed.

    `origin_nm` (3,) is a point of the axis; the rows of `directions` (3, 3) are two transverse
    unit vectors and the axis, which runs from base pair 1 to base pair N. The first transverse
    direction lies along the long axis of base pair 1.
    """

    origin_nm: Array
    directions: Array

    @property
    def axis(self) -> Array:
        """Unit vector along the helix, shape (3,)."""
        return self.directions[2]

    def height_nm(self, positions_nm: Array) -> Array:
        """Return the coordinate along the axis of positions (..., 3)."""
        height: Array = (positions_nm - self.origin_nm) @ self.axis
        return height

    def on_axis(self, positions_nm: Array) -> Array:
        """Return the points of the axis nearest to positions (..., 3)."""
        return self.origin_nm + self.height_nm(positions_nm)[..., None] * self.axis


def strands(topology: app.Topology) -> tuple[app.topology.Chain, app.topology.Chain]:
    """Return strand I and II: the first two chains, before water and ions."""
    first, second = islice(topology.chains(), 2)
    return first, second


def duplex_topology(topology: app.Topology) -> app.Topology:
    """Return the topology of the two strands alone."""
    alone = app.Modeller(topology, np.zeros((topology.getNumAtoms(), 3)) * unit.nanometer)
    alone.delete(list(islice(topology.chains(), 2, None)))
    alone.topology.setPeriodicBoxVectors(None)
    return alone.topology


def pair_of_atoms(topology: app.Topology) -> Indices:
    """Return, for every atom of the duplex, the index (from 0) of its nucleotide's base pair."""
    first, second = (list(chain.residues()) for chain in strands(topology))
    atoms = sum(1 for chain in strands(topology) for _ in chain.atoms())
    pairs = np.empty(atoms, dtype=np.intp)
    for index, (one, other) in enumerate(zip(first, reversed(second), strict=True)):
        for residue in (one, other):
            for atom in residue.atoms():
                pairs[atom.index] = index
    return pairs


def sugar_anchors(topology: app.Topology) -> Indices:
    """Return the atom indices of C1' as (2, N): strand I and II of base pair 1 to N."""
    first, second = (
        [atom.index for atom in chain.atoms() if atom.name == "C1'"] for chain in strands(topology)
    )
    return np.array([first, second[::-1]], dtype=np.intp)


def pair_labels(topology: app.Topology) -> list[str]:
    """Return labels such as 'A:1-B:24' for base pair 1 to N."""
    first, second = strands(topology)
    return [
        f"{first.id}:{one.id}-{second.id}:{other.id}"
        for one, other in zip(first.residues(), reversed(list(second.residues())), strict=True)
    ]


def helix_frame(anchors_nm: Array) -> HelixFrame:
    """Fit the axis of the cylinder through the C1' atoms, given as (2, N, 3).

    A cylinder because the C1' atoms of ideal DNA lie on one: the axis of the fibre model is found
    exactly, and the winding of the base-pair centres about the axis does not tilt it.
    """
    points = anchors_nm.reshape(-1, 3)
    along = (anchors_nm[:, -1] - anchors_nm[:, 0]).sum(axis=0)
    along /= np.linalg.norm(along)
    long_axis = anchors_nm[0, 0] - anchors_nm[1, 0]
    frame = _right_handed(along, long_axis)
    centre = points.mean(axis=0)
    radius = np.linalg.norm(np.cross(points - centre, along), axis=1).mean()

    def line(parameters: Array) -> tuple[Array, Array]:
        tilt = frame[2] + parameters[:2] @ frame[:2]
        return centre + parameters[2:4] @ frame[:2], tilt / np.linalg.norm(tilt)

    def distances(parameters: Array) -> Array:
        origin, axis = line(parameters)
        misfit: Array = np.linalg.norm(np.cross(points - origin, axis), axis=1) - parameters[4]
        return misfit

    fit = least_squares(distances, [0.0, 0.0, 0.0, 0.0, radius], xtol=1e-14, ftol=1e-14, gtol=1e-14)
    origin, axis = line(fit.x)
    return HelixFrame(origin, _right_handed(axis, long_axis))


def _right_handed(axis: Array, transverse: Array) -> Array:
    first = transverse - (transverse @ axis) * axis
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(axis, first), axis])
