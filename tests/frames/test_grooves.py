"""Groove widths: straight backbones, the fibre model's cylinder, and 3DNA's own numbers."""

from __future__ import annotations

import csv
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest

from dnawaves.frames.grooves import groove_widths

# Printed by 3DNA v2.1 for its own examples, PDB entries 355D and 2D94 (Lu & Olson 2003, 2008):
# minor P-P, refined, major P-P, refined of each step; nan where it prints ---.
NONE = [np.nan] * 4
PRINTED_BY_3DNA = {
    "dickerson_355d": [
        *[NONE] * 2,
        [14.3, np.nan, 18.2, np.nan],
        [12.0, 11.9, 17.3, 17.3],
        [9.7, 9.6, 19.1, 19.0],
        [9.1, 9.1, 16.4, 16.0],
        [9.1, 9.1, 17.8, 17.7],
        [9.6, 9.6, 18.6, 18.6],
        [10.4, np.nan, 19.0, np.nan],
        *[NONE] * 2,
    ],
    "adna_2d94": [
        *[NONE] * 2,
        [16.3, np.nan, 18.3, np.nan],
        [16.6, 15.4, 18.5, 17.6],
        [16.3, np.nan, 18.3, np.nan],
        *[NONE] * 2,
    ],
}


@pytest.mark.parametrize("case", ["dickerson_355d", "adna_2d94"])
def test_as_3dna(shared: Path, case: str) -> None:
    folder = shared / "reference" / "helical" / case
    universe = MDAnalysis.Universe(folder / "structure.pdb")
    with open(folder / "pairs.csv", encoding="utf-8") as file:
        pairs = list(csv.DictReader(file))

    def phosphorus(strand: str, pair: dict[str, str]) -> np.ndarray:
        found = universe.select_atoms(
            f"chainID {pair[f'chain{strand}']} and resid {pair[f'resid{strand}']} and name P"
        )
        return found.positions[0].astype(np.float64) if len(found) else np.full(3, np.nan)

    strand_I = np.array([phosphorus("1", pair) for pair in pairs[1:]]).T
    strand_II = np.array([phosphorus("2", pair) for pair in pairs[:-1]]).T
    # 3DNA prints one decimal.
    np.testing.assert_allclose(
        np.array(groove_widths(strand_I, strand_II)).T, PRINTED_BY_3DNA[case], atol=0.051
    )


def test_between_straight_backbones_the_refined_width_is_their_distance() -> None:
    steps = np.arange(9)
    strand_I = np.array([0 * steps, 0 * steps, 7.0 * steps])
    strand_II = strand_I + np.array([[12.0], [5.0], [0.0]])
    found = groove_widths(strand_I, strand_II)
    inside = slice(3, -3)
    np.testing.assert_allclose(found.minor_refined[inside], 13, atol=1e-12)
    np.testing.assert_allclose(found.major_refined[inside], 13, atol=1e-12)
    # Three steps along for the minor, four for the major groove.
    np.testing.assert_allclose(found.minor[inside], np.hypot(13, 21), atol=1e-12)
    np.testing.assert_allclose(found.major[inside], np.hypot(13, 28), atol=1e-12)


def test_phosphates_on_the_cylinder_of_b_dna() -> None:
    # Arnott & Hukins (1972): P at r 9.225 Å, phi 92.21 degrees, z 1.848 Å, strand II by the dyad.
    radius, phi, z, rise, twist = 9.225, np.radians(92.21), 1.848, 3.375, np.radians(36)
    steps = np.arange(11)

    def on_cylinder(side: int, pair: np.ndarray) -> np.ndarray:
        angle = side * phi + pair * twist
        return np.array([radius * np.cos(angle), radius * np.sin(angle), side * z + pair * rise])

    found = groove_widths(on_cylinder(-1, steps + 1), on_cylinder(1, steps))
    # A chord of the cylinder and its height, for 4 pairs apart and for 3 the other way.
    minor = np.hypot(2 * radius * np.sin((4 * twist - 2 * phi) / 2), 4 * rise - 2 * z)
    major = np.hypot(2 * radius * np.sin((-3 * twist - 2 * phi) / 2), -3 * rise - 2 * z)
    np.testing.assert_allclose(found.minor[2:-2], minor, atol=1e-12)
    np.testing.assert_allclose(found.major[2:-2], major, atol=1e-12)
    assert np.isnan(found.minor[[0, 1, -2, -1]]).all()
    assert (found.minor_refined[3:-3] < minor).all() and (found.major_refined[3:-3] < major).all()
