"""Does a measured number agree with a predicted one? From both intervals, at 95 %."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, isnan
from typing import Literal

from scipy import stats

Word = Literal["agree", "disagree", "undecided"]

CONFIDENCE = 0.95
# The constants of the paper are off by 1.4 or more where they are off (extension, by structure):
# an interval wider than half of that could not tell such a rod from one that is right.
WIDEST = 0.2
# The range of so few independent draws holds their distribution's median with less than 94 %.
FEWEST_STRUCTURES = 5


@dataclass(frozen=True)
class Band:
    """A number and the ends of its interval; those of an exact number are the number itself."""

    value: float
    low: float
    high: float

    @classmethod
    def of(cls, value: float, low: float = float("nan"), high: float = float("nan")) -> Band:
        """Return the band of a number whose interval may be missing."""
        return cls(value, value if isnan(low) else low, value if isnan(high) else high)

    def over(self, other: Band) -> Band:
        """Return the ratio of two positive independent numbers, intervals added in quadrature."""
        ratio = self.value / other.value
        below = hypot(1 - self.low / self.value, 1 - other.value / other.high)
        rise = other.value / other.low - 1 if other.low > 0 else inf
        above = hypot(self.high / self.value - 1, rise)
        return Band(ratio, ratio * max(1 - below, 0.0), ratio * (1 + above))


@dataclass(frozen=True)
class Judgement:
    """The word, and why it is no more than that."""

    word: Word
    why: str = ""


def judge(ratio: Band, doubt: str = "") -> Judgement:
    """Judge the ratio of measured to predicted; `doubt` says why the measurement is not sound.

    Agree: the interval holds 1 and is narrower than ± 20 %. Disagree: it does not hold 1.
    Undecided: it holds 1 but is wider, or the fit behind it is of the wrong class.
    """
    if doubt:
        return Judgement("undecided", doubt)
    if not ratio.low <= 1 <= ratio.high:
        return Judgement("disagree")
    if max(ratio.high - ratio.value, ratio.value - ratio.low) > WIDEST:
        return Judgement("undecided", f"interval wider than ± {WIDEST:.0%}")
    return Judgement("agree")


def judge_structures(ratios: list[float], doubt: str = "", kind: str = "structures") -> Judgement:
    """Judge several structures' ratios of measured to predicted by their range.

    Of n independent draws the range holds the median of their distribution with 1 - 2/2^n, 94 % for
    five: fewer decide nothing.
    """
    if len(ratios) < FEWEST_STRUCTURES:
        return Judgement("undecided", f"only {len(ratios)} {kind}")
    return judge(range_of(ratios), doubt)


def range_of(values: list[float]) -> Band:
    """Return mean, smallest and largest."""
    return Band(sum(values) / len(values), min(values), max(values))


def largest_rate(alarms: int, trials: int) -> float:
    """Return the rate of false alarms that this many in so many trials exclude above, at 95 %.

    Clopper & Pearson (1934), Biometrika 26, 404, one-sided.
    """
    if alarms == trials:
        return 1.0
    return float(stats.beta.ppf(CONFIDENCE, alarms + 1, trials - alarms))
