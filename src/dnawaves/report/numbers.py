"""Numbers as a reader wants them: three significant digits, never a bare NaN."""

from __future__ import annotations

import math
from typing import SupportsFloat

from dnawaves.comparison.judge import Band

BLANK = "–"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def missing(value: SupportsFloat | None) -> bool:
    """Return whether there is no number."""
    return value is None or not math.isfinite(float(value))


def digits(value: SupportsFloat | None, significant: int = 3) -> str:
    """Return a number with so many significant digits, or a dash where there is none."""
    if value is None or not math.isfinite(number := float(value)):
        return BLANK
    if number == 0:
        return "0"
    # Rounding first: 9.996 has another magnitude than what is printed of it.
    mantissa, exponent = f"{number:.{significant - 1}e}".split("e")
    magnitude = int(exponent)
    if not -4 <= magnitude < 6:
        power = str(magnitude).translate(SUPERSCRIPTS)
        return f"{mantissa}\u00a0×\u00a010{power}".replace("-", "−")
    decimals = max(0, significant - 1 - magnitude)
    return f"{float(f'{mantissa}e{magnitude}'):.{decimals}f}".replace("-", "−")


def percent(share: SupportsFloat | None) -> str:
    """Return a share in per cent, two significant digits."""
    return BLANK if share is None or missing(share) else f"{digits(100 * float(share), 2)}\u00a0%"


def between(low: SupportsFloat | None, high: SupportsFloat | None) -> str:
    """Return 'low–high' with three significant digits."""
    return BLANK if missing(low) or missing(high) else f"{digits(low)}–{digits(high)}"


def band(number: Band) -> str:
    """Return 'value (low–high)' to the digit that the interval leaves standing.

    Two digits of the interval's half-width, and not more than three of the number.
    """
    open_ended = number.high == math.inf
    half = number.value - number.low if open_ended else (number.high - number.low) / 2
    if missing(half) or half == 0:
        return digits(number.value)
    # 1.234 ± 0.12 is 1.23: the digit below the second of the half-width is noise.
    largest = max(abs(value) for value in (number.value, number.high) if math.isfinite(value))
    place = min(2 - math.ceil(math.log10(half)), 2 - math.floor(math.log10(largest)))
    parts = [_rounded(value, place) for value in (number.value, number.low, number.high)]
    return f"{parts[0]} ({parts[1]}–{parts[2]})"


def _rounded(value: float, place: int) -> str:
    if not math.isfinite(value):
        return "∞"
    return f"{round(value, place):.{max(0, place)}f}".replace("-", "−")


def listed(words: list[str]) -> str:
    """Return 'a, b and c'."""
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


def counted(number: int, noun: str) -> str:
    """Return '1 fit' or '2 fits'."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
