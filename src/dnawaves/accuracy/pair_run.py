"""A pair of copies of opposite sign, observed as it runs, and timed against another pair."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.accuracy.engine import Engine
from dnawaves.accuracy.models import Case, Numerics
from dnawaves.accuracy.observe import Observed, Observer, odd
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.pattern import kick_pattern

Array = NDArray[np.float64]
SIGNS = (1, -1)


class PairRun:
    """Two copies of a duplex under one setting, from t = 0 on."""

    def __init__(self, duplex: SimulatedDuplex, case: Case, numerics: Numerics) -> None:
        held, kick = held_pairs(case.ends, duplex.pair_count), kick_velocities(duplex, case)
        self._observer = Observer(duplex, case.excitation.wave)
        self._copies = [
            Engine(duplex, held, numerics, sign * numerics.scale * kick) for sign in SIGNS
        ]
        self._steps = round(numerics.interval_fs / numerics.timestep_fs)
        self._interval_ps = numerics.interval_fs / 1e3
        self._positions = [[duplex.positions_nm] for _ in SIGNS]
        start = self._observer.velocity(duplex.positions_nm, numerics.scale * kick)
        self._velocity = [[start], [-start]]

    @property
    def frames(self) -> int:
        """Number of frames so far."""
        return len(self._velocity[0])

    @property
    def time_ps(self) -> float:
        """Time of the last frame."""
        return (self.frames - 1) * self._interval_ps

    def advance(self, until_ps: float) -> None:
        """Go on to the last frame that is not later."""
        while self.frames * self._interval_ps <= until_ps + 1e-9:
            for index, one in enumerate(self._copies):
                positions, velocities = one.advance(self._steps)
                self._velocity[index].append(self._observer.velocity(positions, velocities))
                self._positions[index].append(positions)

    def observed(self) -> Observed:
        """Return what has been seen so far."""
        plus, minus = (np.array(values) for values in self._velocity)
        parameters = [self._observer.helical(np.array(frames)) for frames in self._positions]
        times_ps = np.asarray(self._interval_ps * np.arange(self.frames), dtype=np.float64)
        return Observed(times_ps, odd(plus, minus), odd(*parameters))


def kick_velocities(duplex: SimulatedDuplex, case: Case) -> Array:
    """Return the velocities (atoms, 3) that the case's own kick puts in, nm/ps."""
    return kick_pattern(case.excitation, case.ends, duplex.pair_count).velocities(duplex)


@dataclass(frozen=True)
class Timing:
    """Time of a run in s, and in parts of another that took turns with it, over equal times.

    `low` and `high` are the quartiles of that ratio over the turns.
    """

    cpu_s: float
    wall_s: float
    ratio: float
    low: float
    high: float


def race(
    run: PairRun, usual: PairRun, durations_ps: tuple[float, float], laps: int, cpu: bool
) -> Timing:
    """Run two pairs to their ends in turns.

    Whatever else the machine does then meets both alike. The ratio is that of the processor's time,
    or of the wall's where `cpu` is false, each divided by the time that was simulated.
    """
    spent, advanced_ps = np.zeros((laps, 2, 2)), np.zeros((laps, 2))
    for lap in range(laps):
        for which, (one, duration_ps) in enumerate(zip((run, usual), durations_ps, strict=True)):
            before_ps = one.time_ps
            started = np.array([time.process_time(), time.perf_counter()])
            one.advance(duration_ps * (lap + 1) / laps)
            spent[lap, which] = [time.process_time(), time.perf_counter()] - started
            advanced_ps[lap, which] = one.time_ps - before_ps
    # A turn shorter than the time between two frames may do nothing.
    worked = np.all(advanced_ps > 0, axis=1)
    rates = spent[worked, :, 0 if cpu else 1] / advanced_ps[worked]
    # The first turn also sets up what is reused.
    ratios = rates[1:, 0] / rates[1:, 1]
    low, ratio, high = np.quantile(ratios, [0.25, 0.5, 0.75])
    total = spent[:, 0].sum(axis=0)
    return Timing(float(total[0]), float(total[1]), float(ratio), float(low), float(high))
