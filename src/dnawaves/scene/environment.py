"""The environment of a duplex: its forces, and the way to the minimum that scenes start from."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, PositiveFloat, PositiveInt, model_validator

from dnawaves.errors import InputError
from dnawaves.scene.contradictions import EXPLICIT, Solvent, contradictions
from dnawaves.scene.model import Model, Seed

# What is left out of an environment, without solvent, in implicit and in explicit solvent.
IN_VACUUM = {"counterion_fraction": 1.0, "cutoff_nm": 0.9, "switch_nm": 0.8}
IN_IMPLICIT_SOLVENT = {"counterion_fraction": 0.0, "cutoff_nm": None, "switch_nm": None}
IN_WATER = {"counterion_fraction": 0.0, "cutoff_nm": 0.9, "switch_nm": 0.8}


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
    seed: Seed = Field(1, description="seed of the anneal's velocities and noise")
    force_tolerance_kJ_per_mol_nm: PositiveFloat = Field(
        1e-4, description="root-mean-square force at which the structure counts as a minimum"
    )
    cycles: Annotated[int, Field(ge=1, le=1000)] = Field(
        30, description="Hessians after which the search for a minimum is given up"
    )


class Water(Model):
    """The box of explicit water around the duplex."""

    padding_nm: Annotated[float, Field(ge=0.3, le=5)] = Field(
        1.0, description="least distance from the duplex to the faces of the box"
    )
    cation: Literal["Na+", "K+"] = Field("Na+", description="neutralises the duplex; with salt too")
    seed: Seed = Field(1, description="seed of the places of the ions")


class Equilibration(Model):
    """The way from the built duplex to the snapshots that thermal scenes start from."""

    duration_ps: Annotated[float, Field(gt=0, le=1e6)] = Field(
        20.0, description="length before the first snapshot, ends free, with a thermostat"
    )
    timestep_fs: Annotated[float, Field(gt=0, le=4)] = Field(2.0, description="timestep")
    friction_per_ps: Annotated[float, Field(gt=0, le=100)] = Field(
        1.0, description="friction of the thermostat"
    )
    pressure_bar: Annotated[float, Field(gt=0, le=1000)] | None = Field(
        None,
        description="pressure of a barostat in the first half of the time before the first "
        "snapshot; left out: 1 in explicit water; null: none",
    )
    snapshots: Annotated[int, Field(ge=1, le=1000)] = Field(4, description="number of snapshots")
    spacing_ps: Annotated[float, Field(gt=0, le=1e5)] = Field(
        2.0, description="time between snapshots"
    )
    seed: Seed = Field(1, description="seed of the velocities and the noise")


class Environment(Model):
    """What surrounds the duplex and by which forces its atoms act on each other."""

    force_field: Literal["OL21", "OL15", "bsc1"] = Field(
        "OL21", description="Amber DNA force field"
    )
    temperature_K: Annotated[float, Field(ge=0, le=500)] = Field(
        0.0,
        description="0: scenes start from the relaxed minimum; above: from equilibrated snapshots",
    )
    # Not GBn2 at T = 0: its neck term jumps where it is cut off, so that no minimum can be found to
    # the tolerance and differences of forces across the jump are no Hessian.
    solvent: Solvent = Field(
        "none",
        description="none, an implicit solvent (OBC2, GBn2: full charges, no cutoff) or explicit "
        "water (OPC, TIP3P); GBn2 and explicit water only above 0 K",
    )
    salt_M: Annotated[float, Field(ge=0, le=5)] = Field(
        0.0,
        description="1:1 salt: of an implicit solvent, which screens as at 300 K, or as ions "
        "besides those that neutralise",
    )
    water: Water | None = Field(None, description="explicit water only; left out: its defaults")
    constraints: Literal["none", "hbonds"] = Field(
        "none", description="hbonds: rigid bonds to hydrogen; only above 0 K"
    )
    hydrogen_mass_Da: Annotated[float, Field(gt=1, le=4)] | None = Field(
        None, description="mass of the duplex's hydrogens, taken from their heavy atoms"
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
    relaxation: Relaxation | None = Field(
        None, description="at 0 K only; left out: the defaults of its keys"
    )
    equilibration: Equilibration | None = Field(
        None, description="above 0 K only; left out: the defaults of its keys"
    )

    @model_validator(mode="before")
    @classmethod
    def _fill_in(cls, given: Any) -> Any:
        """Put in what is left out, so that an environment compares by what it means."""
        if not isinstance(given, dict):
            return given
        solvent = given.get("solvent", "none")
        defaults: dict[str, Any] = dict(
            IN_VACUUM
            if solvent == "none"
            else IN_WATER
            if solvent in EXPLICIT
            else IN_IMPLICIT_SOLVENT
        )
        if solvent in EXPLICIT:
            defaults["water"] = {}
        defaults["equilibration" if given.get("temperature_K") else "relaxation"] = {}
        left_out = {name: its for name, its in defaults.items() if given.get(name) is None}
        filled = {**given, **left_out}
        steady = filled.get("equilibration")
        if isinstance(steady, Equilibration):
            steady = steady.model_dump(exclude_unset=True)
        if solvent in EXPLICIT and isinstance(steady, dict):
            # Water is put in some percent too thin.
            filled["equilibration"] = {"pressure_bar": 1.0, **steady}
        return filled

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        found = contradictions(
            solvent=self.solvent,
            counterion_fraction=self.counterion_fraction or 0.0,
            salt_M=self.salt_M,
            surface_area=self.surface_area,
            cutoff_nm=self.cutoff_nm,
            switch_nm=self.switch_nm,
            water=self.water is not None,
            barostat=bool(self.equilibration and self.equilibration.pressure_bar),
            equilibration=self.equilibration is not None,
            constraints=self.constraints,
            temperature_K=self.temperature_K,
            relaxation=self.relaxation is not None,
        )
        if found:
            raise ValueError("; ".join(map(str, found)))
        if self.cutoff_nm and self.switch_nm and self.switch_nm >= self.cutoff_nm:
            raise ValueError(
                f"switch_nm must be below cutoff_nm ({self.cutoff_nm:g}), found {self.switch_nm:g}"
            )
        return self

    @property
    def to_minimum(self) -> Relaxation:
        """The way to the minimum; raises `InputError` where scenes do not start from one."""
        if self.relaxation is None:
            raise InputError(f"temperature_K {self.temperature_K:g}: found no minimum; allowed: 0")
        return self.relaxation

    @property
    def to_snapshots(self) -> Equilibration:
        """The way to the snapshots; raises `InputError` where scenes do not start from them."""
        if self.equilibration is None:
            raise InputError("temperature_K 0: found no equilibration; allowed: above 0")
        return self.equilibration
