"""Full-waveform fits of one scene's records with every lattice that its wave calls for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from dnawaves.waves.estimators.lattice_fit import LatticeFit, Observation, fit_lattice
from dnawaves.waves.estimators.lattices import FRICTION
from dnawaves.waves.estimators.long_waves import Projection, long_wave_count, lowest_waves
from dnawaves.waves.estimators.next_nearest import SHARE, NextNearestLattice
from dnawaves.waves.estimators.window import windows
from dnawaves.waves.observations import (
    AXIAL,
    PLANE,
    coupled,
    plane,
    single,
)
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.rows import Fitted, fitted_row, half_kick_change
from dnawaves.waves.scene_source import mean_mass
from dnawaves.waves.table import Estimate

Array = NDArray[np.float64]
Observe = Callable[[Record, int], Observation]

COUPLING = "coupling_extension_twist"


@dataclass(frozen=True)
class Study:
    """One model's fit of a scene, and the same of other kicks, windows and parts of the motion."""

    first: LatticeFit
    kicks: list[LatticeFit]
    others: list[LatticeFit]

    def row(
        self, records: Sequence[Record], wave: str, estimator: str, name: str, varied: str
    ) -> Estimate:
        """Return the row of the speed of this name."""
        fit = self.first
        fitted = Fitted(
            fit[name], fit[FRICTION].value, fit.model_class.misfit, abs(fit.amplitudes[0])
        )
        by_kick = [one[name].value for one in (fit, *self.kicks)]
        others = [one[name].value for one in (*self.kicks, *self.others)]
        row = fitted_row(records, wave, estimator, fitted, others, varied)
        return replace(row, half_kick_change=half_kick_change(records, by_kick))


def study(
    records: Sequence[Record],
    observe: Observe,
    projections: Sequence[Projection],
    names: Sequence[str],
) -> Study:
    """Fit the first projection of the first record, and everything that is varied beside it.

    `names` are the values whose profile likelihood is wanted.
    """

    # A lattice keeps its answers to the search for starts.
    observed = cache(observe)

    def fit(
        record: Record, frames: int, seen: Projection, intervals: Sequence[str] = ()
    ) -> LatticeFit:
        return fit_lattice([replace(observed(record, frames), noise=seen)], intervals=intervals)

    record, usable = records[0], records[0].usable
    return Study(
        fit(record, usable, projections[0], names),
        [fit(other, other.usable, projections[0]) for other in records[1:]],
        [fit(record, frames, projections[0]) for frames in windows(usable)[1:]]
        + [fit(record, usable, projection) for projection in projections[1:]],
    )


def waveform_rows(records: Sequence[Record], wave: str) -> list[Estimate]:
    """Return the rows of all full-waveform fits of a kick or pulse, the headline first."""
    if wave in AXIAL_WAVES:
        return [*_single(records, wave), _coupled(records, wave)]
    return _plane(records, wave)


def _single(records: Sequence[Record], wave: str) -> list[Estimate]:
    """Return the rows of extension or twist alone: long waves, all of them, wider springs."""
    name, record = "speed_A_per_ps", records[0]
    observe = single(wave)
    rows = [
        study(records, observe, long_waves(record), [name]).row(
            records, wave, "waveform", name, "windows, kicks, one wave less and more"
        ),
        study(records, observe, [all_waves(record), *_odd_and_even(record)], [name]).row(
            records, wave, "waveform, all waves", name, "windows, kicks, odd and even pairs"
        ),
    ]
    wider = study(records, single(wave, NextNearestLattice), [all_waves(record)], [name])
    row = wider.row(records, wave, "waveform, next-nearest", name, "windows, kicks")
    share = f"second neighbours' share of the stiffness {wider.first[SHARE].value:.2f}"
    return [*rows, replace(row, reason=_joined(row.reason, share))]


def _coupled(records: Sequence[Record], wave: str) -> Estimate:
    name = f"{wave}_A_per_ps"
    projections = long_waves(records[0], AXIAL)
    found = study(records, coupled, projections, [name, COUPLING])
    row = found.row(
        records, wave, "waveform, coupled", name, "windows, kicks, one wave less and more"
    )
    both = found.first[COUPLING]
    (other,) = (axial for axial in AXIAL if axial != wave)
    note = (
        f"coupling {both.value:.2f} ({both.low:.2f} to {both.high:.2f}), "
        f"{other} {found.first[f'{other}_A_per_ps'].value:.3g} Å/ps"
    )
    return replace(row, coupling=both.value, reason=_joined(row.reason, note))


def _plane(records: Sequence[Record], wave: str) -> list[Estimate]:
    """Return rows of the excited wave, of the other one of its plane, and of all wavelengths."""
    record = records[0]
    waves = [wave, *(other for other in PLANE if other != wave)]
    names = [f"{one}_A_per_ps" for one in waves]
    found = study(records, plane, long_waves(record, PLANE), names)
    rows = [
        found.row(records, one, "waveform", name, "windows, kicks, one wave less and more")
        for one, name in zip(waves, names, strict=True)
    ]
    whole = study(records, plane, [all_waves(record, PLANE)], names[:1])
    return [*rows, whole.row(records, wave, "waveform, all waves", names[0], "windows, kicks")]


def long_waves(record: Record, waves: Sequence[str] = ()) -> list[Projection]:
    """Return the projection on the waves at least as long as the duplex, on one less, one more.

    Of several `waves` each coordinate counts by its energy.
    """
    count = long_wave_count(record.pairs, record.held)
    return [_lowest(record, number, waves) for number in (count, count - 1, count + 1)]


def all_waves(record: Record, waves: Sequence[str] = ()) -> Projection:
    """Return the projection on all standing waves, which leaves nothing out."""
    return _lowest(record, record.pairs - len(record.held), waves)


def _lowest(record: Record, count: int, waves: Sequence[str]) -> Projection:
    scales = [float(np.sqrt(mean_mass(record, wave))) for wave in waves] or [1.0]
    return lowest_waves(record.pairs, record.held, count, scales)


def _odd_and_even(record: Record) -> list[Projection]:
    moving = np.delete(np.arange(record.pairs), record.held)
    return [Projection(np.eye(len(moving))[moving % 2 == parity]) for parity in (0, 1)]


def _joined(*reasons: str) -> str:
    return "; ".join(reason for reason in reasons if reason)
