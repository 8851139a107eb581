"""What the jobs cost: seconds, processor time and memory, per rule and scene."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import pandas as pd
import plotly.graph_objects as go

from dnawaves.comparison.judge import Band
from dnawaves.report.gather import Job
from dnawaves.report.numbers import band, digits, percent
from dnawaves.report.style import blank_figure
from dnawaves.report.tables import Table

COLOURS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#b0568f", "#56b4e9", "#8a6d3b", "#6b7785")
ALL_SCENES = "all scenes"
NOT_RECORDED = "not recorded"


def costs_figure(jobs: Sequence[Job]) -> go.Figure:
    """Return the seconds of each scene and system, one bar, stacked by rule."""
    targets = list(dict.fromkeys(job.target or ALL_SCENES for job in jobs))
    figure = blank_figure("time of the jobs (s)", "", 90 + 22 * len(targets))
    for index, rule in enumerate(_rules(jobs)):
        seconds = {
            target: _total(
                job.wall_s
                for job in jobs
                if job.rule == rule and (job.target or ALL_SCENES) == target
            )
            for target in targets
        }
        shown = {target: value for target, value in seconds.items() if value}
        figure.add_bar(
            x=list(shown.values()),
            y=list(shown),
            orientation="h",
            name=rule,
            marker_color=COLOURS[index % len(COLOURS)],
            hovertemplate=f"{rule}, %{{y}}: %{{x:.3g}} s<extra></extra>",
        )
    figure.update_layout(
        barmode="stack",
        bargap=0.25,
        yaxis={
            "categoryorder": "array",
            "categoryarray": targets[::-1],
            "tickfont": {"size": 11},
        },
    )
    return figure


def costs_table(jobs: Sequence[Job]) -> Table:
    """Return the sum over each rule's jobs, and over all."""
    groups = [(rule, [job for job in jobs if job.rule == rule]) for rule in _rules(jobs)]
    return Table(
        ("rule", "jobs", "time (s)", "processor time (s)", "largest memory (MB)"),
        [
            [
                name,
                str(len(group)),
                _number(_total(job.wall_s for job in group)),
                _number(_total(job.cpu_s for job in group)),
                _number(
                    max((job.memory_MB for job in group if job.memory_MB is not None), default=None)
                ),
            ]
            for name, group in [*groups, ("all", list(jobs))]
        ],
    )


def jobs_table(jobs: Sequence[Job]) -> Table:
    """Return every job by itself."""
    return Table(
        ("rule", "scene or system", "run", "time (s)", "processor time (s)", "memory (MB)"),
        [
            [
                job.rule,
                job.target or ALL_SCENES,
                job.run,
                _number(job.wall_s),
                _number(job.cpu_s),
                _number(job.memory_MB),
            ]
            for job in jobs
        ],
    )


def effects_table(systems: Mapping[str, pd.DataFrame | None]) -> Table | None:
    """Return what each effect of each system costs per step, measured by leaving it out."""
    rows = [
        [
            name,
            str(row["effect"]),
            digits(row["ms_per_step_without"]),
            digits(row["ms_per_step_whole"]),
            band(Band.of(*(float(row[part]) for part in ("ms_saved", "low", "high")))),
            percent(row["ms_saved"] / row["ms_per_step_whole"]),
        ]
        for name, costs in systems.items()
        if costs is not None
        for _, row in costs.iterrows()
    ]
    if not rows:
        return None
    header = ("system", "effect", "without (ms/step)", "with (ms/step)", "saved (ms)", "saved")
    return Table(header, rows)


def _rules(jobs: Sequence[Job]) -> list[str]:
    """Return the rules, the most expensive first."""
    spent = {job.rule: 0.0 for job in jobs}
    for job in jobs:
        spent[job.rule] += job.wall_s or 0.0
    return sorted(spent, key=lambda rule: -spent[rule])


def _total(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) if known else None


def _number(value: float | None) -> str:
    return NOT_RECORDED if value is None else digits(value)
