"""Helical parameters of a trajectory, as an analysis of MDAnalysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from MDAnalysis import Universe
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.core.groups import AtomGroup

from dnawaves.helical.bases import Base
from dnawaves.helical.dataset import helical_dataset
from dnawaves.helical.pairs import BasePair, find_pairs


class HelicalParameters(AnalysisBase):
    """Base-pair and step parameters of one duplex.

    `atoms` holds the duplex, whole in one periodic image; `pairs` overrides which bases pair
    (see `find_pairs`, whose `InputError` it raises). After `.run()`, `.results.dataset` is the
    data set of `helical_dataset`, time in ps.
    """

    def __init__(
        self, atoms: AtomGroup | Universe, pairs: Sequence[tuple[str, str]] | None = None
    ) -> None:
        universe = atoms.universe
        super().__init__(universe.trajectory)
        found = find_pairs(atoms, pairs)
        bases = [base for pair in found for base in (pair.first, pair.second)]
        used = np.unique(np.concatenate([base.indices for base in bases]))
        self._atoms = universe.atoms[used]
        self._pairs = [
            BasePair(_renumbered(pair.first, used), _renumbered(pair.second, used))
            for pair in found
        ]

    def _prepare(self) -> None:
        self._positions_A = np.empty((self.n_frames, len(self._atoms), 3), dtype=np.float32)

    def _single_frame(self) -> None:
        self._positions_A[self._frame_index] = self._atoms.positions

    def _conclude(self) -> None:
        self.results.dataset = helical_dataset(self._positions_A, self._pairs, self.times)


def _renumbered(base: Base, used: np.ndarray) -> Base:
    return replace(base, indices=np.searchsorted(used, base.indices))
