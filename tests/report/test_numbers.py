"""Numbers are rounded to what they are worth, and a missing one is a dash."""

from __future__ import annotations

import pytest

from dnawaves.comparison.judge import Band
from dnawaves.report.numbers import band, between, counted, digits, listed, percent


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (16.5339, "16.5"),
        (8.19028, "8.19"),
        (0.042799, "0.0428"),
        (1234.0, "1230"),
        (9.996, "10.0"),
        (-9.771, "−9.77"),
        (0.0, "0"),
        (2.303e-5, "2.30\u00a0×\u00a010⁻⁵"),
        (-18798313.0, "−1.88\u00a0×\u00a010⁷"),
        (None, "–"),
        (float("nan"), "–"),
        (float("inf"), "–"),
    ],
)
def test_three_digits(value, text):
    assert digits(value) == text


def test_shares_and_ranges():
    assert percent(0.0291) == "2.9\u00a0%"
    assert percent(float("nan")) == "–"
    assert between(15.333, 16.904) == "15.3–16.9"
    assert between(None, 1.0) == "–"


def test_an_interval_without_an_end_says_so():
    assert band(Band(9.0, 8.2, float("inf"))) == "9.00 (8.20–∞)"
    assert band(Band(9.0, 9.0, 9.0)) == "9.00"


def test_words():
    assert listed(["1", "0.5", "0.1"]) == "1, 0.5 and 0.1"
    assert listed(["1"]) == "1"
    assert counted(1, "fit") == "1 fit"
    assert counted(3, "fit") == "3 fits"
