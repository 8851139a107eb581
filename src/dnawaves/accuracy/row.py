"""One row of the study: a setting's errors and its time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from dnawaves.accuracy.errors import Errors, between_frames, errors, rate, scaled
from dnawaves.accuracy.machine import machine
from dnawaves.accuracy.models import GPU_PLATFORMS
from dnawaves.accuracy.observe import HELICAL, Observed, Observer
from dnawaves.accuracy.pair_run import PairRun, Timing, race
from dnawaves.accuracy.replicas import averages
from dnawaves.accuracy.settings import Setting
from dnawaves.accuracy.start import Start
from dnawaves.errors import SimulationError
from dnawaves.motion.interior import interior

# Turns that a run and the default's take: seven ratios have quartiles.
LAPS = 8
# Averages of thermal runs, of whose errors the median is taken.
DRAWS = 5
THREADS = 1
OK = "ok"
Row = dict[str, str | float | int | bool | None]


def measure(setting: Setting, start: Start | None, usual: Start, known: dict[str, Observed]) -> Row:
    """Return the row of a setting; one that cannot be run is a row that says why.

    `start` is None and `known` empty where the system has no minimum; `usual` is where the runs
    start whose time is the measure.
    """
    row = _described(setting) | machine() | {"threads": THREADS}
    if start is None:
        return row | {"status": "the system has no minimum"}
    row |= _structure(start) | {"atoms": len(start.duplex.masses_Da)}
    spacing_nm, linear = start.duplex.spacing_nm, known["linear"]
    row["rate"] = rate(linear, setting.case, spacing_nm)
    if setting.numerics.replicas is not None:
        return row | _replicas(setting, start, linear)
    try:
        run = PairRun(start.duplex, setting.case, setting.numerics)
        timing = _timed(setting, run, usual)
    except SimulationError as error:
        return row | {"status": str(error)}
    found = run.observed()
    answer = scaled(linear, setting.numerics.scale)
    row |= _errors(errors(found, answer, setting.case, spacing_nm))
    row["between_frames_error"] = between_frames(found, answer)
    if setting.converged and "converged" in known:
        converged = _on_grid(found, known["converged"])
        if converged is not None:
            part = errors(converged, known["converged"], setting.case, spacing_nm)
            row |= _errors(part, "integration_")
    return row | _time(timing) | {"status": OK}


def _timed(setting: Setting, run: PairRun, usual: Start) -> Timing:
    other = PairRun(usual.duplex, setting.usual, setting.default)
    durations = (setting.case.duration_ps, setting.usual.duration_ps)
    on_gpu = setting.numerics.platform in GPU_PLATFORMS
    return race(run, other, durations, LAPS, cpu=not on_gpu)


def _on_grid(found: Observed, known: Observed) -> Observed | None:
    """Return the frames at which the converged answer is known, None where they are too few."""
    steps = np.abs(found.times_ps[:, None] - known.times_ps).min(axis=1) < 1e-6
    if steps.sum() < len(known.times_ps) // 2:
        return None
    return Observed(found.times_ps[steps], found.velocity[steps], found.helical[:, steps])


def _replicas(setting: Setting, start: Start, linear: Observed) -> Row:
    numerics = setting.numerics
    assert numerics.replicas is not None
    answer = scaled(linear, numerics.scale)
    all_errors = [
        errors(one, answer, setting.case, start.duplex.spacing_nm)
        for one in averages(start, setting.case, numerics, linear, DRAWS)
    ]
    return {
        "speed_error": _median([one.speed for one in all_errors]),
        "waveform_error": _median([one.waveform for one in all_errors]),
        "waveform_rms_error": _median([one.waveform_rms for one in all_errors]),
        # A single run is half a pair.
        "relative_cost": 0.5 * numerics.replicas,
        "status": OK,
    }


def _median(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None


def _described(setting: Setting) -> Row:
    excitation = setting.case.excitation
    return {
        "setting": setting.name,
        "line": setting.line,
        "title": setting.title,
        "label": setting.label,
        "table": setting.table,
        "slope": setting.slope,
        "case": setting.case_name,
        "usual_case": setting.usual_name,
        "is_default": setting.is_default,
        "declarable": setting.numerics.declarable,
        "base_pairs": len(setting.system.sequence),
        "kind": excitation.kind,
        "wave": excitation.wave,
        "mode": getattr(excitation, "mode", None),
        "kicked_pairs": getattr(excitation, "pairs", None),
        "amplitude": setting.numerics.scale * excitation.amplitude,
        "record_ps": setting.case.duration_ps,
        **setting.numerics.model_dump(exclude={"replicas", "temperature_K"}),
        "replicas": setting.numerics.replicas,
    }


def _structure(start: Start) -> Row:
    """Return the means of rise, roll and twist over the interior steps of the minimum."""
    values = Observer(start.duplex, "extension").helical(start.duplex.positions_nm[None])[:, 0]
    inside = values[:, interior(start.duplex.pair_count - 1)].mean(axis=1)
    means = dict(zip(HELICAL, inside, strict=True))
    return {
        "rise_A": float(means["rise"]),
        "roll_deg": float(means["roll"]),
        "twist_deg": float(means["twist"]),
    }


def _errors(found: Errors, what: str = "") -> Row:
    return {
        f"speed_{what}error": found.speed,
        f"waveform_{what}error": found.waveform,
        f"waveform_rms_{what}error": found.waveform_rms,
        f"helical_{what}error": found.helical,
        f"helical_{what}worst": found.helical_worst,
    }


def _time(timing: Timing) -> Row:
    values = asdict(timing)
    names = {"ratio": "relative_cost", "low": "relative_cost_low", "high": "relative_cost_high"}
    return {names.get(name, name): value for name, value in values.items()}
