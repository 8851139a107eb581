"""The table of estimates: one row per scene, wave and estimator."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import pandas as pd

from dnawaves.files import whole_file

MODEL_SPREAD = "model spread"
CSV_FORMAT = "%.6g"


@dataclass(frozen=True)
class Estimate:
    """One estimate of a wave's speed, beside the paper's value for the same thing.

    `low` and `high` are the ends of its interval; `interval` says what kind of interval that is,
    `profile_low` and `profile_high` are those of the profile likelihood of the first fit alone.
    `model_class` is "fits", "fits roughly: ..." or "rejected: ...". `amplitude` is that of the
    source in the fit, 1 if it is what was put in; `p_value` is that of a search for a wave in
    noise. A blank speed comes with a reason.
    """

    scene: str
    wave: str
    estimator: str
    speed_A_per_ps: float | None = None
    low_A_per_ps: float | None = None
    high_A_per_ps: float | None = None
    interval: str = ""
    variations: int = 0
    paper_A_per_ps: float | None = None
    ratio_to_paper: float | None = None
    misfit: float | None = None
    model_class: str = ""
    amplitude: float | None = None
    profile_low_A_per_ps: float | None = None
    profile_high_A_per_ps: float | None = None
    coupling: float | None = None
    phase_rad: float | None = None
    p_value: float | None = None
    friction_per_ps: float | None = None
    frequency_GHz: float | None = None
    paper_frequency_GHz: float | None = None
    wavenumber_rad_per_A: float | None = None
    window_ps: float | None = None
    record_ps: float | None = None
    half_kick_change: float | None = None
    arrival_ps: float | None = None
    paper_arrival_ps: float | None = None
    reason: str = ""
    system: str = ""
    method: str = "simulated"


COLUMNS = tuple(field.name for field in fields(Estimate))
TEXT_COLUMNS = (
    "scene",
    "wave",
    "estimator",
    "interval",
    "model_class",
    "reason",
    "system",
    "method",
)


def spread(estimate: Estimate, speeds_A_per_ps: Sequence[float], paper_A_per_ps: float) -> Estimate:
    """Return the estimate with its first speed, the range of all of them, and the ratio.

    One speed alone has no range: its limits are blank, as what is not known.
    """
    several = len(speeds_A_per_ps) > 1
    return Estimate(
        **{
            **asdict(estimate),
            "speed_A_per_ps": speeds_A_per_ps[0],
            "low_A_per_ps": min(speeds_A_per_ps) if several else None,
            "high_A_per_ps": max(speeds_A_per_ps) if several else None,
            "interval": MODEL_SPREAD if several else "",
            "variations": len(speeds_A_per_ps),
            "paper_A_per_ps": paper_A_per_ps,
            "ratio_to_paper": speeds_A_per_ps[0] / paper_A_per_ps,
        }
    )


def write_table(path: Path, estimates: Iterable[Estimate]) -> None:
    """Write estimates as CSV, whole or not at all."""
    frame = pd.DataFrame([asdict(estimate) for estimate in estimates], columns=list(COLUMNS))
    with whole_file(path) as temporary:
        frame.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def read_table(path: Path, text: Collection[str] = TEXT_COLUMNS) -> pd.DataFrame:
    """Read a table of estimates; `text` columns are empty strings where nothing was written."""
    # As text first: pandas takes a scene that is called "null" or "NA" for a missing value.
    frame = pd.read_csv(path, dtype=str, keep_default_na=False)
    numbers = [str(name) for name in frame if name not in text]
    frame[numbers] = frame[numbers].apply(pd.to_numeric)
    return frame
