"""The rule L = n lambda/2 beside the exact standing waves of a rod: where it holds, where not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from dnawaves.rod.dispersion import bend_shear_branches, transverse_constants
from dnawaves.rod.finite_rod import COORDINATE_SETS, End, FiniteRod
from dnawaves.rod.rod import FloatArray, Rod

Wave = Literal["extension", "twist", "bend"]
PAIRINGS: tuple[tuple[End, End], ...] = (
    ("held", "held"),
    ("free", "free"),
    ("held", "free"),
    ("pinned", "pinned"),
    ("held", "pinned"),
    ("free", "pinned"),
)


@dataclass(frozen=True)
class HalfWaves:
    """One standing wave: its frequency, and that of a wave with `mode` half-waves on the rod.

    `half_waves` is how many half-waves of the frequency's own wavelength the rod is long. It is
    `mode` where the rule holds. Of extension and twist it is mode - 1/2 if one end is fixed and
    the other free; of a slender rod's bend it tends to mode + 1/2 (held-held, free-free),
    mode - 1/2 (held-free) and mode + 1/4 (one end pinned, the other not).
    """

    wave: Wave
    ends: tuple[End, End]
    mode: int
    frequency_rad_per_ps: float
    rule_rad_per_ps: float
    half_waves: float

    @property
    def ratio(self) -> float:
        """Exact frequency over that of the rule."""
        return self.frequency_rad_per_ps / self.rule_rad_per_ps


def half_wave_table(
    rod: Rod, length_nm: float, wave: Wave, ends: tuple[End, End], count: int
) -> list[HalfWaves]:
    """Return the lowest `count` standing waves of a straight, uncoupled, continuous rod.

    Of bend only those below the cut-off of the upper branch: above it both branches mix.
    """
    exact = FiniteRod(rod, length_nm, ends, COORDINATE_SETS[wave]).frequencies_rad_per_ps(count)
    modes = np.arange(1, count + 1)
    wavenumbers = modes * np.pi / length_nm
    if wave == "bend":
        exact = exact[exact < bend_shear_branches(rod, 0.0, lattice=False)[1]]
        rule = bend_shear_branches(rod, wavenumbers, lattice=False)[:, 0]
        half_waves = bend_wavenumber(rod, exact) * length_nm / np.pi
    else:
        (axis,) = COORDINATE_SETS[wave]
        speed = np.sqrt(rod.stiffness[axis, axis] / rod.mass[axis, axis])
        rule = speed * wavenumbers
        half_waves = exact / speed * length_nm / np.pi
    return [
        HalfWaves(wave, ends, int(n), float(w), float(expected), float(halves))
        for n, w, expected, halves in zip(modes, exact, rule, half_waves, strict=False)
    ]


def bend_wavenumber(rod: Rod, frequencies_rad_per_ps: FloatArray) -> FloatArray:
    """Return the wavenumber, rad/nm, of the lower bend/shear branch of the continuous rod."""
    density, inertia, shear, bend, stretch = transverse_constants(rod)
    w2 = np.square(frequencies_rad_per_ps)
    linear = w2 * (density * bend + inertia * shear)
    constant = shear * bend * density * w2 * (inertia * w2 - shear * stretch**2)
    return np.sqrt((linear + np.sqrt(linear**2 - 4 * constant)) / (2 * shear * bend))
