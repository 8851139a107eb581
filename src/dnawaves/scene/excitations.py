"""What excites a duplex: kicks, pulses, periodic drives, static loads, nothing."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, PositiveFloat, PositiveInt, model_validator

from dnawaves.scene.model import Model, Name

Wave = Literal["extension", "twist", "bend", "shear"]
# Along and about the axis: each has one speed.
AXIAL_WAVES = ("extension", "twist")
# A pulse is centred this many widths after the start, where it has come up from zero.
PULSE_DELAY_WIDTHS = 5


def _distinct(numbers: tuple[float, ...]) -> tuple[float, ...]:
    if len({f"{number:g}" for number in numbers}) != len(numbers):
        raise ValueError(f"they must differ from each other, found {list(numbers)}")
    return numbers


# Each stands for a run of its own.
Several = Annotated[tuple[PositiveFloat, ...], Field(min_length=1), AfterValidator(_distinct)]
Mode = Annotated[int, Field(ge=1, le=20)]
SeveralModes = Annotated[tuple[Mode, ...], Field(min_length=1), AfterValidator(_distinct)]


class _Moved(Model):
    """A wave and how strongly it is excited; exactly the amplitude that fits the wave is given."""

    wave: Wave = Field(description="which of the rod's four waves")


class _Kicked(_Moved):
    velocity_A_per_ps: Annotated[float, Field(gt=0, le=20)] | None = Field(
        None, description="largest velocity put in (extension, shear)"
    )
    angular_velocity_rad_per_ps: Annotated[float, Field(gt=0, le=2)] | None = Field(
        None, description="largest angular velocity put in (twist, bend)"
    )
    scales: Several = Field(
        (1.0,), description="multiples of the kick that are run, each as a pair of opposite signs"
    )

    @model_validator(mode="after")
    def _one_amplitude(self) -> Self:
        _one_amplitude(
            self.wave,
            velocity_A_per_ps=self.velocity_A_per_ps,
            angular_velocity_rad_per_ps=self.angular_velocity_rad_per_ps,
        )
        return self

    @property
    def amplitude(self) -> float:
        """Largest velocity (Å/ps) or angular velocity (rad/ps) at scale 1."""
        return _given(self.velocity_A_per_ps, self.angular_velocity_rad_per_ps)


class _Forced(_Moved):
    force_pN: Annotated[float, Field(gt=0, le=5000)] | None = Field(
        None, description="largest total force (extension, shear)"
    )
    torque_pN_nm: Annotated[float, Field(gt=0, le=5000)] | None = Field(
        None, description="largest total torque (twist, bend)"
    )

    @model_validator(mode="after")
    def _one_amplitude(self) -> Self:
        _one_amplitude(self.wave, force_pN=self.force_pN, torque_pN_nm=self.torque_pN_nm)
        return self

    @property
    def amplitude(self) -> float:
        """Largest total force (pN) or torque (pN nm)."""
        return _given(self.force_pN, self.torque_pN_nm)


class _Local(Model):
    pairs: Annotated[int, Field(ge=1, le=50)] = Field(
        3, description="number of neighbouring base pairs that are excited"
    )
    first_pair: PositiveInt | None = Field(
        None,
        description="number of the first of them, from 1; left out: the first that is free at the "
        "first end",
    )


class Kick(_Kicked, _Local):
    """An impulse in time on a few base pairs, next to the first end or where they are chosen."""

    kind: Literal["kick"]


class StandingWave(_Kicked):
    """An impulse in time over the whole duplex, in the shape of a standing wave."""

    kind: Literal["standing_wave"]
    mode: Mode = Field(description="number of the standing wave")


class Pulse(_Forced, _Local):
    """A force or torque on a few base pairs, Gaussian in time."""

    kind: Literal["pulse"]
    width_fs: PositiveFloat | None = Field(
        None, description="standard deviation in time; left out: from the first estimate"
    )


class Sweep(Model):
    """Drive frequencies that hold the paper's lowest mode and those of fitted rods."""

    scenes: Annotated[tuple[Name, ...], Field(min_length=1)] = Field(
        description="kicked scenes whose fitted speeds give a rod's lowest mode"
    )
    points: Annotated[int, Field(ge=2, le=50)] = Field(5, description="number of frequencies")


class Range(Model):
    """Drive frequencies in equal steps."""

    # `from` is a word of Python's own.
    model_config = ConfigDict(serialize_by_alias=True)

    lowest: PositiveFloat = Field(alias="from", description="lowest frequency in GHz")
    highest: PositiveFloat = Field(alias="to", description="highest frequency in GHz")
    points: Annotated[int, Field(ge=2, le=50)] = Field(5, description="number of frequencies")

    @model_validator(mode="after")
    def _rising(self) -> Self:
        if self.highest <= self.lowest:
            raise ValueError(f"to must be above from ({self.lowest:g}), found {self.highest:g}")
        return self


