"""Flags of single values, one bit each, as the CF conventions have them."""

from __future__ import annotations

from functools import cache

import numpy as np

# Of the first three the values are NaN (with NO_HELICAL_AXIS only those about that axis).
NO_FRAME, OPPOSED, NO_HELICAL_AXIS = 1, 2, 4
OPEN, ATOMS_MISSING, NOT_CONSECUTIVE, Z_FORM, PARALLEL = 8, 16, 32, 64, 128

FLAGS = {
    NO_FRAME: "no_frame",
    OPPOSED: "bend_of_180_degrees",
    NO_HELICAL_AXIS: "no_helical_axis",
    OPEN: "open",
    ATOMS_MISSING: "ring_atoms_missing",
    NOT_CONSECUTIVE: "not_consecutive",
    Z_FORM: "z_form",
    PARALLEL: "parallel",
}

FLAG_ATTRIBUTES = {
    "flag_masks": np.array(list(FLAGS), dtype=np.uint8),
    "flag_meanings": " ".join(FLAGS.values()),
}


@cache
def flag_words(flags: int) -> str:
    """Return the meanings of the bits that are set, joined by "|"."""
    return "|".join(word for bit, word in FLAGS.items() if flags & bit)
