"""Run a case and hold what is found against what was declared."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from importlib import import_module

from pydantic import BaseModel, ValidationError

from dnawaves.errors import InputError, SimulationError
from dnawaves.stability.case import Case, Found


class Row(BaseModel, frozen=True):
    """One line of the table; `value` is None where no number was found."""

    case: str
    group: str
    does: str
    expected: str
    found: str
    quantity: str
    low: float
    high: float
    value: float | None
    verdict: str
    reason: str
    remark: str
    seconds: float


def judge(name: str, case: Case) -> Row:
    """Run a case; pass where outcome and number are as declared.

    An error that the library means to raise is an outcome; any other is a crash and is not caught.
    """
    module, function = case.run.split(".")
    run: Callable[..., Found] = getattr(import_module(f"{__package__}.{module}"), function)
    # Processor time: what else the machine does must not show.
    started = time.process_time()
    try:
        found = run(**case.settings)
    except SimulationError as error:
        found = Found("explodes", math.nan, str(error))
    except InputError as error:
        found = Found("refused", math.nan, str(error))
    seconds = time.process_time() - started
    low, high = case.bound
    passed = found.outcome == case.expected and low <= found.value <= high
    return Row(
        case=name,
        group=case.group,
        does=case.does,
        expected=case.expected,
        found=found.outcome,
        quantity=case.quantity,
        low=low,
        high=high,
        value=found.value if math.isfinite(found.value) else None,
        verdict="pass" if passed else "fail",
        reason=" ".join(case.reason.split()),
        remark=" ".join(found.remark.split()),
        seconds=round(seconds, 2),
    )


def stopped(run: Callable[[], object], *named: str) -> Found:
    """Return how `run` stops, and how many of the patterns `named` its message holds.

    Where it does not stop the outcome is 'holds'.
    """
    try:
        run()
    except SimulationError as error:
        return Found("explodes", _matches(named, str(error)), str(error))
    except InputError as error:
        return Found("refused", _matches(named, str(error)), str(error))
    except ValidationError as error:
        message = "; ".join(
            f"{'.'.join(map(str, one['loc']))}: {one['msg']}, found {one['input']}"
            for one in error.errors()
        )
        return Found("refused", _matches(named, message), message)
    return Found("holds", 0.0, "it was neither refused nor stopped")


def _matches(patterns: tuple[str, ...], message: str) -> float:
    return float(sum(re.search(pattern, message) is not None for pattern in patterns))
