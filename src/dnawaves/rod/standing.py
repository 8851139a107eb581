"""Standing waves of finite chains: shapes to excite and to project on, and their frequencies.

Modes are counted from 1. Both ends "held" hold the end base pairs themselves, "one_held" holds
the first, "free" holds none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from dnawaves.errors import InputError
from dnawaves.rod.chain import PlaneChain
from dnawaves.rod.dispersion import lattice_frequency
from dnawaves.rod.plane_branches import lower_branch_share
from dnawaves.rod.rod import FloatArray, Rod
from dnawaves.units import A_PER_NM

Ends = Literal["held", "one_held", "free"]
HELD_PAIRS: dict[Ends, tuple[int, ...]] = {"held": (0, -1), "one_held": (0,), "free": ()}


def axial_wavenumber(pairs: int, mode: int, ends: Ends, spacing_nm: float) -> float:
    """Return the wavenumber, rad/nm, of a standing wave of extension or twist on the chain.

    ka = n pi/(N - 1) (held), (2n - 1) pi/(2N - 1) (one_held), n pi/N (free).
    """
    highest = pairs - 1 - (ends == "held")
    if not 1 <= mode <= highest:
        raise InputError(f"mode {mode} of {pairs} base pairs ({ends}): allowed are 1 to {highest}")
    per_pair = {
        "held": mode / (pairs - 1),
        "one_held": (2 * mode - 1) / (2 * pairs - 1),
        "free": mode / pairs,
    }
    return np.pi * per_pair[ends] / spacing_nm


def axial_standing_wave(pairs: int, mode: int, ends: Ends) -> FloatArray:
    """Return the shape (pairs,) of a standing wave of extension or twist, amplitude 1."""
    phase = axial_wavenumber(pairs, mode, ends, spacing_nm=1.0) * np.arange(pairs)
    if ends == "free":
        return np.cos(phase + phase[1] / 2)
    shape = np.sin(phase)
    # sin(n pi) is not quite zero in floating point, and a held pair cannot be kicked
    shape[list(HELD_PAIRS[ends])] = 0.0
    return shape


def axial_frequency_rad_per_ps(
    pairs: int, mode: int, ends: Ends, speed_A_per_ps: float, spacing_nm: float
) -> float:
    """Return the frequency of a standing wave of extension or twist on the uniform chain."""
    wavenumber = axial_wavenumber(pairs, mode, ends, spacing_nm)
    return float(lattice_frequency(wavenumber, speed_A_per_ps, spacing_nm))


def fixed_fixed_frequency_GHz(mode: int, speed_A_per_ps: float, length_nm: float) -> float:
    """Return n V/2L, the rule L = n lambda/2 for a rod held (or free) at both ends.

    Exact for extension and twist of a continuous rod; wrong for clamped or free bend.
    """
    return 1e3 * mode * speed_A_per_ps / A_PER_NM / (2 * length_nm)


@dataclass(frozen=True, eq=False)
class PlaneMode:
    """A standing wave of bend or shear: frequency, u1 and th2 (pairs,), largest |u1| = 1.

    `share` in 0.5..1 is the part of its kinetic energy that belongs to its branch (see
    `plane_branches`): 1 is a pure wave, 0.5 an even mixture, unfit as an excitation.
    """

    frequency_rad_per_ps: float
    displacement: FloatArray
    rotation_rad_per_nm: FloatArray
    share: float


def bend_standing_wave(rod: Rod, pairs: int, mode: int, ends: Ends) -> PlaneMode:
    """Return the n-th standing wave of the lower bend/shear branch of a straight rod."""
    return _plane_mode(rod, pairs, mode, ends, lower=True)


def shear_standing_wave(rod: Rod, pairs: int, mode: int, ends: Ends) -> PlaneMode:
    """Return the n-th standing wave of the upper bend/shear branch of a straight rod.

    The lowest ones lie above the cut-off, among bends of the same frequency: look at `share`.
    """
    return _plane_mode(rod, pairs, mode, ends, lower=False)


def _plane_mode(rod: Rod, pairs: int, mode: int, ends: Ends, *, lower: bool) -> PlaneMode:
    frequencies, shapes = PlaneChain(rod, pairs, HELD_PAIRS[ends]).modes()
    vibrations = np.flatnonzero(frequencies > 0)
    shares = [lower_branch_share(rod, frequencies[i], shapes[i]) for i in vibrations]
    of_branch = [
        (index, share if lower else 1 - share)
        for index, share in zip(vibrations, shares, strict=True)
        if (share >= 0.5) == lower
    ]
    if not 1 <= mode <= len(of_branch):
        raise InputError(
            f"mode {mode} of {pairs} base pairs ({ends}): this branch has 1 to {len(of_branch)}"
        )
    index, share = of_branch[mode - 1]
    displacement, rotation = shapes[index].T
    largest = displacement[np.argmax(np.abs(displacement))]
    return PlaneMode(float(frequencies[index]), displacement / largest, rotation / largest, share)
