"""The rod's constants in the same molecule: how stiff its segments are, by their length.

The distance and the turn between two base pairs of the free duplex fluctuate by kBT times the
compliance of what lies between. Of a uniform rod, compliance per length does not depend on the
length. In a molecule it does where steps do not move independently of each other; then a wave of
half a wavelength L meets the stiffness of segments of about that length.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from dnawaves.files import read_netcdf, whole_file
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.table import CSV_FORMAT

Array = NDArray[np.float64]

# Base pairs that fray, left out at either end of a duplex that has enough others.
TERMINAL_PAIRS = 2
# Of longer segments there are so few that their mean says little.
FEWEST_SEGMENTS = 4


def segments_step(modes: Path, output: Path) -> None:
    """Write the stiffness and the speeds of a duplex's segments as CSV, one row per length."""
    dataset = read_netcdf(modes, "axis_compliance", "mass", "axial_inertia", "height")
    table = segment_table(dataset)
    with whole_file(output) as temporary:
        table.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def inner_pairs(pairs: int) -> range:
    """Return the base pairs that do not fray, by their indices."""
    margin = TERMINAL_PAIRS if pairs > 2 * TERMINAL_PAIRS + FEWEST_SEGMENTS else 0
    return range(margin, pairs - margin)


def segment_lengths(pairs: int) -> range:
    """Return the lengths in steps that have segments enough to average over."""
    inside = len(inner_pairs(pairs))
    fewest = FEWEST_SEGMENTS if inside < pairs else 1
    return range(1, inside - fewest + 1)


def segment_table(modes: xr.Dataset) -> pd.DataFrame:
    """Return stiffness and speeds of all segments of 1, 2, ... steps, averaged over the duplex.

    `modes` are those of the free duplex. Compliances per length are averaged, as of springs in a
    row. The stiffness of extension and twist is that of either with the other free to follow; the
    coupling is the off-diagonal element of the stiffness. Speeds are those of long waves of a
    rod with this stiffness and the duplex's own density and inertia, the two waves mixed as the
    coupling says. Of bend the mean compliance about the two axes across counts.
    """
    height = modes["height"].values
    inside = inner_pairs(len(height))
    spacing_A = (height[-1] - height[0]) / (len(height) - 1)
    mass = modes["mass"].values.mean() / spacing_A
    inertia = modes["axial_inertia"].values.mean() / spacing_A
    rows = []
    for steps in segment_lengths(len(height)):
        segments = [(pair, pair + steps) for pair in inside if pair + steps in inside]
        compliance = np.mean([_per_length(modes, *pairs) for pairs in segments], axis=0)
        axial, bend = compliance[:2, :2], np.diag(compliance)[2:].mean()
        stiffness = np.linalg.inv(axial)
        rows.append(
            {
                "steps": steps,
                "length_A": np.mean([height[j] - height[i] for i, j in segments]),
                "segments": len(segments),
                # kJ/mol/Å is Da Å/ps² times 100, pN and nm from it.
                "extension_pN": A_PER_NM / axial[0, 0] / KJ_PER_MOL_PER_PN_NM,
                "twist_pN_nm2": 1 / axial[1, 1] / A_PER_NM / KJ_PER_MOL_PER_PN_NM,
                "coupling_pN_nm": stiffness[0, 1] / KJ_PER_MOL_PER_PN_NM,
                "bend_pN_nm2": 1 / bend / A_PER_NM / KJ_PER_MOL_PER_PN_NM,
                **_speeds(stiffness, mass, inertia),
            }
        )
    return pd.DataFrame(rows)


def _per_length(modes: xr.Dataset, first: int, last: int) -> Array:
    """Return the compliance per length of extension, twist and both bends, (4, 4), per Å."""
    covariance = modes["axis_compliance"].sel(coordinate=_ORDER, other_coordinate=_ORDER).values
    between = (
        covariance[last, :, last]
        + covariance[first, :, first]
        - covariance[first, :, last]
        - covariance[last, :, first]
    )
    length = float(modes["height"][last] - modes["height"][first])
    return np.asarray(between / length)


_ORDER = ["extension", "twist", "bend", "bend_across"]


def _speeds(stiffness: Array, mass: float, inertia: float) -> dict[str, float]:
    """Return the two long-wave speeds in Å/ps; the wave is named by most of its kinetic energy."""
    # kJ/mol is 100 Da Å²/ps².
    root = np.sqrt(np.array([mass, inertia]))
    squared, vectors = np.linalg.eigh(A_PER_NM**2 * stiffness / np.outer(root, root))
    extension = int(np.argmax(np.abs(vectors[0])))
    return {
        "extension_A_per_ps": float(np.sqrt(squared[extension])),
        "twist_A_per_ps": float(np.sqrt(squared[1 - extension])),
    }
