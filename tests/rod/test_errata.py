"""The points about the paper carry the numbers that were derived by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from dnawaves.rod.errata import errata_markdown

THEORY = Path(__file__).parents[2] / "docs" / "theory.md"


@pytest.fixture(scope="module")
def table() -> str:
    return errata_markdown()


@pytest.mark.parametrize(
    "number",
    [
        "226.5 GHz",  # cut-off Γ0 sqrt(C/I), with the paper's C and I
        "0.924 rad/Å",  # edge of the zone, pi/3.4 Å
        "0.283 rad/Å",  # sqrt(rho/I)
        "5.79 and twist at 3.58 Å/ps",  # 8.185/sqrt 2 and 5.056/sqrt 2
        "65 and 50 nm",  # D/kT and D3/kT at 300 K
        "659 Da per base pair",  # 3.22e-15 kg/m times 3.4 Å
        "5.79 instead of 8.19 Å/ps",  # 8.19/sqrt 2
        "up to 0.9999 of the size",  # eq. 46 as printed, on the branches k + Ω₀ and k - Ω₀
        "by less than 1e-11",  # eq. 46 corrected: round-off, 1e-12
        "differ by less than 1e-13",  # the gauge: round-off, 1e-15
        "k = 0.077 rad/Å",  # 2 pi/(24 x 3.4 Å)
    ],
)
def test_numbers_of_the_paper_come_out(table: str, number: str) -> None:
    assert number in table


def test_the_documentation_holds_the_table_as_computed(table: str) -> None:
    assert table in THEORY.read_text(encoding="utf-8"), (
        "docs/theory.md: replace the table of errata by what `dnawaves theory --errata` prints"
    )
