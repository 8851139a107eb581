"""Estimates from thermal motion alone: spectra of the standing waves that a duplex always has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.motion.pair_frames import following_velocities
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.dispersion import bend_shear_branches, lattice_frequency
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.mode_spectra import ModeSpectrum, SharedSpeed, shared_speed
from dnawaves.waves.paper_answer import paper_rod
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.rows import blank
from dnawaves.waves.table import Estimate

Array = NDArray[np.float64]

MODES = 4
# Above 1 THz base pairs move in themselves; waves shorter than the lowest four modes of a
# duplex of 24 base pairs lie there too.
HIGHEST_RAD_PER_PS = 2 * np.pi
INTERVAL = "95 %, profile likelihood (Whittle)"
# The velocity that shows each wave's own branch of long waves best: across, the slow branch moves
# the pairs sideways, the fast one turns them. Both directions across count, as two runs.
SEEN_IN = {
    "extension": ("extension",),
    "twist": ("twist",),
    "bend": ("shear", "shear_across"),
    "shear": ("bend", "bend_across"),
}


def spectrum_rows(records: Sequence[Record]) -> list[Estimate]:
    """Return rows of all four waves: of extension and twist their speed, and of each mode's line.

    Modes are those of the lattice with the scene's ends; replicas count as independent runs.
    """
    motions = [following_velocities(record.motion) for record in records]
    return [
        row
        for wave in SEEN_IN
        for row in _rows(records[0], wave, [one[name] for one in motions for name in SEEN_IN[wave]])
    ]


def _rows(record: Record, wave: str, fields: Sequence[Array]) -> list[Estimate]:
    shapes, wavenumbers = lowest_modes(record.pairs, record.held, record.spacing_nm)
    try:
        found = shared_speed(
            [field @ shapes.T for field in fields],
            float(record.times_ps[1] - record.times_ps[0]),
            wavenumbers,
            record.spacing_nm,
            HIGHEST_RAD_PER_PS,
        )
    except InputError as error:
        return [blank(record, wave, "thermal spectrum", str(error))]
    rows = [_mode_row(record, wave, number, mode) for number, mode in enumerate(found.modes, 1)]
    return [_speed_row(record, wave, found, len(fields)), *rows] if wave in AXIAL_WAVES else rows


def lowest_modes(pairs: int, held: Sequence[int], spacing_nm: float) -> tuple[Array, Array]:
    """Return shapes (mode, pair) and wavenumbers (rad/nm) of the lowest standing waves.

    Sines between held ends, cosines between free ones (DCT-II), whatever the ends; a motion of
    the whole is left out.
    """
    chain = ScalarChain.from_speed(pairs, 1.0, spacing_nm, held)
    moving = np.flatnonzero(chain.frequencies_rad_per_ps > 0)[:MODES]
    sines = chain.frequencies_rad_per_ps[moving] / lattice_frequency(
        np.pi / spacing_nm, 1.0, spacing_nm
    )
    return chain.shapes[moving], 2 / spacing_nm * np.arcsin(np.minimum(sines, 1.0))


def _speed_row(record: Record, wave: str, found: SharedSpeed, runs: int) -> Estimate:
    paper = record.paper_speeds_A_per_ps[wave]
    speed = found.speed_A_per_ps
    verdict = "rejected: not all modes are lines of one speed upon a low flat background"
    return replace(
        _with_speed(blank(record, wave, "thermal spectrum"), speed, paper),
        variations=runs,
        misfit=found.misfit,
        model_class=verdict if found.wrong else "fits",
        friction_per_ps=found.friction_per_ps,
        window_ps=float(record.times_ps[-1]),
        reason=f"{len(found.modes)} modes, {found.wave_share:.0%} of the power below 1 THz in "
        f"their lines; p = {found.p_dispersion:.2g} of one speed for all",
    )


def _mode_row(record: Record, wave: str, number: int, mode: ModeSpectrum) -> Estimate:
    """Return the row of one mode: its frequency, and the speed that it stands for."""
    wavenumber = mode.wavenumber_rad_per_nm
    paper_speed = record.paper_speeds_A_per_ps[wave]
    if wave in AXIAL_WAVES:
        unit = float(lattice_frequency(wavenumber, 1.0, record.spacing_nm))
        paper_frequency = unit * paper_speed
    else:
        unit = wavenumber / A_PER_NM
        branches = bend_shear_branches(paper_rod(record.spacing_nm), [wavenumber], lattice=True)
        paper_frequency = float(branches[0, 0 if wave == "bend" else 1])
        paper_speed = paper_frequency / unit
    frequency = mode.frequency_rad_per_ps
    speed = Value(*(x / unit for x in (frequency.value, frequency.low, frequency.high)))
    return replace(
        _with_speed(blank(record, wave, f"thermal mode {number}"), speed, paper_speed),
        misfit=mode.misfit,
        model_class="fits" if mode.fits else "rejected: no single line upon a low flat background",
        friction_per_ps=mode.friction_per_ps,
        frequency_GHz=frequency.value * GHZ_PER_RAD_PER_PS,
        paper_frequency_GHz=paper_frequency * GHZ_PER_RAD_PER_PS,
        wavenumber_rad_per_A=wavenumber / A_PER_NM,
        window_ps=float(record.times_ps[-1]),
        reason=f"the line holds {mode.wave_share:.0%} of the power below 1 THz",
    )


def _with_speed(row: Estimate, speed: Value, paper: float) -> Estimate:
    """Return the row with the speed; a limit that the data do not set is blank."""
    return replace(
        row,
        speed_A_per_ps=speed.value,
        low_A_per_ps=speed.low if speed.low > 0 else None,
        high_A_per_ps=speed.high if np.isfinite(speed.high) else None,
        interval=INTERVAL,
        paper_A_per_ps=paper,
        ratio_to_paper=speed.value / paper,
    )
