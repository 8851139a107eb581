"""All estimates that a scene's excitation calls for, with their spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.dispersion import lattice_speed_from_frequency
from dnawaves.rod.standing import (
    axial_frequency_rad_per_ps,
    axial_standing_wave,
    axial_wavenumber,
    bend_standing_wave,
    fixed_fixed_frequency_GHz,
    shear_standing_wave,
)
from dnawaves.scene.excitations import Kick, Nothing, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.pairs import excited_pairs
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.estimators import (
    arrival_ps,
    damped_sine_fit,
    project_on_shape,
    project_on_start,
    resonance_fit,
    waveform_fit,
)
from dnawaves.waves.fit import Fit
from dnawaves.waves.record import AXIAL_WAVES, Record, paper_rod
from dnawaves.waves.table import Estimate, spread
from dnawaves.waves.window import FEWEST_FRAMES, windows

Array = NDArray[np.float64]
ARRIVAL_PAIRS = 3
# Velocities that count as a wave where nothing was put in: 1 % of the shipped kicks.
STILL = {"extension": 1e-3, "twist": 1e-4, "bend": 1e-4, "shear": 1e-3}
UNITS = {"extension": "Å/ps", "twist": "rad/ps", "bend": "rad/ps", "shear": "Å/ps"}
# Root of the residual's share: above it, a quarter of the motion's sum of squares is left over.
POOR_MISFIT = 0.5


def analyse(records: Sequence[Record]) -> list[Estimate]:
    """Return the estimates of one scene from its recorded members."""
    excitation = records[0].scene.excitation
    if isinstance(excitation, Nothing):
        return [_null(records[0], wave) for wave in STILL]
    if isinstance(excitation, Static):
        return _static(records, excitation)
    if records[0].usable < FEWEST_FRAMES:
        return [_too_short(records[0], excitation.wave)]
    records = [record for record in records if record.usable >= FEWEST_FRAMES]
    if isinstance(excitation, StandingWave):
        return [_standing(records, excitation)]
    if isinstance(excitation, Periodic):
        return [_resonance(records, excitation)]
    return _local(records, excitation)


def _local(records: Sequence[Record], excitation: Kick | Pulse) -> list[Estimate]:
    if isinstance(excitation, Pulse):
        return [replace(_blank(records[0], excitation.wave), reason="no estimator for a pulse yet")]
    estimates = [_arrival(records, excitation)]
    if excitation.wave in AXIAL_WAVES:
        estimates.insert(0, _waveform(records, excitation.wave))
    return estimates


def _waveform(records: Sequence[Record], wave: str) -> Estimate:
    first = records[0]

    def fit(record: Record, frames: int, observed: NDArray[np.bool_] | None = None) -> Fit:
        return waveform_fit(
            record.times_ps[:frames],
            record.velocity(wave)[:frames],
            record.spacing_nm,
            record.held,
            observed,
        )

    fits = [fit(record, frames) for record in records for frames in windows(record.usable)]
    parity = np.arange(first.pairs) % 2 == 0
    fits += [fit(first, first.usable, observed) for observed in (parity, ~parity)]
    return _from_fits(records, wave, "waveform", [one.rate for one in fits], fits)


def _arrival(records: Sequence[Record], excitation: Kick) -> Estimate:
    """Arrival at the far end, beside that of the paper's rod at the same base pair.

    The pick is biased by the width of the kick and by the end, in both alike: the ratio to the
    paper's is what to read. The headline is the farthest pair at which both have arrived.
    """
    wave, first = excitation.wave, records[0]
    measured = [
        _arrival_times(
            record,
            excitation,
            record.times_ps[: record.usable],
            record.velocity(wave)[: record.usable],
        )
        for record in records
    ]
    estimate = _blank(first, wave, "arrival")
    if not measured[0]:
        return replace(estimate, reason="no front has passed the observed pairs in this record")
    distances = _distances(first, excitation)
    # As many crossings as the simulation's record shows: the pick depends on the record's length.
    pair, time_ps = next(iter(measured[0].items()))
    stretch = distances[pair] / time_ps / first.paper_speeds_A_per_ps[wave]
    frames = int(np.ceil(max(stretch, 1.0) * first.usable))
    times = np.arange(frames) * first.times_ps[1]
    paper = _arrival_times(first, excitation, times, first.paper_velocity(wave, times))
    common = [pair for pair in measured[0] if pair in paper]
    if not common:
        return replace(estimate, reason="the paper's rod shows no front to compare with")
    pair = common[0]
    speeds = [distances[pair] / measured[0][pair]]
    speeds += [distances[other] / time for times_of in measured for other, time in times_of.items()]
    return replace(
        spread(estimate, speeds, distances[pair] / paper[pair]),
        arrival_ps=measured[0][pair],
        paper_arrival_ps=paper[pair],
    )


def _distances(record: Record, excitation: Kick) -> Array:
    height = record.motion["height"].values
    distances: Array = height - height[excited_pairs(excitation, record.scene.ends)].mean()
    return distances


def _arrival_times(
    record: Record, excitation: Kick, times_ps: Array, velocity: Array
) -> dict[int, float]:
    """Return arrival times by base pair, the farthest first.

    The pair next to a held end is left out: there the reflection meets the front.
    """
    excited = excited_pairs(excitation, record.scene.ends)
    beside = [pair - 1 for pair in record.held if pair > excited[-1]]
    free = [
        pair
        for pair in range(excited[-1] + 1, record.pairs)
        if pair not in record.held and pair not in beside
    ]
    farthest = free[: -ARRIVAL_PAIRS - 1 : -1]
    found = {pair: arrival_ps(times_ps, velocity[:, pair]) for pair in farthest}
    return {pair: time for pair, time in found.items() if time is not None and time > 0}


def _standing(records: Sequence[Record], excitation: StandingWave) -> Estimate:
    wave, first = excitation.wave, records[0]
    wavenumber = excitation.mode * np.pi / (first.free_length_A / A_PER_NM)
    pairs = first.span[1] - first.span[0] + 1
    fits = []
    for record in records:
        projection = standing_projection(record, wave)
        fits += [
            damped_sine_fit(record.times_ps[:frames], projection[:frames])
            for frames in windows(record.usable)
        ]
    if wave in AXIAL_WAVES:
        wavenumber = axial_wavenumber(pairs, excitation.mode, "held", first.spacing_nm)
        speeds = [
            float(lattice_speed_from_frequency(fit.rate, wavenumber, first.spacing_nm))
            for fit in fits
        ]
        paper_speed = first.paper_speeds_A_per_ps[wave]
        paper_frequency = axial_frequency_rad_per_ps(
            pairs, excitation.mode, "held", paper_speed, first.spacing_nm
        )
    else:
        standing = bend_standing_wave if wave == "bend" else shear_standing_wave
        rod = paper_rod(first.spacing_nm)
        paper_frequency = standing(rod, pairs, excitation.mode, "held").frequency_rad_per_ps
        speeds = [fit.rate / wavenumber * A_PER_NM for fit in fits]
        paper_speed = paper_frequency / wavenumber * A_PER_NM
    estimate = _from_fits(records, wave, "standing wave", speeds, fits, paper_speed)
    return replace(
        estimate,
        frequency_GHz=fits[0].rate * GHZ_PER_RAD_PER_PS,
        paper_frequency_GHz=paper_frequency * GHZ_PER_RAD_PER_PS,
        wavenumber_rad_per_A=wavenumber / A_PER_NM,
    )


def _resonance(records: Sequence[Record], excitation: Periodic) -> Estimate:
    first, wave = records[0], excitation.wave
    pairs = first.span[1] - first.span[0] + 1
    wavenumber = axial_wavenumber(pairs, 1, "held", first.spacing_nm)
    drives = [2e-3 * np.pi * float(record.motion.attrs["frequency_GHz"]) for record in records]
    ramps = [float(record.motion.attrs.get("ramp_ps", 0.0)) for record in records]
    projections = [mode_projection(record, wave) for record in records]

    def fit(chosen: Sequence[int], part: float) -> Fit:
        frames = [int(part * records[index].usable) for index in chosen]
        return resonance_fit(
            [records[i].times_ps[:n] for i, n in zip(chosen, frames, strict=True)],
            [projections[i][:n] for i, n in zip(chosen, frames, strict=True)],
            [drives[i] for i in chosen],
            [ramps[i] for i in chosen],
        )

    everything = range(len(records))
    fits = [fit(everything, part) for part in (1.0, 0.75, 0.5)]
    fits += [fit([index], 1.0) for index in everything] if len(records) > 1 else []
    speeds = [
        float(lattice_speed_from_frequency(one.rate, wavenumber, first.spacing_nm)) for one in fits
    ]
    paper = first.paper_speeds_A_per_ps[wave]
    estimate = _from_fits(records, wave, "resonance", speeds, fits, paper)
    return replace(
        estimate,
        frequency_GHz=fits[0].rate * GHZ_PER_RAD_PER_PS,
        paper_frequency_GHz=fixed_fixed_frequency_GHz(1, paper, first.free_length_A / A_PER_NM),
        wavenumber_rad_per_A=wavenumber / A_PER_NM,
    )


def _static(records: Sequence[Record], excitation: Static) -> list[Estimate]:
    first, wave = records[0], excitation.wave
    paper = first.paper_speeds_A_per_ps[wave]
    inside = [record for record in records if not record.motion.attrs["left_basin"]]
    speeds = [
        _static_speed(
            record, float(record.motion.attrs["load"]), record.fields[f"{wave}_displacement"][0, -1]
        )
        for record in inside
    ]
    name = first.scene.name
    estimates = []
    if speeds:
        loads = ", ".join(f"{float(record.motion.attrs['load']):g}" for record in inside)
        unit = "pN" if wave == "extension" else "pN nm"
        estimates.append(
            replace(
                spread(Estimate(name, wave, "static"), speeds, paper),
                reason=f"spread over loads of ±{loads} {unit}",
            )
        )
    for record in records:
        if record.motion.attrs["left_basin"]:
            estimates.append(
                Estimate(
                    name,
                    wave,
                    f"static {record.member}",
                    paper_A_per_ps=paper,
                    reason=f"a load of {record.motion.attrs['left_basin']} times "
                    f"{record.motion.attrs['load']:g} drove the duplex into another minimum",
                )
            )
    response = first.motion["linear_response"]
    for lock in response["lock"].values:
        speed = _static_speed(first, 1.0, response.sel(lock=lock))
        label = "static, no load" if lock == "nothing" else f"static, held {lock}"
        estimates.append(
            Estimate(
                name,
                wave,
                label.replace("_", " "),
                speed_A_per_ps=speed,
                interval="none: exact linear response",
                paper_A_per_ps=paper,
                ratio_to_paper=speed / paper,
                reason=LOCK_REASONS[str(lock)],
            )
        )
    return estimates


LOCK_REASONS = {
    "nothing": "limit of a vanishing load",
    "across": "as a wave too fast for the base pairs to move across the axis would find it",
    "across_and_tilt": "as a wave too fast for them to tilt as well would find it",
}


def _static_speed(record: Record, load: float, displacement: object) -> float:
    """Return the speed of the rod whose whole length is displaced so far (Å or rad) by a load."""
    strain = float(displacement) / record.free_length_A  # type: ignore[arg-type]
    if record.scene.excitation.wave == "extension":  # type: ignore[union-attr]
        density = float(record.motion["mass"].values.mean()) / (record.spacing_nm * A_PER_NM)
        modulus = load * KJ_PER_MOL_PER_PN_NM * A_PER_NM / strain
    else:
        density = record.inertia_Da_A2("helix") / (record.spacing_nm * A_PER_NM)
        modulus = load * KJ_PER_MOL_PER_PN_NM * A_PER_NM**2 / strain
    return float(np.sqrt(modulus / density))


def _null(record: Record, wave: str) -> Estimate:
    largest = float(np.abs(record.velocity(wave)).max())
    moved = f"the residual motion is at most {largest:.2g} {UNITS[wave]}"
    still = largest < STILL[wave]
    reason = f"no wave: {moved}" if still else f"moves by itself: {moved}"
    return replace(_blank(record, wave), reason=f"{reason}; a wave would be {STILL[wave]:g}")


def _too_short(record: Record, wave: str) -> Estimate:
    return replace(
        _blank(record, wave),
        window_ps=float(record.times_ps[max(record.usable - 1, 0)]),
        reason=f"only {record.usable} usable frames of {len(record.times_ps)}, before the record "
        "ends or the difference of the two signs holds more energy than was put in; at least "
        f"{FEWEST_FRAMES} are needed",
    )


def _blank(record: Record, wave: str, estimator: str = "none") -> Estimate:
    return Estimate(
        record.scene.name,
        wave,
        estimator,
        record_ps=float(record.times_ps[-1]),
        # A bend or shear wave has no single speed that could stand here.
        paper_A_per_ps=record.paper_speeds_A_per_ps[wave] if wave in AXIAL_WAVES else None,
    )


def standing_projection(record: Record, wave: str) -> Array:
    """Return the share (time,) of the motion in the standing wave that was kicked."""
    if wave in AXIAL_WAVES:
        return project_on_start((1.0, record.velocity(wave)))
    mass = float(record.motion["mass"].values.mean())
    return project_on_start(
        (mass, record.velocity("shear")), (record.inertia_Da_A2("second"), record.velocity("bend"))
    )


def mode_projection(record: Record, wave: str) -> Array:
    """Return the amplitude (time,) of the lowest standing wave in a velocity field."""
    first, last = record.span
    shape = axial_standing_wave(last - first + 1, 1, "held")
    return project_on_shape(record.velocity(wave)[:, first : last + 1], shape)


def _from_fits(
    records: Sequence[Record],
    wave: str,
    estimator: str,
    speeds: list[float],
    fits: list[Fit],
    paper: float | None = None,
) -> Estimate:
    """Return the estimate of the first fit with the spread of all.

    The fits of a kick scene come member by member, each member's longest window first.
    """
    first = records[0]
    reasons = []
    if any(record.usable < len(record.times_ps) for record in records):
        reasons.append("the fit ends where the difference holds more energy than was put in")
    if fits[0].misfit > POOR_MISFIT:
        reasons.append("poor fit: the model leaves over a quarter of the motion unexplained")
    return spread(
        Estimate(
            first.scene.name,
            wave,
            estimator,
            misfit=fits[0].misfit,
            friction_per_ps=fits[0].friction_per_ps,
            window_ps=float(first.times_ps[first.usable - 1]),
            record_ps=float(first.times_ps[-1]),
            half_kick_change=_half_kick_change(records, speeds),
            reason="; ".join(reasons),
        ),
        speeds,
        paper if paper is not None else first.paper_speeds_A_per_ps[wave],
    )


def _half_kick_change(records: Sequence[Record], speeds: list[float]) -> float | None:
    """Return the relative change of the speed from the first member to one of half its size."""
    if not isinstance(records[0].scene.excitation, Kick | StandingWave):
        return None
    start = 0
    for record in records:
        if float(record.member[1:]) == 0.5 * float(records[0].member[1:]):
            return abs(speeds[start] / speeds[0] - 1)
        start += len(windows(record.usable))
    return None
