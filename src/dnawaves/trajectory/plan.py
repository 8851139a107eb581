"""How long a run lasts and how often it is recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dnawaves.errors import InputError
from dnawaves.scene.excitations import PULSE_DELAY_WIDTHS, Periodic, Pulse
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import span
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.drive import drive_of
from dnawaves.units import A_PER_NM

# Samples in one period of the fastest wave, twice what resolves it and some to spare.
SAMPLES_PER_PERIOD = 10
# A pulse this many crossing times of one base-pair step wide biases the speed by about 1 %:
# error = a² / (16 σ² V²).
PULSE_STEPS = 2.5


@dataclass(frozen=True)
class Plan:
    """Numbers of a run: all in ps; `steps_per_frame` timesteps between frames."""

    timestep_ps: float
    steps_per_frame: int
    frames: int
    frequency_GHz: float | None = None
    pulse_width_ps: float | None = None
    ramp_ps: float = 0.0
    drive_mode: int | None = None

    @property
    def interval_ps(self) -> float:
        """Time between frames."""
        return self.timestep_ps * self.steps_per_frame

    @property
    def steps(self) -> int:
        """Number of timesteps."""
        return self.steps_per_frame * (self.frames - 1)


def plan_of(
    duplex: SimulatedDuplex,
    scene: SceneSpec,
    member: str,
    estimates_A_per_ps: Mapping[str, float],
    fitted_speeds_A_per_ps: Sequence[float] = (),
) -> Plan:
    """Return the plan of one member of a scene of this duplex, see `make_plan`."""
    first, last = span(scene.ends, duplex.pair_count)
    length_A = A_PER_NM * float(duplex.heights_nm[last] - duplex.heights_nm[first])
    spacing_A = A_PER_NM * duplex.spacing_nm
    return make_plan(scene, member, estimates_A_per_ps, length_A, spacing_A, fitted_speeds_A_per_ps)


def make_plan(
    scene: SceneSpec,
    member: str,
    estimates_A_per_ps: Mapping[str, float],
    length_A: float,
    spacing_A: float,
    fitted_speeds_A_per_ps: Sequence[float] = (),
) -> Plan:
    """Return the plan of one member of a scene.

    Parameters
    ----------
    estimates_A_per_ps : first estimates of the speeds of extension and twist
    length_A : distance along the axis that a wave can run
    spacing_A : mean distance of neighbouring base pairs
    fitted_speeds_A_per_ps : speeds fitted to the scenes that a sweep names

    Raises
    ------
    InputError
        When the member is not one of the scene's, the frames are too rare for the drive, or the
        record ends before the pulse is at its height.
    """
    if member not in scene.members:
        raise InputError(
            f"scene '{scene.name}': found member {member!r}; allowed: {', '.join(scene.members)}"
        )
    observation, excitation = scene.observation, scene.excitation
    wave = getattr(excitation, "wave", "extension")
    speed = estimates_A_per_ps["extension" if wave == "extension" else "twist"]
    duration_ps = observation.duration_ps or observation.crossings * length_A / speed
    fastest = max(estimates_A_per_ps.values())
    # Period at the edge of the base-pair lattice's band: pi a / V.
    interval_ps = np.pi * spacing_A / fastest / SAMPLES_PER_PERIOD
    drive = None
    if isinstance(excitation, Periodic):
        drive = drive_of(
            scene, member, estimates_A_per_ps, length_A, spacing_A, fitted_speeds_A_per_ps
        )
        interval_ps = min(interval_ps, drive.period_ps / SAMPLES_PER_PERIOD)
        if excitation.periods is not None:
            duration_ps = excitation.periods * drive.period_ps
    if observation.interval_fs is not None:
        interval_ps = observation.interval_fs / 1e3
        if drive is not None and interval_ps >= drive.period_ps / 2:
            raise InputError(
                f"scene '{scene.name}': observation.interval_fs: found "
                f"{observation.interval_fs:g}; allowed: below {500 * drive.period_ps:g}, the "
                f"Nyquist limit of the drive at {drive.frequency_GHz:g} GHz"
            )
    pulse_width_ps = None
    if isinstance(excitation, Pulse):
        pulse_width_ps = (
            excitation.width_fs / 1e3 if excitation.width_fs else PULSE_STEPS * spacing_A / speed
        )
        if observation.duration_ps is None:
            duration_ps += 2 * PULSE_DELAY_WIDTHS * pulse_width_ps
        elif duration_ps <= PULSE_DELAY_WIDTHS * pulse_width_ps:
            raise InputError(
                f"scene '{scene.name}': observation.duration_ps: found {duration_ps:g}; allowed: "
                f"above {PULSE_DELAY_WIDTHS * pulse_width_ps:.3g}, when the pulse is at its height"
            )
    timestep_ps = observation.timestep_fs / 1e3
    steps_per_frame = max(1, int(interval_ps / timestep_ps + 1e-9))
    frames = int(np.ceil(duration_ps / (steps_per_frame * timestep_ps) - 1e-9)) + 1
    driven = (drive.frequency_GHz, drive.ramp_ps, drive.mode) if drive else (None, 0.0, None)
    frequency_GHz, ramp_ps, mode = driven
    return Plan(timestep_ps, steps_per_frame, frames, frequency_GHz, pulse_width_ps, ramp_ps, mode)
