"""Estimates of a standing wave that an impulse has started."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from dnawaves.scene.excitations import StandingWave
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.oscillation import Oscillation, fit_oscillation
from dnawaves.waves.estimators.window import windows
from dnawaves.waves.projections import standing_projection
from dnawaves.waves.record import Record
from dnawaves.waves.rows import Fitted, fitted_row, half_kick_change
from dnawaves.waves.standing_speed import standing_wave_of
from dnawaves.waves.table import Estimate


def standing_rows(records: Sequence[Record], excitation: StandingWave) -> list[Estimate]:
    """Return the row of the oscillation of the motion's share in the kicked shape."""
    wave, record = excitation.wave, records[0]
    standing = standing_wave_of(record, wave, excitation.mode)

    def fit(one: Record, frames: int, interval: bool = False) -> Oscillation:
        projection = standing_projection(one, wave)
        return fit_oscillation(one.times_ps[:frames], projection[:frames], interval)

    first = fit(record, record.usable, interval=True)
    kicks = [fit(other, other.usable) for other in records[1:]]
    shorter = [fit(record, frames) for frames in windows(record.usable)[1:]]
    by_kick, others = (
        [standing.speed_A_per_ps(one.frequency_rad_per_ps.value) for one in fits]
        for fits in ([first, *kicks], [*kicks, *shorter])
    )
    frequency = first.frequency_rad_per_ps
    speed = Value(
        *(standing.speed_A_per_ps(x) for x in (frequency.value, frequency.low, frequency.high))
    )
    row = fitted_row(
        records,
        wave,
        "standing wave",
        Fitted(speed, first.width_per_ps, first.misfit, first.amplitude),
        others,
        "windows, kicks",
        standing.paper_A_per_ps,
    )
    return [
        replace(
            row,
            frequency_GHz=frequency.value * GHZ_PER_RAD_PER_PS,
            paper_frequency_GHz=standing.paper_frequency_rad_per_ps * GHZ_PER_RAD_PER_PS,
            wavenumber_rad_per_A=standing.wavenumber_rad_per_nm / A_PER_NM,
            half_kick_change=half_kick_change(records, by_kick),
        )
    ]
