"""From the frequency of a standing wave to a speed, and what the paper's rod says of the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dnawaves.rod.dispersion import lattice_speed_from_frequency
from dnawaves.rod.standing import (
    axial_frequency_rad_per_ps,
    axial_wavenumber,
    bend_standing_wave,
    shear_standing_wave,
)
from dnawaves.units import A_PER_NM
from dnawaves.waves.paper_answer import paper_rod
from dnawaves.waves.record import AXIAL_WAVES, Record


@dataclass(frozen=True)
class StandingWaveOf:
    """A standing wave of a scene's duplex: its wavenumber, and the paper's speed and frequency.

    Of extension and twist the speed is that of long waves on the lattice; of bend and shear it is
    the phase speed, with n pi/L for the wavenumber, and the paper's is that of its Timoshenko beam.
    """

    axial: bool
    spacing_nm: float
    wavenumber_rad_per_nm: float
    paper_frequency_rad_per_ps: float
    paper_A_per_ps: float

    def speed_A_per_ps(self, frequency_rad_per_ps: float) -> float:
        """Return the speed of a wave of this frequency; an infinite frequency gives an infinite."""
        if not np.isfinite(frequency_rad_per_ps):
            return frequency_rad_per_ps
        wavenumber = self.wavenumber_rad_per_nm
        if self.axial:
            return float(
                lattice_speed_from_frequency(frequency_rad_per_ps, wavenumber, self.spacing_nm)
            )
        return frequency_rad_per_ps / wavenumber * A_PER_NM


def standing_wave_of(record: Record, wave: str, mode: int) -> StandingWaveOf:
    """Return a standing wave, counted from 1, between the ends of a scene."""
    first, last = record.span
    pairs, spacing_nm = last - first + 1, record.spacing_nm
    if wave in AXIAL_WAVES:
        wavenumber = axial_wavenumber(pairs, mode, record.ends, spacing_nm)
        speed = record.paper_speeds_A_per_ps[wave]
        frequency = axial_frequency_rad_per_ps(pairs, mode, record.ends, speed, spacing_nm)
        return StandingWaveOf(True, spacing_nm, wavenumber, frequency, speed)
    standing = bend_standing_wave if wave == "bend" else shear_standing_wave
    frequency = standing(paper_rod(spacing_nm), pairs, mode, record.ends).frequency_rad_per_ps
    wavenumber = mode * np.pi / (record.free_length_A / A_PER_NM)
    speed = frequency / wavenumber * A_PER_NM
    return StandingWaveOf(False, spacing_nm, wavenumber, frequency, speed)
