"""Estimates of a periodic drive: the resonance curve of each standing wave that is driven."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dnawaves.scene.excitations import Periodic
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.resonance import Resonance, fit_resonance
from dnawaves.waves.estimators.window import FEWEST_FRAMES
from dnawaves.waves.projections import mode_projection, mode_source
from dnawaves.waves.record import Record
from dnawaves.waves.rows import Fitted, fitted_row
from dnawaves.waves.standing_speed import standing_wave_of
from dnawaves.waves.table import Estimate

PARTS = (0.75, 0.5)


def periodic_rows(records: Sequence[Record], excitation: Periodic) -> list[Estimate]:
    """Return one row for each standing wave that is driven, the lowest if nothing else is said.

    Frequency, width, amplitude and phase of one oscillator, common to all runs that drive the mode,
    transient included: so the frequency is known better than the inverse length of a record.
    """
    modes = [driven_mode(record) for record in records]
    return [
        _row(
            [record for record, one in zip(records, modes, strict=True) if one == mode],
            excitation.wave,
            mode,
        )
        for mode in dict.fromkeys(modes)
    ]


def driven_mode(record: Record) -> int:
    """Return the number of the standing wave that a run drives."""
    return int(record.motion.attrs.get("drive_mode", 1))


def _row(records: Sequence[Record], wave: str, mode: int) -> Estimate:
    standing = standing_wave_of(records[0], wave, mode)
    motions = [mode_projection(record, wave, mode) for record in records]

    def fit(chosen: Sequence[int], part: float = 1.0, intervals: bool = False) -> Resonance:
        frames = [max(int(part * records[index].usable), FEWEST_FRAMES) for index in chosen]
        attrs = [records[index].motion.attrs for index in chosen]
        return fit_resonance(
            [records[i].times_ps[:n] for i, n in zip(chosen, frames, strict=True)],
            [motions[i][:n] for i, n in zip(chosen, frames, strict=True)],
            [2e-3 * np.pi * float(one["frequency_GHz"]) for one in attrs],
            [float(one.get("ramp_ps", 0.0)) for one in attrs],
            intervals=intervals,
        )

    everything = range(len(records))
    first = fit(everything, intervals=True)
    others = [fit(everything, part) for part in PARTS]
    others += [fit([index]) for index in everything] if len(records) > 1 else []
    frequency = first.frequency_rad_per_ps
    speed = Value(
        *(standing.speed_A_per_ps(x) for x in (frequency.value, frequency.low, frequency.high))
    )
    # The source has that share in the mode: the amplitude that a rod would answer with.
    expected = mode_source(records[0], wave, mode)
    row = fitted_row(
        records,
        wave,
        "resonance",
        Fitted(
            speed,
            first.width_per_ps.value,
            first.model_class.misfit,
            first.amplitude / abs(expected) if expected else None,
        ),
        [standing.speed_A_per_ps(one.frequency_rad_per_ps.value) for one in others],
        "windows, each drive alone" if len(records) > 1 else "windows",
        standing.paper_A_per_ps,
    )
    width = first.width_per_ps
    return replace(
        row,
        frequency_GHz=frequency.value * GHZ_PER_RAD_PER_PS,
        paper_frequency_GHz=standing.paper_frequency_rad_per_ps * GHZ_PER_RAD_PER_PS,
        wavenumber_rad_per_A=standing.wavenumber_rad_per_nm / A_PER_NM,
        phase_rad=first.phase_rad,
        reason=f"mode {mode}, width {width.value:.2g} ({width.low:.2g} to {width.high:.2g}) /ps"
        + (f"; {row.reason}" if row.reason else ""),
    )
