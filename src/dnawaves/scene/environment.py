"""The environment of a duplex: its forces, and the way to the minimum that scenes start from."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt, model_validator

from dnawaves.scene.contradictions import contradictions
from dnawaves.scene.model import Model

# What is left out of an environment, without solvent and with implicit solvent.
IN_VACUUM = {"counterion_fraction": 1.0, "cutoff_nm": 0.9, "switch_nm": 0.8}
IN_IMPLICIT_SOLVENT = {"counterion_fraction": 0.0, "cutoff_nm": None, "switch_nm": None}


class Start(Model):
    """A bent or overtwisted start, as a bound protein leaves it."""

    first: PositiveInt = Field(description="base pair from which on the duplex is turned, from 1")
    last: PositiveInt = Field(description="base pair that is turned by the whole angle")
    twist_deg: Annotated[float, Field(ge=-360, le=360)] = Field(
        0.0, description="turn of `last` against `first` about the helix axis, beyond the built one"
    )
    bend_deg: Annotated[float, Field(ge=-180, le=180)] = Field(
        0.0, description="turn of `last` against `first` about a direction across the helix axis"
    )
    direction_deg: Annotated[float, Field(ge=-360, le=360)] = Field(
        0.0,
        description="that direction's angle from the long axis of base pair 1, about the helix "
        "axis; bends in the plane normal to it",
    )

    @model_validator(mode="after")
    def _turned(self) -> Self:
        if self.last <= self.first:
            raise ValueError(f"last must be above first ({self.first}), found {self.last}")
        if self.twist_deg == self.bend_deg == 0:
            raise ValueError("give twist_deg, bend_deg or both, found neither")
        return self


class Relaxation(Model):
    """The way from the built duplex to the minimum that every scene of the system starts from."""

    start: Start | None = Field(
        None, description="bent or overtwisted before the anneal; left out: as built"
    )
    anneal_temperature_K: Annotated[float, Field(ge=0, le=400)] = Field(
        150.0, description="temperature at which the anneal starts; it falls linearly to zero"
    )
    anneal_ps: Annotated[float, Field(ge=0, le=10_000)] = Field(
        12.0, description="length of the anneal; another length or seed finds another structure"
    )
    seed: NonNegativeInt = Field(1, description="seed of the anneal's velocities and noise")
    force_tolerance_kJ_per_mol_nm: PositiveFloat = Field(
        1e-4, description="root-mean-square force at which the structure counts as a minimum"
    )
    cycles: Annotated[int, Field(ge=1, le=1000)] = Field(
        30, description="Hessians after which the search for a minimum is given up"
    )


class Environment(Model):
    """What surrounds the duplex and by which forces its atoms act on each other."""

    force_field: Literal["OL21", "OL15", "bsc1"] = Field(
        "OL21", description="Amber DNA force field"
    )
    # Not GBn2: its neck term jumps where it is cut off, so that no minimum can be found to the
    # tolerance and differences of forces across the jump are no Hessian.
    solvent: Literal["none", "OBC2"] = Field(
        "none", description="none, or an implicit solvent, with full charges and without cutoff"
    )
    salt_M: Annotated[float, Field(ge=0, le=5)] = Field(
        0.0, description="1:1 salt of the implicit solvent, which screens as at 300 K"
    )
    surface_area: bool = Field(
        False, description="also the implicit solvent's nonpolar term, by surface area"
    )
    counterion_fraction: Annotated[float, Field(ge=0, le=1)] | None = Field(
        None,
        description="condensed counterion charge per phosphate, spread over P, OP1 and OP2; left "
        "out: 1 without solvent, 0 in implicit solvent",
    )
    cutoff_nm: Annotated[float, Field(ge=0.8, le=3.0)] | None = Field(
        None,
        description="where the reaction field's force has come to zero; left out: 0.9 without "
        "solvent, no cutoff in implicit solvent",
    )
    switch_nm: Annotated[float, Field(ge=0.5, le=3.0)] | None = Field(
        None,
        description="where the Lennard-Jones potential starts to be switched off; left out: 0.8 "
        "without solvent",
    )
    relaxation: Relaxation = Relaxation()

    @model_validator(mode="before")
    @classmethod
    def _fill_in(cls, given: Any) -> Any:
        """Put in what is left out, so that an environment compares by what it means."""
        if not isinstance(given, dict):
            return given
        defaults = IN_VACUUM if given.get("solvent", "none") == "none" else IN_IMPLICIT_SOLVENT
        left_out = {name: its for name, its in defaults.items() if given.get(name) is None}
        return {**given, **left_out}

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        found = contradictions(
            solvent=self.solvent,
            counterion_fraction=self.counterion_fraction or 0.0,
            salt_M=self.salt_M,
            surface_area=self.surface_area,
            cutoff_nm=self.cutoff_nm,
            switch_nm=self.switch_nm,
        )
        if found:
            raise ValueError("; ".join(map(str, found)))
        if self.cutoff_nm and self.switch_nm and self.switch_nm >= self.cutoff_nm:
            raise ValueError(
                f"switch_nm must be below cutoff_nm ({self.cutoff_nm:g}), found {self.switch_nm:g}"
            )
        return self
