"""The words agree, disagree and undecided, on numbers with a known answer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dnawaves.comparison.judge import (
    Band,
    judge,
    judge_structures,
    largest_rate,
    range_of,
)


@pytest.mark.parametrize(
    ("measured", "predicted", "word"),
    [
        (Band(16.4, 15.0, 17.0), Band.of(8.19), "disagree"),
        (Band(8.3, 8.0, 8.6), Band.of(8.19), "agree"),
        # Neither interval holds the other's value, but the difference is no larger than both.
        (Band(10.0, 9.5, 10.5), Band(10.6, 10.2, 11.0), "agree"),
        (Band(10.0, 9.9, 10.1), Band(10.6, 10.5, 10.7), "disagree"),
        # Holds 1, but would hold a rod that is wrong by a factor of 1.4 as well.
        (Band(10.0, 6.0, 14.0), Band.of(9.0), "undecided"),
        # A wide interval may still exclude a prediction.
        (Band(20.0, 14.0, 26.0), Band.of(8.19), "disagree"),
        # An exact number against another.
        (Band.of(15.5), Band.of(15.5), "agree"),
        (Band.of(15.5), Band.of(14.6), "disagree"),
    ],
)
def test_the_word_follows_from_both_intervals(measured: Band, predicted: Band, word: str) -> None:
    assert judge(measured.over(predicted)).word == word


def test_a_fit_of_the_wrong_class_decides_nothing_whatever_its_interval() -> None:
    for ratio in (Band(1.0, 0.99, 1.01), Band(2.0, 1.99, 2.01)):
        judgement = judge(ratio, "wrong model class")
        assert (judgement.word, judgement.why) == ("undecided", "wrong model class")


def test_the_words_are_right_as_often_as_they_claim() -> None:
    """Measured and predicted are drawn about the same truth: 95 % of the pairs agree."""
    rng, sd, wrong = np.random.default_rng(3), (0.02, 0.04), 0
    draws = 2000
    for _ in range(draws):
        bands = [
            Band(value, value - 1.96 * one * 10, value + 1.96 * one * 10)
            for value, one in zip(10 + 10 * np.array(sd) * rng.standard_normal(2), sd, strict=True)
        ]
        wrong += judge(bands[0].over(bands[1])).word == "disagree"
    # 100 of 2000 with a standard deviation of 10; a ratio is not quite normal.
    assert wrong == pytest.approx(100, abs=30)


@given(
    value=st.floats(1, 100),
    below=st.floats(0.001, 0.5),
    above=st.floats(0.001, 0.5),
    scale=st.floats(0.1, 10),
)
def test_the_word_does_not_depend_on_the_unit(
    value: float, below: float, above: float, scale: float
) -> None:
    measured = Band(value, value * (1 - below), value * (1 + above))
    scaled = Band(*(scale * part for part in (measured.value, measured.low, measured.high)))
    first, second = measured.over(Band.of(11.0)), scaled.over(Band.of(11.0 * scale))
    assert first.value == pytest.approx(second.value)
    # Where the limit itself is hit, rounding may decide.
    if min(abs(first.low - 1), abs(first.high - 1), abs(first.high - first.value - 0.2)) > 1e-9:
        assert judge(first).word == judge(second).word


def test_a_prediction_that_may_vanish_excludes_nothing_above() -> None:
    assert Band(1.0, 0.9, 1.1).over(Band(1.0, -0.5, 2.5)).high == math.inf


def test_fewer_than_five_structures_decide_nothing() -> None:
    assert judge_structures([2.0, 2.1, 1.9, 2.2]).word == "undecided"
    assert judge_structures([2.0, 2.1, 1.9, 2.2, 2.0]).word == "disagree"
    assert judge_structures([0.95, 1.1, 1.0, 0.9, 1.05]).word == "agree"
    # One in five outside does not make the others wrong, but they scatter by a factor of two.
    assert judge_structures([0.95, 1.1, 1.0, 0.9, 1.9]).word == "undecided"
    assert judge_structures([1.0] * 5, "poor fit").word == "undecided"


def test_the_range_of_five_holds_the_median_as_often_as_is_said() -> None:
    draws = np.random.default_rng(1).lognormal(0.7, 0.3, (4000, 5))
    held = [range_of(list(one)).low <= np.exp(0.7) <= range_of(list(one)).high for one in draws]
    # 1 - 2/32; 0.4 % is the standard deviation of 4000 draws.
    assert np.mean(held) == pytest.approx(1 - 2 / 32, abs=0.015)


def test_no_alarm_in_few_trials_says_little() -> None:
    # The rule of three: 1 - 0.05^(1/n), about 3/n.
    assert largest_rate(0, 4) == pytest.approx(1 - 0.05**0.25)
    assert largest_rate(0, 300) == pytest.approx(3 / 300, rel=0.01)
    assert largest_rate(4, 4) == 1.0
