"""What a study of accuracy may declare: systems, cases, and lines of settings."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, PositiveInt, field_validator, model_validator

from dnawaves.scene.environment import Environment
from dnawaves.scene.excitations import Kick, StandingWave
from dnawaves.scene.model import Model, Name
from dnawaves.scene.models import Ends
from dnawaves.scene.sequence import check_sequence

# Times closer than this are the same: what YAML's decimals leave.
SAME_TIME_FS = 1e-6
SEVERAL_FORCES = "multiple timestep"
LANGEVIN = "Langevin middle"
GPU_PLATFORMS = ("CUDA", "HIP", "OpenCL")


def multiple_of(long_fs: float, short_fs: float) -> bool:
    """Return whether one time is a whole multiple of another."""
    ratio = long_fs / short_fs
    return round(ratio) >= 1 and abs(ratio - round(ratio)) < SAME_TIME_FS / short_fs


class StudySystem(Model):
    """A duplex in an environment, relaxed once for all settings that start from it."""

    sequence: str = Field(description="strand I from 5' to 3'")
    environment: Environment = Environment()

    @field_validator("sequence")
    @classmethod
    def _known_bases(cls, value: str) -> str:
        check_sequence(value)
        return value


class Case(Model):
    """One wave in one system: what is asked of every setting."""

    system: Name = Field(description="name of a system of this file")
    ends: Ends = Ends()
    excitation: Annotated[Kick | StandingWave, Field(discriminator="kind")]
    duration_ps: Annotated[float, Field(gt=0, le=1000)] = Field(description="length of the record")
    converged: bool = Field(
        False, description="also find the converged answer of a kick of this size, not only of none"
    )


class Numerics(Model):
    """How a wave is computed; left out, as the shipped scenes do it."""

    platform: Literal["CPU", "Reference", "CUDA", "HIP", "OpenCL"] = Field(
        "CPU", description="OpenMM's platform; Reference computes in double precision"
    )
    precision: Literal["single", "mixed", "double"] | None = Field(
        None, description="of a GPU platform"
    )
    integrator: Literal["leapfrog", "velocity Verlet", "multiple timestep", "Langevin middle"] = (
        "leapfrog"
    )
    timestep_fs: Annotated[float, Field(gt=0, le=10)] = 2.0
    inner_steps: Annotated[int, Field(ge=1, le=20)] = Field(
        1, description="of a multiple timestep: steps of the bonded forces in each timestep"
    )
    friction_per_ps: Annotated[float, Field(ge=0, le=100)] = 0.0
    constraints: Literal["none", "hbonds"] = "none"
    hydrogen_mass_Da: Annotated[float, Field(gt=1, le=4)] | None = None
    cutoff: Literal["smooth", "unswitched", "jump"] = Field(
        "smooth",
        description="unswitched: Lennard-Jones forces end abruptly; jump: Coulomb forces too, by "
        "the reaction field of water instead of a conductor",
    )
    scale: Annotated[float, Field(gt=0, le=1000)] = Field(1.0, description="multiple of the kick")
    interval_fs: Annotated[float, Field(gt=0, le=1e4)] = Field(
        60.0, description="time between recorded frames"
    )
    replicas: PositiveInt | None = Field(
        None,
        description="no simulation, but so many single runs of the linearised duplex at "
        "temperature_K, averaged",
    )
    temperature_K: Annotated[float, Field(gt=0, le=400)] = Field(
        300.0, description="of replicas; everything else starts at T = 0"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not multiple_of(self.interval_fs, self.timestep_fs):
            raise ValueError(
                f"interval_fs must be a multiple of timestep_fs ({self.timestep_fs:g}), "
                f"found {self.interval_fs:g}"
            )
        for name, value, blank, only in (
            ("inner_steps", self.inner_steps, 1, SEVERAL_FORCES),
            ("friction_per_ps", self.friction_per_ps, 0, LANGEVIN),
        ):
            if value != blank and self.integrator != only:
                raise ValueError(
                    f"{name} goes with integrator '{only}', found {value:g} with "
                    f"'{self.integrator}'"
                )
        if (self.precision is not None) != (self.platform in GPU_PLATFORMS):
            raise ValueError(
                f"precision goes with platform {', '.join(GPU_PLATFORMS)}, found "
                f"{self.precision} with {self.platform}"
            )
        return self

    @property
    def declarable(self) -> bool:
        """Whether a scene at T = 0 can ask for it: all but timestep, interval and kick is fixed."""
        free = {"timestep_fs", "scale", "interval_fs"}
        return self.model_dump(exclude=free) == Numerics().model_dump(exclude=free)


Value = float | str | None


class Line(Model):
    """Settings that differ in one thing: a line in the figures."""

    title: str = Field(min_length=1)
    table: Literal["settings", "models"] = Field(
        "settings",
        description="models: another molecule, judged by difference and cost, not by error",
    )
    slope: Literal["timestep", "replicas"] | None = Field(
        None, description="expected slope to be drawn: error as timestep², or as 1/√replicas"
    )
    case: Name | None = Field(None, description="left out: the study's own")
    settings: dict[str, Value] = Field({}, description="what all settings of the line share")
    vary: dict[str, tuple[Value, ...]] = Field(
        description="one field of the settings, or `case`, and its values; or several of the same "
        "length that vary together"
    )

    @model_validator(mode="after")
    def _varied(self) -> Self:
        fields = tuple(Numerics.model_fields)
        for where, names, allowed in (
            ("settings", self.settings, fields),
            ("vary", self.vary, (*fields, "case")),
        ):
            for name in names:
                if name not in allowed:
                    raise ValueError(f"{where}: found {name!r}; allowed: {', '.join(allowed)}")
        lengths = {len(values) for values in self.vary.values()}
        if len(lengths) != 1 or 0 in lengths:
            raise ValueError("vary: needs at least one value, and as many of each field")
        return self


class Truth(Model):
    """How the converged answers are found."""

    timesteps_fs: tuple[float, float] = Field(
        (0.5, 0.25),
        description="timesteps in double precision, the second half the first, from which "
        "Richardson's extrapolation gives the answer at no timestep",
    )
    interval_fs: float = Field(
        20.0, gt=0, description="time between points at which the linear answer is known"
    )

    @model_validator(mode="after")
    def _halved(self) -> Self:
        coarse, fine = self.timesteps_fs
        if not 0 < fine == coarse / 2:
            raise ValueError(
                f"timesteps_fs must be a timestep and its half, found {coarse:g} and {fine:g}"
            )
        return self


class Study(Model):
    """A study: systems, the waves in them, and lines of settings."""

    systems: dict[Name, StudySystem] = Field(min_length=1)
    cases: dict[Name, Case] = Field(min_length=1)
    case: Name = Field(description="the case of lines that name none")
    default: Numerics = Field(Numerics(), description="what every setting's time is held against")
    truth: Truth = Truth()
    lines: dict[Name, Line] = Field(min_length=1)
    costs: tuple[Name, ...] = Field(
        (), description="systems of which each effect's time per step is measured as well"
    )

    @model_validator(mode="after")
    def _names(self) -> Self:
        for name, case in self.cases.items():
            if case.system not in self.systems:
                raise ValueError(
                    f"case '{name}': system: found {case.system!r}; "
                    f"allowed: {', '.join(self.systems)}"
                )
        for system in self.costs:
            if system not in self.systems:
                raise ValueError(f"costs: found {system!r}; allowed: {', '.join(self.systems)}")
        named = [("case", self.case)]
        for name, line in self.lines.items():
            chosen = [line.case] if line.case else []
            chosen += [str(value) for value in line.vary.get("case", ())]
            named += [(f"line '{name}': case", value) for value in chosen]
        for where, value in named:
            if value not in self.cases:
                raise ValueError(f"{where}: found {value!r}; allowed: {', '.join(self.cases)}")
        return self
