"""Estimates of an excited wave above 0 K, from the average over replicas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dnawaves.scene.excitations import Kick, Periodic, StandingWave
from dnawaves.waves.estimators.lattices import Lattice
from dnawaves.waves.estimators.long_waves import Projection
from dnawaves.waves.estimators.replicas import ReplicaFit, Replicas, fit_replicas
from dnawaves.waves.estimators.window import ENERGY_ROOM, FEWEST_FRAMES
from dnawaves.waves.observations import PLANE, plane, single
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.rows import blank, too_short
from dnawaves.waves.scene_source import mean_mass
from dnawaves.waves.table import Estimate
from dnawaves.waves.waveforms import Observe, long_waves

Array = NDArray[np.float64]

SEED = 1
ESTIMATOR = "waveform, replicas"


class Replica(NamedTuple):
    """A record and its field (time, *field), as far as it is the answer to the excitation."""

    record: Record
    field: Array


def replica_rows(records: Sequence[Record]) -> list[Estimate]:
    """Return the row of the full-waveform fit of long waves to the average over replicas.

    Kicks of several sizes are fitted apart, drives of several frequencies together. Within a
    picosecond chaos makes more of the difference of two signs than was put in, but nearly all of
    that is short; a record ends where the long waves of its difference hold more.
    """
    excitation = records[0].scene.excitation
    wave = excitation.wave  # type: ignore[union-attr]
    groups: dict[str, list[Replica]] = {}
    for record in records:
        replica = _replica(record, wave)
        if len(replica.field) >= FEWEST_FRAMES:
            groups.setdefault(variant(record.member), []).append(replica)
    first = variant(records[0].member)
    if first not in groups:
        return [too_short(records[0], wave)]
    if isinstance(excitation, Periodic):
        scenes = list(groups.values())
        return [_row(scenes[0], _fit(scenes, wave), wave)]
    fits = {name: _fit([group], wave) for name, group in groups.items()}
    row = _row(groups[first], fits[first], wave)
    if isinstance(excitation, Kick | StandingWave):
        half = f"x{0.5 * float(first[1:]):g}"
        if half in fits:
            change = abs(fits[half].value.value / fits[first].value.value - 1)
            row = replace(row, half_kick_change=change)
    return [row]


def variant(member: str) -> str:
    """Return a member's name without the number of its snapshot: `x0.5` of `x0.5r2`."""
    name, _, number = member.rpartition("r")
    return name if number.isdigit() else member


def _replica(record: Record, wave: str) -> Replica:
    """Return a record's field up to where its long waves hold more energy than was put in."""
    frames = len(record.times_ps)
    field = _observe(wave)(record, frames).velocity
    moved = field[:, _observe(wave)(record, 1).lattice.moving]
    energy = 0.5 * np.sum(_directions(record, wave).whiten(moved) ** 2, axis=0)
    if wave in AXIAL_WAVES:
        energy *= mean_mass(record, wave)
    put_in = record.fields["energy_put_in"].values
    excess = energy > put_in + ENERGY_ROOM * (put_in + put_in.max())
    return Replica(record, field[: int(np.argmax(excess)) if excess.any() else frames])


def _observe(wave: str) -> Observe:
    return single(wave) if wave in AXIAL_WAVES else plane


def _directions(record: Record, wave: str) -> Projection:
    return long_waves(record, () if wave in AXIAL_WAVES else PLANE)[0]


def _fit(scenes: Sequence[Sequence[Replica]], wave: str) -> ReplicaFit:
    averaged: list[tuple[Replicas, Lattice]] = []
    for replicas in scenes:
        mean = Replicas.of([one.field for one in replicas])
        averaged.append((mean, _observe(wave)(replicas[0].record, mean.frames).lattice))
    directions = _directions(scenes[0][0].record, wave)
    name = "speed_A_per_ps" if wave in AXIAL_WAVES else f"{wave}_A_per_ps"
    return fit_replicas(averaged, directions, name, np.random.default_rng(SEED))


def _row(replicas: Sequence[Replica], fit: ReplicaFit, wave: str) -> Estimate:
    record, speed = replicas[0].record, fit.value
    empty = blank(record, wave, ESTIMATOR)
    paper = record.paper_speeds_A_per_ps[wave]
    reason = f"p = {fit.p_value:.2g} of what the fit leaves, by the spread between replicas"
    word = "rejected: leaves more than the replicas' spread" if fit.wrong else "fits"
    if fit.replicas == 1:
        reason, word = "one replica: nothing says how far its chaos goes", ""
    return replace(
        empty,
        speed_A_per_ps=speed.value,
        low_A_per_ps=speed.low if fit.interval else None,
        high_A_per_ps=speed.high if fit.interval else None,
        interval=fit.interval,
        variations=fit.replicas,
        paper_A_per_ps=paper,
        ratio_to_paper=speed.value / paper,
        misfit=fit.misfit,
        model_class=word,
        amplitude=fit.amplitude,
        friction_per_ps=fit.friction_per_ps,
        window_ps=float(record.times_ps[fit.frames - 1]),
        reason=reason,
    )
