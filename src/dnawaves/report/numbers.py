"""Numbers as a reader wants them: three significant digits, never a bare NaN."""

from __future__ import annotations

import math
from typing import SupportsFloat

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


def listed(words: list[str]) -> str:
    """Return 'a, b and c'."""
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else "".join(words)


def counted(number: int, noun: str) -> str:
    """Return '1 fit' or '2 fits'."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
