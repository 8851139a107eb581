"""Cross-checks of the full-waveform fits of a kick or pulse: picks, a lag, modes without a source.

A pick or a lag is biased by the width of the source and by the ends, in the molecule and in the
paper's rod alike: the ratio to the paper's rod, excited and observed in the same way, is what to
read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from dnawaves.scene.excitations import PULSE_DELAY_WIDTHS, Kick, Pulse
from dnawaves.scene.pairs import excited_pairs
from dnawaves.waves.estimators.correlation import LEAST_PEAK, arrival_ps, lag_ps
from dnawaves.waves.estimators.long_waves import long_wave_count
from dnawaves.waves.estimators.modal_fit import ModalFit, fit_modes
from dnawaves.waves.estimators.window import FEWEST_FRAMES, windows
from dnawaves.waves.paper_answer import paper_velocity
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.rows import Fitted, blank, fitted_row
from dnawaves.waves.table import MODEL_SPREAD, Estimate, spread

Array = NDArray[np.float64]
# Travel times by base pair, the farthest first, from a velocity field (time, pair); a front's peak
# has at least that part of the largest.
Pick = Callable[[Record, Array, Array, float], dict[int, float]]

FARTHEST_PAIRS = 3
# Of the travel time: how much of a record two signals are correlated over.
BEFORE_REFLECTION = 1.5
# Nothing runs ahead of a front of extension or twist on a uniform chain; that of a kick beside a
# held end is 0.38 of what the ends turn, add up and send back later.
LEAST_PEAK_OF_CHAIN = 0.25
# A front reaches base pairs one after another.
OUT_OF_ORDER = "rejected: the front is at a farther base pair no later than at a nearer one"
# Between neighbouring pairs: picks that differ by as much as the paper's speeds are wrong where
# they are wrong (see `comparison.judge`) follow different features, and cannot judge them.
NEIGHBOURS_DIFFER = 1.4


def cross_check_rows(records: Sequence[Record], excitation: Kick | Pulse) -> list[Estimate]:
    """Return the rows of arrival, correlation and, of extension and twist, of the modes."""
    rows = [
        _timed(records, excitation, "arrival", _arrivals, _source_centre),
        _timed(records, excitation, "correlation", _lags, _first_observed),
    ]
    if excitation.wave in AXIAL_WAVES:
        rows.append(_modes(records, excitation))
    return rows


def _timed(
    records: Sequence[Record],
    excitation: Kick | Pulse,
    estimator: str,
    pick: Pick,
    origin: Callable[[Record], float],
) -> Estimate:
    """Return the speed to the farthest pair that both the molecule and the paper's rod show."""
    wave, first = excitation.wave, records[0]
    measured = [
        pick(
            record,
            record.times_ps[: record.usable],
            record.velocity(wave)[: record.usable],
            LEAST_PEAK,
        )
        for record in records
    ]
    row = blank(first, wave, estimator)
    if not measured[0]:
        return replace(row, reason="no front has passed the observed pairs in this record")
    heights = first.motion["height"].values
    distances = heights - origin(first)
    # As many crossings as the simulation's record shows: the pick depends on the record's length.
    pair, time_ps = next(iter(measured[0].items()))
    stretch = distances[pair] / time_ps / first.paper_speeds_A_per_ps[wave]
    frames = int(np.ceil(max(stretch, 1.0) * first.usable))
    times = np.arange(frames) * first.times_ps[1]
    least = LEAST_PEAK_OF_CHAIN if wave in AXIAL_WAVES else LEAST_PEAK
    paper = pick(first, times, paper_velocity(first, wave, times), least)
    common = [pair for pair in measured[0] if pair in paper]
    if not common:
        return replace(row, reason="the paper's rod shows no front to compare with")
    pair = common[0]
    speeds = [distances[pair] / measured[0][pair]]
    speeds += [
        distances[other] / time
        for number, times_of in enumerate(measured)
        for other, time in times_of.items()
        if (number, other) != (0, pair)
    ]
    found = spread(row, speeds, distances[pair] / paper[pair])
    doubts = (_doubt(estimator, picks, paper) for picks in measured)
    return replace(
        found,
        interval=f"{MODEL_SPREAD} over the farthest pairs, kicks" if len(speeds) > 1 else "",
        model_class=next(filter(None, doubts), ""),
        arrival_ps=measured[0][pair],
        paper_arrival_ps=paper[pair],
    )


