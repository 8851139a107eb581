"""The frame of every base of a trajectory: the standard frame fitted to its ring atoms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames, fit_frames
from dnawaves.frames.standard import standard_ring
from dnawaves.helical.bases import Base

_MINIMUM_ATOMS = 3


def base_frames(positions_A: NDArray[np.floating], bases: Sequence[Base]) -> Frames:
    """Fit the frame of every base in every frame of time.

    `positions_A` is (times, atoms, 3); the result runs over (bases, times). A base with fewer
    than three ring atoms gets NaN.
    """
    times = len(positions_A)
    origin = np.full((3, len(bases), times), np.nan)
    axes = np.full((3, 3, len(bases), times), np.nan)
    alike: dict[tuple[str, tuple[str, ...]], list[int]] = {}
    for number, base in enumerate(bases):
        if len(base.atoms) >= _MINIMUM_ATOMS:
            alike.setdefault((base.letter, base.atoms), []).append(number)
    for (letter, atoms), numbers in alike.items():
        ring = standard_ring(letter)
        standard = np.array([ring[atom] for atom in atoms])
        indices = np.array([bases[number].indices for number in numbers])
        gathered = np.ascontiguousarray(positions_A[:, indices].T, dtype=np.float64)
        origin[:, numbers], axes[:, :, numbers] = fit_frames(standard, gathered)
    return Frames(origin, axes)
