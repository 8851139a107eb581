"""The studies beside the scenes, where they were run: accuracy, and hard cases."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from dnawaves.accuracy.table import read_csv, succeeded
from dnawaves.report.accuracy_page import TITLE, illustrations, machine
from dnawaves.report.numbers import counted
from dnawaves.report.stability_page import summary
from dnawaves.report.style import Illustration
from dnawaves.scene.models import SceneSpec
from dnawaves.stability.table import read_table

ACCURACY, STABILITY = Path("accuracy/settings.csv"), Path("stability/table.csv")
SHOWN = 2


@dataclass(frozen=True)
class Study:
    """A study: its name, what came out, where its own page is, its main figures."""

    title: str
    said: str
    page: str
    illustrations: list[Illustration] = field(default_factory=list)


def studies(results: Path, scenes: dict[str, SceneSpec]) -> list[Study]:
    """Return both studies; of one whose table is not in the results, how to run it."""
    return [_accuracy(results, scenes), _stability(results)]


def _accuracy(results: Path, scenes: dict[str, SceneSpec]) -> Study:
    if not (results / ACCURACY).is_file():
        return Study(TITLE, "Not run; `snakemake accuracy` does.", "")
    settings = read_csv(results / ACCURACY)
    said = (
        f"{counted(len(settings), 'setting')}, of which {len(succeeded(settings))} ran, on "
        f"{machine(settings)}."
    )
    shown = illustrations(settings, scenes)[:SHOWN]
    return Study(TITLE, said, _page(results, ACCURACY), shown)


def _stability(results: Path) -> Study:
    title = "Hard cases"
    if not (results / STABILITY).is_file():
        return Study(title, "Not run; `snakemake stability` does.", "")
    return Study(title, summary(read_table(results / STABILITY)), _page(results, STABILITY))


def _page(results: Path, table: Path) -> str:
    page = table.with_name("report.html")
    return page.as_posix() if (results / page).is_file() else ""