def _doubt(estimator: str, times_ps: dict[int, float], paper_ps: dict[int, float]) -> str:
    """Return why the picks at neighbouring pairs, the farthest first, are not one wave's.

    Held against those of the paper's rod, which an end disturbs as well: one wave has one ratio.
    """
    if estimator == "arrival" and any(far <= near for far, near in pairwise(times_ps.values())):
        return OUT_OF_ORDER
    ratios = [paper_ps[pair] / time for pair, time in times_ps.items() if pair in paper_ps]
    factor = max(ratios, default=1.0) / min(ratios, default=1.0)
    if factor > NEIGHBOURS_DIFFER:
        return f"rejected: speeds to neighbouring base pairs differ by a factor of {factor:.1f}"
    return ""


def _arrivals(record: Record, times_ps: Array, velocity: Array, least: float) -> dict[int, float]:
    """Return when the front has risen to its 66.3 % at the farthest pairs, after the source."""
    found = {}
    for pair in _farthest(record):
        time = arrival_ps(times_ps, velocity[:, pair], least)
        if time is not None and time > source_ps(record):
            found[pair] = time - source_ps(record)
    return found


def _lags(record: Record, times_ps: Array, velocity: Array, least: float) -> dict[int, float]:
    """Return by how much the farthest pairs lag behind the first one beside the source.

    By the record up to half as long again as the front has needed: later the reflections overlap.
    """
    early, interval = _beside_source(record), float(times_ps[1] - times_ps[0])
    lags = {}
    for pair, arrival in _arrivals(record, times_ps, velocity, least).items():
        part = velocity[: int((BEFORE_REFLECTION * arrival + source_ps(record)) / interval)]
        if len(part) >= FEWEST_FRAMES:
            lags[pair] = lag_ps(interval, part[:, early], part[:, pair])
    return {pair: lag for pair, lag in lags.items() if lag > 0}


def source_ps(record: Record) -> float:
    """Return when the source acts: a kick at once, a pulse at its centre."""
    if isinstance(record.scene.excitation, Pulse):
        return PULSE_DELAY_WIDTHS * float(record.motion.attrs["pulse_width_ps"])
    return 0.0


def _farthest(record: Record) -> list[int]:
    """Return the observed pairs, the farthest first.

    The pair next to a held end is left out: there the reflection meets the front.
    """
    last = _excited(record)[-1]
    beside = [pair - 1 for pair in record.held if pair > last]
    free = [
        pair
        for pair in range(last + 2, record.pairs)
        if pair not in record.held and pair not in beside
    ]
    return free[: -FARTHEST_PAIRS - 1 : -1]


def _excited(record: Record) -> list[int]:
    excitation = record.scene.excitation
    assert isinstance(excitation, Kick | Pulse)
    return excited_pairs(excitation, record.scene.ends)


def _beside_source(record: Record) -> int:
    return _excited(record)[-1] + 1


def _source_centre(record: Record) -> float:
    return float(record.motion["height"].values[_excited(record)].mean())


def _first_observed(record: Record) -> float:
    return float(record.motion["height"].values[_beside_source(record)])


def _modes(records: Sequence[Record], excitation: Kick | Pulse) -> Estimate:
    """Return the speed of the longest standing waves, each of its own amplitude and phase."""
    wave = excitation.wave

    def fit(record: Record, frames: int) -> ModalFit:
        begin = int(np.searchsorted(record.times_ps, 2 * source_ps(record)))
        part = slice(begin, frames)
        # A free chain's uniform motion is no vibration.
        count = long_wave_count(record.pairs, record.held) - (not record.held)
        return fit_modes(
            record.times_ps[part],
            record.velocity(wave)[part],
            record.spacing_nm,
            record.held,
            range(1, count + 1),
        )

    first = records[0]
    over = int(np.searchsorted(first.times_ps, 2 * source_ps(first)))
    if first.usable - over < FEWEST_FRAMES:
        return blank(first, wave, "modes", "the record ends before the source is over")
    found = fit(first, first.usable)
    others = [fit(record, record.usable) for record in records[1:]]
    others += [fit(first, over + frames) for frames in windows(first.usable - over)[1:]]
    fitted = Fitted(found.speed_A_per_ps, found.friction_per_ps, found.model_class.misfit)
    speeds = [one.speed_A_per_ps.value for one in others]
    return fitted_row(records, wave, "modes", fitted, speeds, "windows, kicks")
