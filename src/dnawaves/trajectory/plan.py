"""How long a run lasts, how often it is recorded, and the frequencies that drive it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dnawaves.errors import InputError
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.excitations import Periodic, Pulse
from dnawaves.scene.models import SceneSpec

# Samples in one period of the fastest wave, twice what resolves it and some to spare.
SAMPLES_PER_PERIOD = 10
# A pulse this many crossing times of one base-pair step wide biases the speed by about 1 %:
# error = a² / (16 σ² V²).
PULSE_STEPS = 2.5
SWEEP_MARGIN = 1.3
# A pulse is centred this many widths after the start, where it has come up from zero.
PULSE_DELAY_WIDTHS = 5


@dataclass(frozen=True)
class Plan:
    """Numbers of a run: all in ps; `steps_per_frame` timesteps between frames."""

    timestep_ps: float
    steps_per_frame: int
    frames: int
    frequency_GHz: float | None = None
    pulse_width_ps: float | None = None
    ramp_ps: float = 0.0

    @property
    def interval_ps(self) -> float:
        """Time between frames."""
        return self.timestep_ps * self.steps_per_frame

    @property
    def steps(self) -> int:
        """Number of timesteps."""
        return self.steps_per_frame * (self.frames - 1)


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
        When the member is not one of the scene's, or the frames are too rare for the drive.
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
    frequency_GHz, ramp_ps = None, 0.0
    if isinstance(excitation, Periodic):
        frequency_GHz = drive_frequencies_GHz(excitation, length_A, fitted_speeds_A_per_ps)[
            scene.members.index(member)
        ]
        ramp_ps = excitation.ramp_periods * 1e3 / frequency_GHz
        interval_ps = min(interval_ps, 1e3 / frequency_GHz / SAMPLES_PER_PERIOD)
    if observation.interval_fs is not None:
        interval_ps = observation.interval_fs / 1e3
        if frequency_GHz is not None and frequency_GHz >= 500 / interval_ps:
            raise InputError(
                f"scene '{scene.name}': observation.interval_fs: found "
                f"{observation.interval_fs:g}; allowed: below {5e5 / frequency_GHz:g}, the "
                f"Nyquist limit of the drive at {frequency_GHz:g} GHz"
            )
    pulse_width_ps = None
    if isinstance(excitation, Pulse):
        pulse_width_ps = (
            excitation.width_fs / 1e3 if excitation.width_fs else PULSE_STEPS * spacing_A / speed
        )
        if observation.duration_ps is None:
            duration_ps += 2 * PULSE_DELAY_WIDTHS * pulse_width_ps
    timestep_ps = observation.timestep_fs / 1e3
    steps_per_frame = max(1, int(interval_ps / timestep_ps + 1e-9))
    frames = int(np.ceil(duration_ps / (steps_per_frame * timestep_ps) - 1e-9)) + 1
    return Plan(timestep_ps, steps_per_frame, frames, frequency_GHz, pulse_width_ps, ramp_ps)


def drive_frequencies_GHz(
    excitation: Periodic, length_A: float, fitted_speeds_A_per_ps: Sequence[float]
) -> tuple[float, ...]:
    """Return the frequencies of a periodic scene.

    A sweep spans the lowest modes V/2L of the paper's rod and of the fitted ones with a margin.
    """
    if excitation.frequencies_GHz is not None:
        return excitation.frequencies_GHz
    assert excitation.sweep is not None
    wanted = excitation.sweep.scenes
    if len(fitted_speeds_A_per_ps) != len(wanted):
        raise InputError(
            f"excitation.sweep: found {len(fitted_speeds_A_per_ps)} fitted speeds; "
            f"allowed: one for each of {', '.join(wanted)}"
        )
    paper = short_wave_speeds_A_per_ps(Rod.paper())[excitation.wave]
    modes_GHz = [1e3 * speed / (2 * length_A) for speed in (paper, *fitted_speeds_A_per_ps)]
    sweep = np.linspace(
        min(modes_GHz) / SWEEP_MARGIN, max(modes_GHz) * SWEEP_MARGIN, excitation.sweep.points
    )
    return tuple(float(frequency) for frequency in sweep)
