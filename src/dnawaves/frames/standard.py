"""The standard reference frame of the bases.

Source: Olson et al. (2001) J. Mol. Biol. 313, 229-237, table 1.
"""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files

import numpy as np

from dnawaves.frames.vectors import Array


@cache
def standard_ring(letter: str) -> dict[str, Array]:
    """Return ring atom name -> position (3,) in Å in the frame of base A, C, G, T or U.

    Nine atoms for a purine, six for a pyrimidine: those of the least-squares fit.
    """
    return {
        row["atom"]: _place(row)
        for row in _rows()
        if row["base"] == letter and row["ring_fit_atom"] == "1"
    }


def standard_place(letter: str, atom: str) -> Array:
    """Return the position (3,) in Å of an atom in the frame of base A, C, G, T or U."""
    (row,) = (row for row in _rows() if (row["base"], row["atom"]) == (letter, atom))
    return _place(row)


def _place(row: dict[str, str]) -> Array:
    return np.array([float(row[axis]) for axis in "xyz"])


@cache
def _rows() -> list[dict[str, str]]:
    table = files("dnawaves.frames").joinpath("data/standard_base_frames.csv")
    lines = table.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))
