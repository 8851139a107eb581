"""What excites a duplex: kicks, pulses, periodic drives, static loads, nothing."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, PositiveFloat, model_validator

from dnawaves.scene.model import Model, Name

Wave = Literal["extension", "twist", "bend", "shear"]


def _distinct(scales: tuple[float, ...]) -> tuple[float, ...]:
    if len({f"{scale:g}" for scale in scales}) != len(scales):
        raise ValueError(f"scales must differ from each other, found {list(scales)}")
    return scales


Scales = Annotated[tuple[PositiveFloat, ...], Field(min_length=1), AfterValidator(_distinct)]


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
    scales: Scales = Field(
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
        3, description="number of free base pairs next to the first end that are excited"
    )


class Kick(_Kicked, _Local):
    """An impulse in time on the base pairs next to the first end."""

    kind: Literal["kick"]


class StandingWave(_Kicked):
    """An impulse in time over the whole duplex, in the shape of a standing wave."""

    kind: Literal["standing_wave"]
    mode: Annotated[int, Field(ge=1, le=20)] = Field(description="number of the standing wave")


class Pulse(_Forced, _Local):
    """A force or torque on the base pairs next to the first end, Gaussian in time."""

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


class Periodic(_Forced, _Local):
    """A sinusoidal force or torque on the base pairs next to the first end."""

    kind: Literal["periodic"]
    wave: Literal["extension", "twist"] = Field(description="pushed along or turned about the axis")
    frequencies_GHz: Annotated[tuple[PositiveFloat, ...], Field(min_length=1)] | None = Field(
        None, description="drive frequencies, one run each"
    )
    sweep: Sweep | None = Field(None, description="frequencies from fitted scenes instead")
    ramp_periods: Annotated[float, Field(ge=0, le=1000)] = Field(
        0.0, description="periods of the drive over which it rises to its full strength"
    )

    @model_validator(mode="after")
    def _one_source_of_frequencies(self) -> Self:
        if (self.frequencies_GHz is None) == (self.sweep is None):
            raise ValueError("give either frequencies_GHz or sweep, not both and not neither")
        return self


class Static(_Forced):
    """A constant load on the last base pair; the duplex is relaxed under it."""

    kind: Literal["static"]
    wave: Literal["extension", "twist"] = Field(description="pulled along or turned about the axis")
    scales: Scales = Field((1.0,), description="multiples of the load, each with both signs")


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
