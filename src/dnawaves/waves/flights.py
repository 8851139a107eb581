"""Time of flight against length: one speed from the arrivals in duplexes of several lengths."""

from __future__ import annotations

import numpy as np
import pandas as pd

from dnawaves.errors import InputError
from dnawaves.waves.estimators.flight import fit_flight
from dnawaves.waves.table import Estimate

ESTIMATOR = "flight against length"
FEWEST_LENGTHS = 3


def flight_row(arrivals: pd.DataFrame) -> Estimate:
    """Return the speed whose delay, the same at every length, cannot bias it.

    `arrivals` are the rows of the estimator "arrival" of scenes that differ in nothing but the
    length of their duplex; the distance of each is its speed times its time. With fewer than three
    lengths, or times that do not grow with them, the row has a reason instead of a speed.
    """
    known = arrivals[arrivals["speed_A_per_ps"].notna() & (arrivals["estimator"] == "arrival")]
    first = arrivals.iloc[0]
    scenes = ", ".join(dict.fromkeys(known["scene"]))
    row = Estimate(
        str(first["scene"]), str(first["wave"]), ESTIMATOR, reason=f"over {scenes or 'no scene'}"
    )
    times = known["arrival_ps"].to_numpy(dtype=np.float64)
    lengths = known["speed_A_per_ps"].to_numpy(dtype=np.float64) * times
    paper_ps = known["paper_arrival_ps"].to_numpy(dtype=np.float64)
    different = len(np.unique(np.round(lengths, 3)))
    if different < FEWEST_LENGTHS:
        return _without(row, f"{different} lengths with an arrival; {FEWEST_LENGTHS} are needed")
    try:
        found, paper = fit_flight(lengths, times), fit_flight(lengths, paper_ps)
    except InputError as error:
        return _without(row, str(error))
    speed, expected = found.speed_A_per_ps, paper.speed_A_per_ps.value
    return Estimate(
        row.scene,
        row.wave,
        row.estimator,
        speed_A_per_ps=speed.value,
        low_A_per_ps=speed.low,
        # A limit that the data do not set is blank.
        high_A_per_ps=speed.high if np.isfinite(speed.high) else None,
        interval="linear regression of time on length, Student's t",
        variations=len(times),
        paper_A_per_ps=expected,
        ratio_to_paper=speed.value / expected,
        reason=f"{row.reason}; delay {found.delay_ps.value:.2g} ps, "
        f"scatter {found.scatter_ps:.2g} ps",
    )


def _without(row: Estimate, reason: str) -> Estimate:
    return Estimate(row.scene, row.wave, row.estimator, reason=f"{row.reason}: {reason}")
