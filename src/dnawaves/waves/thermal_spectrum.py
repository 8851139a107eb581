"""Estimates from thermal motion alone: spectra of the standing waves that a duplex always has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.motion.pair_frames import following_velocities
from dnawaves.rod.chain import ScalarChain
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.long_waves import wavenumbers_rad_per_nm
from dnawaves.waves.estimators.mode_spectra import ModeSpectrum, SharedSpeed, shared_speed
from dnawaves.waves.projections import amplitude, mode_shape
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.rows import blank
from dnawaves.waves.scene_source import unit_A
from dnawaves.waves.standing_speed import standing_wave_of
from dnawaves.waves.table import Estimate

Array = NDArray[np.float64]

MODES = 4
# Above 1 THz base pairs move in themselves; waves shorter than the lowest four modes of a
# duplex of 24 base pairs lie there too.
HIGHEST_RAD_PER_PS = 2 * np.pi
INTERVAL = "95 %, profile likelihood (Whittle)"
WAVES = ("extension", "twist", "bend", "shear")
# The fields of bend and shear in either plane along the axis, which count as two runs. About the
# first direction a right-handed turn tilts the axis against the second.
PLANES = (
    {"shear": ("shear", 1), "bend": ("bend", 1)},
    {"shear": ("shear_across", 1), "bend": ("bend_across", -1)},
)


def spectrum_rows(records: Sequence[Record]) -> list[Estimate]:
    """Return rows of all four waves: of extension and twist their speed, and of each mode's line.

    Modes are those of the scene's ends, of bend and shear with the shapes of the paper's rod, which
    has no other part in it; replicas count as independent runs.
    """
    motions = [following_velocities(record.motion) for record in records]
    return [row for wave in WAVES for row in _rows(records[0], wave, motions)]


def _rows(record: Record, wave: str, motions: Sequence[Mapping[str, Array]]) -> list[Estimate]:
    try:
        wavenumbers, runs = (_axial if wave in AXIAL_WAVES else _plane)(record, wave, motions)
        found = shared_speed(
            runs,
            float(record.times_ps[1] - record.times_ps[0]),
            wavenumbers,
            record.spacing_nm,
            HIGHEST_RAD_PER_PS,
        )
    except InputError as error:
        return [blank(record, wave, "thermal spectrum", str(error))]
    rows = [_mode_row(record, wave, number, mode) for number, mode in enumerate(found.modes, 1)]
    return [_speed_row(record, wave, found, len(runs)), *rows] if wave in AXIAL_WAVES else rows


def _axial(
    record: Record, wave: str, motions: Sequence[Mapping[str, Array]]
) -> tuple[Array, list[Array]]:
    """Return wavenumbers (mode,), rad/nm, and velocities (time, mode) of each run."""
    shapes, wavenumbers = lowest_modes(record.pairs, record.held, record.spacing_nm)
    return wavenumbers, [motion[wave] @ shapes.T for motion in motions]


def _plane(
    record: Record, wave: str, motions: Sequence[Mapping[str, Array]]
) -> tuple[Array, list[Array]]:
    """Return the same of bend or shear, whose modes between two ends are no sines."""
    modes = range(1, MODES + 1)
    shapes = [mode_shape(record, wave, mode) for mode in modes]
    wavenumbers = [standing_wave_of(record, wave, mode).wavenumber_rad_per_nm for mode in modes]
    runs = []
    for motion in motions:
        for plane in PLANES:
            fields = {one: sign * motion[name] / unit_A(one) for one, (name, sign) in plane.items()}
            runs.append(np.stack([amplitude(record, one, fields) for one in shapes], axis=1))
    return np.array(wavenumbers), runs


def lowest_modes(pairs: int, held: Sequence[int], spacing_nm: float) -> tuple[Array, Array]:
    """Return shapes (mode, pair) and wavenumbers (rad/nm) of the lowest standing waves.

    Sines between held ends, cosines between free ones (DCT-II), whatever the ends; a motion of
    the whole is left out.
    """
    chain = ScalarChain.from_speed(pairs, 1.0, spacing_nm, held)
    moving = np.flatnonzero(chain.frequencies_rad_per_ps > 0)[:MODES]
    return chain.shapes[moving], wavenumbers_rad_per_nm(chain, spacing_nm)[moving]


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
    standing = standing_wave_of(record, wave, number)
    frequency = mode.frequency_rad_per_ps
    speed = Value(
        *(standing.speed_A_per_ps(x) for x in (frequency.value, frequency.low, frequency.high))
    )
    return replace(
        _with_speed(blank(record, wave, f"thermal mode {number}"), speed, standing.paper_A_per_ps),
        misfit=mode.misfit,
        model_class="fits" if mode.fits else "rejected: no single line upon a low flat background",
        friction_per_ps=mode.friction_per_ps,
        frequency_GHz=frequency.value * GHZ_PER_RAD_PER_PS,
        paper_frequency_GHz=standing.paper_frequency_rad_per_ps * GHZ_PER_RAD_PER_PS,
        wavenumber_rad_per_A=standing.wavenumber_rad_per_nm / A_PER_NM,
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
