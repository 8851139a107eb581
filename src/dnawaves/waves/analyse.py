"""All estimates that a scene's excitation calls for, with their intervals."""

from __future__ import annotations

from collections.abc import Sequence

from dnawaves.scene.excitations import Nothing, Periodic, StandingWave, Static
from dnawaves.waves.analyse_null import null_rows
from dnawaves.waves.analyse_periodic import periodic_rows
from dnawaves.waves.analyse_standing import standing_rows
from dnawaves.waves.analyse_static import static_rows
from dnawaves.waves.cross_checks import cross_check_rows
from dnawaves.waves.estimators.window import FEWEST_FRAMES
from dnawaves.waves.record import Record
from dnawaves.waves.rows import too_short
from dnawaves.waves.table import Estimate
from dnawaves.waves.thermal import thermal_estimates
from dnawaves.waves.waveforms import waveform_rows


def analyse(records: Sequence[Record]) -> list[Estimate]:
    """Return the estimates of one scene from its recorded members, the headline first."""
    excitation = records[0].scene.excitation
    if records[0].scene.system.thermal:
        return thermal_estimates(records)
    if isinstance(excitation, Nothing):
        return null_rows(records[0])
    if isinstance(excitation, Static):
        return static_rows(records, excitation)
    if records[0].usable < FEWEST_FRAMES:
        return [too_short(records[0], excitation.wave)]
    records = [record for record in records if record.usable >= FEWEST_FRAMES]
    if isinstance(excitation, StandingWave):
        return standing_rows(records, excitation)
    if isinstance(excitation, Periodic):
        return periodic_rows(records, excitation)
    return [
        *waveform_rows(records, excitation.wave),
        *cross_check_rows(records, excitation),
    ]
