"""What an experiment may declare: the configuration's models, frozen and closed to unknown keys."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, PositiveInt, model_validator

from dnawaves.scene.contradictions import EXPLICIT
from dnawaves.scene.environment import Environment
from dnawaves.scene.excitations import (
    PULSE_DELAY_WIDTHS,
    Excitation,
    Kick,
    Nothing,
    Periodic,
    Pulse,
    StandingWave,
    Static,
)
from dnawaves.scene.model import Model, Name, Seed

Method = Literal["simulated", "harmonic"]
SMALLEST_PULSE_TIMESTEPS = 10


class Ends(Model):
    """How the two ends are held: a held base pair's atoms do not move."""

    first: Literal["free", "held", "restrained"] = Field(
        "free", description="the end at base pair 1; restrained: held by springs"
    )
    last: Literal["free", "held", "restrained", "guided"] = Field(
        "held",
        description="the end at base pair N; guided: it moves as a rigid body, only along or "
        "about the axis, as a static load pushes it",
    )
    pairs: Annotated[int, Field(ge=1, le=10)] = Field(
        1, description="number of base pairs that are held at a held or restrained end"
    )
    stiffness_pN_per_nm: Annotated[float, Field(gt=0, le=1e7)] | None = Field(
        None, description="stiffness of the springs on each base pair of a restrained end"
    )

    @model_validator(mode="after")
    def _springs(self) -> Self:
        restrained = "restrained" in (self.first, self.last)
        if restrained != (self.stiffness_pN_per_nm is not None):
            raise ValueError(
                "stiffness_pN_per_nm goes with an end that is 'restrained', found "
                f"{self.stiffness_pN_per_nm} with '{self.first}' and '{self.last}'"
            )
        return self


class Observation(Model):
    """What is recorded, how long and how often."""

    # Verlet is unstable beyond 2/omega, 2.86 fs for the O-H stretch of the chains' ends.
    timestep_fs: Annotated[float, Field(gt=0, le=2.5)] = Field(
        2.0, description="velocity Verlet timestep"
    )
    duration_ps: Annotated[float, Field(gt=0, le=1e6)] | None = Field(
        None, description="length of the record; left out: `crossings` by the first estimate"
    )
    crossings: Annotated[float, Field(gt=0, le=1000)] = Field(
        1.2, description="length of the record in crossings of the duplex, by the first estimate"
    )
    interval_fs: Annotated[float, Field(gt=0, le=1e5)] | None = Field(
        None,
        description="time between frames, rounded down to whole timesteps; left out: from the "
        "first estimate",
    )
    helical: bool = Field(
        False, description="also record the base atoms and derive helical parameters"
    )


class AddedMass(Model):
    """Mass that a base pair carries, such as a bound protein's, spread over the pair's atoms."""

    pair: PositiveInt = Field(description="number of the base pair, from 1")
    mass_Da: Annotated[float, Field(gt=0, le=1e7)] = Field(description="mass added to the pair")


class Thermostat(Model):
    """Friction and noise that keep the environment's temperature while the scene runs."""

    friction_per_ps: Annotated[float, Field(gt=0, le=100)] = Field(
        description="rate at which momentum decays; it damps the wave too"
    )
    seed: Seed = Field(1, description="seed of the noise; both signs of a run see the same noise")


