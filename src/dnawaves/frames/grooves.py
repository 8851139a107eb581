"""Groove widths from the phosphates.

Source: El Hassan & Calladine (1998) J. Mol. Biol. 282, 331-343, as in 3DNA, Lu & Olson (2003)
Nucleic Acids Res. 31, 5108-5121.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dnawaves.frames.vectors import Array, cross, norm

# Two phosphate radii in Å: less this, widths compare with those of Curves (3DNA's note).
PHOSPHATE_DIAMETER_A = 5.8


class GrooveWidths(NamedTuple):
    """P-P distances (steps, ...) in Å; refined: across the mean direction of the two backbones.

    NaN near the ends, where a phosphate is missing. They hold the phosphates' own radii, see
    `PHOSPHATE_DIAMETER_A`.
    """

    minor: Array
    minor_refined: Array
    major: Array
    major_refined: Array


def groove_widths(strand_I_A: Array, strand_II_A: Array) -> GrooveWidths:
    """Return the groove widths at each base-pair step.

    Both arrays are (3, steps, ...), the phosphorus atoms in Å between the pairs of a step: of
    the second pair's nucleotide in strand I, of the first pair's in strand II; NaN if missing.
    Minor: mean of P_I(i+1)-P_II(i-2) and P_I(i+2)-P_II(i-1). Major: P_I(i-2)-P_II(i+2).
    """
    along_I, along_II = _directions(strand_I_A), _directions(strand_II_A)

    def width(offset_I: int, offset_II: int) -> tuple[Array, Array]:
        between = _at(strand_I_A, offset_I) - _at(strand_II_A, offset_II)
        along = _at(along_I, offset_I) + _at(along_II, offset_II)
        return norm(between), norm(cross(between, along)) / norm(along)

    upper, lower, major = width(1, -2), width(2, -1), width(-2, 2)
    return GrooveWidths((upper[0] + lower[0]) / 2, (upper[1] + lower[1]) / 2, *major)


def _at(values: Array, offset: int) -> Array:
    """Return the values (3, steps, ...) `offset` steps on; NaN beyond the ends."""
    moved = np.full_like(values, np.nan)
    steps = values.shape[1]
    there = np.arange(steps) + offset
    inside = (there >= 0) & (there < steps)
    moved[:, inside] = values[:, there[inside]]
    return moved


def _directions(phosphates: Array) -> Array:
    """Return the unit vectors from each phosphate's last neighbour to its next."""
    chord = _at(phosphates, 1) - _at(phosphates, -1)
    return chord / norm(chord)
