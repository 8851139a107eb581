"""Rows of the table of estimates at T = 0: intervals and words that all kinds of scenes share.

Without temperature there is no sampling noise: a fit's residual is what its model lacks. So the
interval is the widest of two: the range of the estimate over everything that can be varied, and the
profile likelihood of the first fit, in which the residual stands for the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dnawaves.scene.excitations import Kick, StandingWave
from dnawaves.waves.estimators.intervals import Interval
from dnawaves.waves.estimators.lattice_fit import Value
from dnawaves.waves.estimators.window import FEWEST_FRAMES
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.table import MODEL_SPREAD, Estimate

# Roots of the shares of the motion, 1 % and 10 %, that a fitting model may leave over. There is no
# noise at T = 0 that would give a limit: these say what "fits" is to mean.
FITS, FITS_ROUGHLY = 0.1, 0.1**0.5
# Factor between the source that a fit needs and the one that was put in.
WRONG_SOURCE = 1.5


@dataclass(frozen=True)
class Fitted:
    """A speed (Å/ps) with the limits of its profile likelihood, and how well its model fits.

    `amplitude` is None where the source's strength is no part of the model.
    """

    speed_A_per_ps: Value
    friction_per_ps: float
    misfit: float
    amplitude: float | None = None


def model_class(misfit: float, amplitude: float | None = None) -> str:
    """Return whether a model describes a record without noise: "fits", or why it does not."""
    left = f"leaves {misfit**2:.0%} of the motion"
    if misfit > FITS_ROUGHLY:
        return f"rejected: {left}"
    if amplitude is not None and not 1 / WRONG_SOURCE < amplitude < WRONG_SOURCE:
        return f"rejected: needs a source {amplitude:.2g} times the one put in"
    return "fits" if misfit <= FITS else f"fits roughly: {left}"


def blank(record: Record, wave: str, estimator: str = "none", reason: str = "") -> Estimate:
    """Return a row without a speed."""
    return Estimate(
        record.scene.name,
        wave,
        estimator,
        record_ps=float(record.times_ps[-1]),
        # A bend or shear wave has no single speed that could stand here.
        paper_A_per_ps=record.paper_speeds_A_per_ps[wave] if wave in AXIAL_WAVES else None,
        reason=reason,
    )


def too_short(record: Record, wave: str) -> Estimate:
    """Return the row of a record that ends before anything can be fitted."""
    reason = (
        f"only {record.usable} usable frames of {len(record.times_ps)}, before the record ends or "
        "the difference of the two signs holds more energy than was put in; at least "
        f"{FEWEST_FRAMES} are needed"
    )
    window_ps = float(record.times_ps[max(record.usable - 1, 0)])
    return replace(blank(record, wave, reason=reason), window_ps=window_ps)


def fitted_row(
    records: Sequence[Record],
    wave: str,
    estimator: str,
    first: Fitted,
    others_A_per_ps: Sequence[float],
    varied: str,
    paper_A_per_ps: float | None = None,
) -> Estimate:
    """Return the row of a fit: its speed, with the widest interval that anything gives.

    `others` are the speeds of the variations, of `varied` things; without a `paper` speed the
    paper's short-wave speed of this wave stands beside it.
    """
    record, speed = records[0], first.speed_A_per_ps
    paper = record.paper_speeds_A_per_ps[wave] if paper_A_per_ps is None else paper_A_per_ps
    ends = envelope(speed, others_A_per_ps)
    cut = any(one.usable < len(one.times_ps) for one in records)
    return Estimate(
        record.scene.name,
        wave,
        estimator,
        speed_A_per_ps=speed.value,
        low_A_per_ps=ends.low,
        high_A_per_ps=ends.high,
        interval=f"{MODEL_SPREAD} over {varied}, or profile likelihood where wider",
        variations=1 + len(others_A_per_ps),
        paper_A_per_ps=paper,
        ratio_to_paper=speed.value / paper,
        misfit=first.misfit,
        model_class=model_class(first.misfit, first.amplitude),
        amplitude=first.amplitude,
        profile_low_A_per_ps=speed.low,
        profile_high_A_per_ps=speed.high,
        friction_per_ps=first.friction_per_ps,
        window_ps=float(record.times_ps[record.usable - 1]),
        record_ps=float(record.times_ps[-1]),
        reason="the fit ends where the difference holds more energy than was put in" if cut else "",
    )


def envelope(first: Value, others: Sequence[float]) -> Interval:
    """Return the widest interval: the profile's limits and everything that was found."""
    everything = [first.value, *others]
    return Interval(
        float(np.min([first.low, *everything])), float(np.max([first.high, *everything]))
    )


def half_kick_change(records: Sequence[Record], speeds_A_per_ps: Sequence[float]) -> float | None:
    """Return the relative change of the speed from the first member to one of half its size.

    `speeds` are those of the members, in their order and of the same window.
    """
    if not isinstance(records[0].scene.excitation, Kick | StandingWave):
        return None
    for record, speed in zip(records, speeds_A_per_ps, strict=True):
        if float(record.member[1:]) == 0.5 * float(records[0].member[1:]):
            return abs(speed / speeds_A_per_ps[0] - 1)
    return None