FREQUENCIES = ("frequencies_GHz", "range_GHz", "sweep", "modes")


class Periodic(_Forced, _Local):
    """A sinusoidal force or torque on a few base pairs, one run for each frequency."""

    kind: Literal["periodic"]
    frequencies_GHz: Several | None = Field(None, description="drive frequencies")
    range_GHz: Range | None = Field(None, description="drive frequencies in equal steps instead")
    sweep: Sweep | None = Field(
        None, description="frequencies from fitted scenes instead (extension, twist)"
    )
    modes: SeveralModes | None = Field(
        None,
        description="numbers of standing waves between these ends instead, of the rod that `rod` "
        "names, on the lattice of base pairs",
    )
    rod: Literal["measured", "paper"] | None = Field(
        None,
        description="goes with `modes`: the relaxed duplex's own first estimate (extension, "
        "twist), or the paper's constants (all waves)",
    )
    periods: Annotated[float, Field(gt=0, le=10_000)] | None = Field(
        None,
        description="length of each record in periods of its own drive; left out: the "
        "observation's",
    )
    ramp_periods: Annotated[float, Field(ge=0, le=1000)] = Field(
        0.0, description="periods of the drive over which it rises to its full strength"
    )

    @model_validator(mode="after")
    def _one_source_of_frequencies(self) -> Self:
        found = [name for name in FREQUENCIES if getattr(self, name) is not None]
        if len(found) != 1:
            raise ValueError(
                f"give either {', '.join(FREQUENCIES[:-1])} or {FREQUENCIES[-1]}, "
                f"found {' and '.join(found) or 'none'}"
            )
        return self

    @model_validator(mode="after")
    def _full_strength(self) -> Self:
        if self.periods is not None and self.ramp_periods >= self.periods:
            raise ValueError(
                f"ramp_periods must be below periods ({self.periods:g}), or the drive never comes "
                f"to its full strength, found {self.ramp_periods:g}"
            )
        return self

    @model_validator(mode="after")
    def _known_rod(self) -> Self:
        if (self.rod is None) != (self.modes is None):
            raise ValueError(
                f"modes and rod go together: a mode's frequency is that of a rod; found modes "
                f"{None if self.modes is None else list(self.modes)} and rod {self.rod!r}"
            )
        if self.wave in AXIAL_WAVES:
            return self
        if self.rod == "measured":
            raise ValueError(
                f"rod 'measured' contradicts wave '{self.wave}': the duplex's first estimate is of "
                "extension and twist alone; take rod 'paper'"
            )
        if self.sweep is not None:
            raise ValueError(
                f"sweep contradicts wave '{self.wave}': it spans the modes of waves with one speed,"
                " extension and twist; take modes, range_GHz or frequencies_GHz"
            )
        return self

    @property
    def given_GHz(self) -> tuple[float, ...]:
        """Frequencies that the scene itself says; none of a sweep or of mode numbers."""
        if self.range_GHz is None:
            return self.frequencies_GHz or ()
        points = np.linspace(self.range_GHz.lowest, self.range_GHz.highest, self.range_GHz.points)
        return tuple(float(point) for point in points)

    @property
    def points(self) -> int:
        """Number of frequencies, each a run of its own."""
        return self.sweep.points if self.sweep else len(self.given_GHz or self.modes or ())


class Static(_Forced):
    """A constant load on the last base pair; the duplex is relaxed under it."""

    kind: Literal["static"]
    wave: Literal["extension", "twist"] = Field(description="pulled along or turned about the axis")
    scales: Several = Field((1.0,), description="multiples of the load, each with both signs")


class Nothing(Model):
    """No excitation: the null that shows what the estimators make of no wave."""

    kind: Literal["none"]


Excitation = Annotated[
    Kick | StandingWave | Pulse | Periodic | Static | Nothing, Field(discriminator="kind")
]


def _one_amplitude(wave: str, **amplitudes: float | None) -> None:
    linear, angular = amplitudes
    wanted = linear if wave in ("extension", "shear") else angular
    found = [name for name, value in amplitudes.items() if value is not None]
    if found != [wanted]:
        raise ValueError(
            f"a wave of {wave} takes {wanted} and no other amplitude, "
            f"found {' and '.join(found) or 'none'}"
        )


def _given(linear: float | None, angular: float | None) -> float:
    return linear if linear is not None else float(angular or 0.0)
