"""What is expected of each hard case, as declared in `cases.yaml` before anything runs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Annotated, Any, Literal, Self

import yaml
from pydantic import Field, model_validator

from dnawaves.errors import InputError
from dnawaves.scene.model import Model

# holds: works, and its number lies in the bound. explodes: stopped, with a message that names the
# step or the atoms. refused: not begun, with a message that names why. flagged: an answer that says
# itself that it must not be trusted.
Outcome = Literal["holds", "explodes", "refused", "flagged"]
# What one process can do in a run of the reduced suite, besides starting up.
REDUCED_SECONDS = 2.0


class Case(Model):
    """A hard case: what is done, what must come out, and why that is the bound."""

    group: str = Field(description="heading that it stands under")
    does: str = Field(description="what is done")
    run: Annotated[str, Field(pattern=r"^[a-z_]+\.[a-z_]+$")] = Field(
        description="module of this package and function"
    )
    settings: dict[str, Any] = Field({}, description="the function's arguments")
    expected: Outcome
    quantity: str = Field(description="the number that is found, with its unit")
    bound: tuple[float, float] = Field(description="lowest and highest allowed number")
    reason: str = Field(min_length=20, description="why that is the bound")
    seconds: Annotated[float, Field(gt=0, le=300)] = Field(
        description="on one core, without the start of the process"
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.bound[0] > self.bound[1]:
            raise ValueError(f"bound: found {list(self.bound)}; allowed: the lower one first")
        return self

    @property
    def reduced(self) -> bool:
        """Whether it is part of the reduced suite."""
        return self.seconds <= REDUCED_SECONDS


@dataclass(frozen=True)
class Found:
    """What a case came to: its outcome, its number and, in words, what else there is to see."""

    outcome: Outcome
    value: float
    remark: str = ""


@cache
def cases() -> dict[str, Case]:
    """Return all cases by name, in the order in which they are declared."""
    text = resources.files(__package__).joinpath("cases.yaml").read_text(encoding="utf-8")
    return {name: Case.model_validate(content) for name, content in yaml.safe_load(text).items()}


def case_named(name: str) -> Case:
    """Return one case. Raises `InputError` where there is none of that name."""
    if name not in cases():
        raise InputError(f"stability: found {name!r}; allowed: {', '.join(cases())}")
    return cases()[name]
