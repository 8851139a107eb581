"""What is looked at in a pair of runs: the kicked wave's velocities and the helical parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames, fit_frames
from dnawaves.frames.parameters import (
    PAIR_PARAMETERS,
    STEP_PARAMETERS,
    pair_parameters,
    step_parameters,
)
from dnawaves.frames.standard import standard_ring
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]
HELICAL = (*STEP_PARAMETERS, *PAIR_PARAMETERS)


@dataclass(frozen=True)
class Observed:
    """Half the difference of the two signs, at `times_ps` (frames,).

    `velocity` (frames, N) of the kicked wave in Å/ps or rad/ps, `helical` (12, frames, N) in Å and
    degrees; of a step parameter the last of the N values is zero.
    """

    times_ps: Array
    velocity: Array
    helical: Array


class Observer:
    """Reads the wave and the helical parameters out of the atoms of one duplex."""

    def __init__(self, duplex: SimulatedDuplex, wave: str) -> None:
        self._duplex, self._wave = duplex, wave
        self._lever = duplex.pivots_nm - duplex.bodies.centres_nm

    def velocity(self, positions_nm: Array, velocities_nm_per_ps: Array) -> Array:
        """Return the wave's velocity (N,), of the points of the helix axis at the pairs."""
        linear, angular = self._duplex.bodies.velocity(positions_nm, velocities_nm_per_ps)
        first, second, axis = self._duplex.frame.directions
        if self._wave in ("twist", "bend"):
            return angular @ (axis if self._wave == "twist" else second)
        moved = linear + np.cross(angular, self._lever)
        return A_PER_NM * moved @ (axis if self._wave == "extension" else first)

    def helical(self, positions_nm: Array) -> Array:
        """Return shift to twist and shear to opening (12, frames, N) of (frames, atoms, 3)."""
        places = A_PER_NM * np.moveaxis(positions_nm, 0, -1)
        first, second = (
            [
                fit_frames(ring, places[atoms].transpose(1, 0, 2))
                for ring, atoms in self._rings[strand]
            ]
            for strand in (0, 1)
        )
        pairs = pair_parameters(_stacked(first), _stacked(second[::-1]))
        steps = step_parameters(pairs.middle).values
        padded = np.concatenate([steps, np.zeros_like(steps[:, :1])], axis=1)
        return np.concatenate([padded, pairs.values]).swapaxes(1, 2)

    @cached_property
    def _rings(self) -> list[list[tuple[Array, list[int]]]]:
        rings = []
        for chain in self._duplex.topology.chains():
            strand = []
            for residue in chain.residues():
                ring = standard_ring(residue.name[-1])
                index = {atom.name: atom.index for atom in residue.atoms()}
                strand.append((np.array(list(ring.values())), [index[name] for name in ring]))
            rings.append(strand)
        return rings


def odd(plus: Array, minus: Array) -> Array:
    """Return half the difference of the two signs, in which what is even in the kick cancels."""
    return 0.5 * (plus - minus)


def _stacked(frames: list[Frames]) -> Frames:
    return Frames(
        np.stack([one.origin for one in frames], axis=1),
        np.stack([one.axes for one in frames], axis=2),
    )
