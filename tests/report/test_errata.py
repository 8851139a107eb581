"""The points about the paper carry the numbers that were checked by hand."""

from __future__ import annotations

from dnawaves.report.errata import errata


def test_numbers_of_the_paper_come_out():
    text = " ".join(errata(24, 3.4))
    for number in (
        "226 GHz",  # cut-off sqrt(C/I), 0.2265 THz
        "0.924 rad/Å",  # edge of the zone, pi/3.4 Å
        "0.283 rad/Å",  # sqrt(rho/I)
        "5.79 and twist at 3.58 Å/ps",  # with a cylinder's inertia
        "65 and 50 nm",  # D/kT and D3/kT at 300 K
        "659 Da per base pair",
        "to 5.79 Å/ps",  # 8.19/sqrt 2
    ):
        assert number in text
