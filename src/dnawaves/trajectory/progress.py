"""Progress of a long simulation: a bar on a terminal, plain lines in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

SECONDS_PER_DAY = 86_400
LINES_IN_LOG = 10


class Advance(Protocol):
    """Called with the simulated time so far, all copies together, in ps."""

    def __call__(self, simulated_ps: float) -> None: ...


@contextmanager
def progress(title: str, total_ps: float, done_ps: float = 0.0) -> Iterator[Advance]:
    """Yield a function to call with the simulated time; shows ns/day and the time left.

    `done_ps` was simulated before: it is no part of the speed.
    """
    started = time.monotonic()

    def speed_ns_per_day(simulated_ps: float) -> float:
        elapsed = max(time.monotonic() - started, 1e-9)
        return (simulated_ps - done_ps) / 1e3 / elapsed * SECONDS_PER_DAY

    console = Console(stderr=True)
    if console.is_terminal:
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:.1f}/{task.total:.1f} ps  {task.fields[rate]:.1f} ns/day"),
            TimeRemainingColumn(),
        )
        with Progress(*columns, console=console) as bars:
            task = bars.add_task(title, total=total_ps, rate=0.0)
            bars.update(task, completed=done_ps)
            yield lambda simulated_ps: bars.update(
                task, completed=simulated_ps, rate=speed_ns_per_day(simulated_ps)
            )
        return

    shown = int(LINES_IN_LOG * done_ps / total_ps) if done_ps else 0

    def log(simulated_ps: float) -> None:
        nonlocal shown
        part = int(LINES_IN_LOG * simulated_ps / total_ps)
        if part > shown:
            shown = part
            part_left = (total_ps - simulated_ps) / (simulated_ps - done_ps)
            left = (time.monotonic() - started) * part_left
            print(
                f"{title}: {simulated_ps:.1f} of {total_ps:.1f} ps, "
                f"{speed_ns_per_day(simulated_ps):.1f} ns/day, {left:.0f} s left",
                file=sys.stderr,
                flush=True,
            )

    yield log