class Scene(Model):
    """One experiment: a duplex, its environment, its ends, what excites it, what is observed."""

    duplex: Name = Field(description="name of a duplex in the structures file")
    environment: Name = Field(description="name of an environment of this file")
    ends: Ends = Ends()
    excitation: Excitation
    observation: Observation = Observation()
    method: Method = Field(
        "simulated",
        description="simulated: every atom integrated in time; harmonic: the exact answer of the "
        "linearised duplex, from its normal modes",
    )
    masses: tuple[AddedMass, ...] = Field(
        (), description="base pairs that carry added mass: another motion from the same minimum"
    )
    thermostat: Thermostat | None = Field(
        None, description="above 0 K only; left out: the energy is conserved (NVE)"
    )
    replicas: Annotated[int, Field(ge=1, le=1000)] = Field(
        1, description="above 0 K only: number of equilibrated snapshots that the scene runs from"
    )

    @model_validator(mode="after")
    def _masses_matter(self) -> Self:
        kind = self.excitation.kind
        if self.masses and self.method == "harmonic":
            raise ValueError(
                "masses contradict method 'harmonic': the normal modes are those of the duplex "
                "alone; take method 'simulated'"
            )
        if self.masses and kind in ("static", "none"):
            raise ValueError(f"masses contradict excitation.kind '{kind}': nothing moves there")
        pairs = [added.pair for added in self.masses]
        if len(set(pairs)) != len(pairs):
            raise ValueError(f"masses must be on base pairs that differ, found {pairs}")
        return self

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        excitation, ends, observed = self.excitation, self.ends, self.observation
        if self.method == "harmonic" and isinstance(excitation, Static | Nothing):
            raise ValueError(
                "method 'harmonic' goes with excitation.kind 'kick', 'standing_wave', 'pulse' or "
                f"'periodic', found kind '{excitation.kind}'; a static scene's own answer "
                "includes the harmonic one, and without excitation nothing moves"
            )
        if self.method == "harmonic" and ends.stiffness_pN_per_nm is not None:
            raise ValueError(
                "method 'harmonic' contradicts an end that is 'restrained': its normal modes are "
                "those without springs; allowed: 'free' or 'held'"
            )
        if self.method == "harmonic" and observed.helical:
            raise ValueError(
                "method 'harmonic' knows base pairs and no atoms, so observation.helical must be "
                "false, found true"
            )
        both_fixed = {ends.first, ends.last} <= {"held", "restrained"}
        if isinstance(excitation, StandingWave | Periodic) and not both_fixed:
            raise ValueError(
                f"excitation.kind '{excitation.kind}' needs both ends held or restrained, "
                f"found ends.first '{ends.first}', ends.last '{ends.last}'"
            )
        if isinstance(excitation, Static) != (ends.last == "guided") or (
            isinstance(excitation, Static) and ends.first != "held"
        ):
            raise ValueError(
                "excitation.kind 'static' goes with ends.first 'held' and ends.last 'guided', "
                f"found kind '{excitation.kind}' with '{ends.first}' and '{ends.last}'"
            )
        if isinstance(excitation, Static) and observed.helical:
            raise ValueError(
                "excitation.kind 'static' has no trajectory, so observation.helical must be "
                "false, found true"
            )
        interval_fs = observed.interval_fs
        if interval_fs is not None and interval_fs < observed.timestep_fs:
            raise ValueError(
                f"observation.interval_fs must be at least timestep_fs "
                f"({observed.timestep_fs:g}), found {interval_fs:g}"
            )
        if isinstance(excitation, Periodic):
            # Left out, the interval follows the drive; five timesteps still resolve it.
            finest_fs = interval_fs or 5 * observed.timestep_fs
            nyquist_GHz = 0.5e6 / finest_fs
            given = "range_GHz" if excitation.range_GHz else "frequencies_GHz"
            for frequency_GHz in excitation.given_GHz:
                if frequency_GHz >= nyquist_GHz:
                    raise ValueError(
                        f"excitation.{given} must lie below the recording's Nyquist frequency, "
                        f"{nyquist_GHz:g} GHz at observation.interval_fs "
                        f"{finest_fs:g}, found {frequency_GHz:g}"
                    )
        if isinstance(excitation, Pulse) and excitation.width_fs is not None:
            least_fs = SMALLEST_PULSE_TIMESTEPS * observed.timestep_fs
            if excitation.width_fs < least_fs:
                raise ValueError(
                    f"excitation.width_fs must be at least {SMALLEST_PULSE_TIMESTEPS} timesteps, "
                    f"{least_fs:g} fs, found {excitation.width_fs:g}"
                )
            peak_ps = PULSE_DELAY_WIDTHS * excitation.width_fs / 1e3
            if observed.duration_ps is not None and observed.duration_ps <= peak_ps:
                raise ValueError(
                    f"observation.duration_ps must be above {peak_ps:g}, when a pulse of "
                    f"excitation.width_fs {excitation.width_fs:g} is at its height, found "
                    f"{observed.duration_ps:g}"
                )
        return self


class Configuration(Model):
    """A configuration file: named environments and named scenes."""

    structures: str = Field(description="file of named sequences, relative to this file")
    environments: dict[Name, Environment] = Field(min_length=1)
    scenes: dict[Name, Scene] = Field(min_length=1)


class NamedDuplex(Model):
    """A duplex: its name and strand I from 5' to 3'; where it is a user's structure, its file."""

    name: Name
    sequence: str
    file: str | None = None
    # Of the file's content (SHA-256): another content is another duplex.
    digest: str | None = None


class SystemSpec(Model):
    """A duplex in an environment: all that the relaxed structure depends on."""

    duplex: NamedDuplex
    environment_name: Name
    environment: Environment

    @property
    def thermal(self) -> bool:
        """Whether scenes start from equilibrated snapshots instead of a minimum."""
        return self.environment.temperature_K > 0

    @property
    def explicit(self) -> bool:
        """Whether there is a box of explicit water."""
        return self.environment.solvent in EXPLICIT

    @property
    def name(self) -> str:
        """Name of the system's folder."""
        return f"{self.duplex.name}-{self.environment_name}"


class SceneSpec(Model):
    """A scene with everything that its names stand for."""

    name: Name
    system: SystemSpec
    ends: Ends
    excitation: Excitation
    observation: Observation
    method: Method = "simulated"
    masses: tuple[AddedMass, ...] = ()
    thermostat: Thermostat | None = None
    replicas: int = 1

    @property
    def members(self) -> tuple[str, ...]:
        """Names of the scene's runs; above 0 K each ends with the number of its snapshot."""
        if not self.system.thermal:
            return self._variants
        variants = () if self._variants == ("run",) else self._variants
        snapshots = [f"r{number}" for number in range(1, self.replicas + 1)]
        return tuple(f"{variant}{one}" for variant in variants or ("",) for one in snapshots)

    @property
    def _variants(self) -> tuple[str, ...]:
        excitation = self.excitation
        if isinstance(excitation, Kick | StandingWave | Static):
            return tuple(f"x{scale:g}" for scale in excitation.scales)
        if isinstance(excitation, Periodic):
            return tuple(f"f{index}" for index in range(1, excitation.points + 1))
        return ("run",)

    @property
    def signs(self) -> tuple[str, ...]:
        """Names of the copies that each run simulates."""
        return ("plus",) if isinstance(self.excitation, Nothing) else ("plus", "minus")

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of the scenes whose fitted speeds this scene's drive is chosen from."""
        if isinstance(self.excitation, Periodic) and self.excitation.sweep:
            return self.excitation.sweep.scenes
        return ()
