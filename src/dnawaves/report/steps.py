"""The step that writes the report, from files to file."""

from __future__ import annotations

from pathlib import Path

from dnawaves.files import write_text
from dnawaves.report.gather import gather
from dnawaves.report.page import render


def report_step(config: Path, results: Path, output: Path) -> None:
    """Write the report on every scene of a configuration as one HTML page.

    Raises
    ------
    InputError
        When results of a scene are not there.
    """
    write_text(output, render(gather(config, results)))
