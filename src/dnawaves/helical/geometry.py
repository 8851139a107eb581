"""Where the bases are in one frame of time, and which of them face each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from MDAnalysis.lib.distances import minimize_vectors
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.standard import standard_place, standard_ring
from dnawaves.helical.bases import Base
from dnawaves.helical.frames import BaseFit, atom_indices
from dnawaves.helical.imaging import Imaging

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64] | Sequence[int]

# What makes a pair in 3DNA, Lu & Olson (2008) Nat. Protoc. 3, 1213: distance of the origins, its
# part along the mean normal, angle between the normals.
ORIGINS_A, _VERTICAL_A, _NORMALS_DEG = 15.0, 2.5, 65.0
# Rings of crystals and simulations are within 0.1 Å of the standard; anything else is no ring.
_RING_RMSD_A = 0.5


class Bases:
    """Frames of all bases of a structure in one frame of time, each base made whole."""

    def __init__(
        self,
        bases: Sequence[Base],
        positions_A: NDArray[np.floating],
        box: NDArray[np.floating] | None,
    ) -> None:
        self.bases = bases
        self.box = box
        alone = range(len(bases))
        whole = Imaging([len(base.atoms) for base in bases], alone, alone)
        boxes = None if box is None else box[None]
        rings = whole(positions_A[None, atom_indices(bases)], boxes)
        frames = BaseFit(bases)(rings)
        self.frames = Frames(frames.origin[..., 0], frames.axes[..., 0])
        self._refuse_other_atoms(rings[0].astype(np.float64))

    def place(self, number: int, atom: str) -> Floats:
        """Return where the standard base, laid on base `number`, has an atom (3,)."""
        standard = standard_place(self.bases[number].letter, atom)
        origin, axes = self.frames.origin[:, number], self.frames.axes[:, :, number]
        return np.asarray(origin + standard @ axes)

    def sugars(self) -> Floats:
        """Return the places of C1' (bases, 3)."""
        return np.array([self.place(number, "C1'") for number in range(len(self.bases))])

    def between(self, starts: Floats, ends: Floats) -> Floats:
        """Return the vectors (n, 3) from places to the nearest image of other places."""
        vectors = ends - starts
        return vectors if self.box is None else minimize_vectors(vectors, box=self.box)

    def face(self, first: Numbers, second: Numbers) -> NDArray[np.bool_]:
        """Return whether bases lie as those of a pair do, by the three distances of 3DNA."""
        one, other = list(first), list(second)
        z1, z2 = self.frames.axes[2][:, one], self.frames.axes[2][:, other]
        cosine = (z1 * z2).sum(axis=0)
        normal = z1 + np.sign(cosine) * z2
        apart = self.between(self.frames.origin[:, one].T, self.frames.origin[:, other].T).T
        with np.errstate(invalid="ignore", divide="ignore"):
            vertical = np.abs((apart * normal).sum(axis=0)) / np.linalg.norm(normal, axis=0)
        return (
            (np.linalg.norm(apart, axis=0) <= ORIGINS_A)
            & (vertical <= _VERTICAL_A)
            & (np.abs(cosine) >= np.cos(np.radians(_NORMALS_DEG)))
        )

    def _refuse_other_atoms(self, rings_A: Floats) -> None:
        rmsd_A = []
        begin = 0
        for number, base in enumerate(self.bases):
            here = rings_A[begin : begin + len(base.atoms)]
            begin += len(base.atoms)
            if len(here) and np.isfinite(self.frames.axes[0, 0, number]):
                standard = np.array([standard_ring(base.letter)[atom] for atom in base.atoms])
                fitted = self.frames.origin[:, number] + standard @ self.frames.axes[:, :, number]
                rmsd_A.append(np.sqrt(((here - fitted) ** 2).sum(axis=1).mean()))
        if rmsd_A and np.median(rmsd_A) > _RING_RMSD_A:
            raise InputError(
                "the atoms named as base rings do not lie as rings do: in the median"
                f" {np.median(rmsd_A):.1f} Å from the standard base, allowed are {_RING_RMSD_A} Å;"
                " do topology and trajectory list the same atoms in the same order?"
            )
