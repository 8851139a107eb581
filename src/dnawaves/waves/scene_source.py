"""The known source of a scene's record: where it acts, how strongly, and its course in time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.scene.excitations import PULSE_DELAY_WIDTHS, Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.pairs import excited_pairs
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.estimators.sources import Respond, drive, kick, pulse
from dnawaves.waves.record import Record

Array = NDArray[np.float64]

# About which direction each wave turns the base pairs, by the name of the record's axis.
TURNS_ABOUT = {"twist": "helix", "bend": "second"}


def course(record: Record, times_ps: Array) -> Respond:
    """Return how a chain answers the scene's excitation, for a pattern of strength in space."""
    excitation = record.scene.excitation
    if isinstance(excitation, Pulse):
        width_ps = float(record.motion.attrs["pulse_width_ps"])
        return pulse(times_ps, PULSE_DELAY_WIDTHS * width_ps, width_ps)
    if isinstance(excitation, Periodic):
        return drive(
            times_ps,
            2e-3 * np.pi * float(record.motion.attrs["frequency_GHz"]),
            float(record.motion.attrs.get("ramp_ps", 0.0)),
        )
    return kick(times_ps)


def is_force(record: Record) -> bool:
    """Return whether the pattern is one of accelerations, not of velocities."""
    return isinstance(record.scene.excitation, Pulse | Periodic)


def pattern(record: Record, wave: str) -> Array:
    """Return the strength (pair,) of the source in one wave's coordinate, nm and rad.

    Velocities of the record's first frame for a kick, which is an impulse in time; accelerations
    for a force or torque, under which the excited pairs move as rigid bodies all alike.
    """
    excitation = record.scene.excitation
    if isinstance(excitation, Kick | StandingWave):
        strength = record.velocity(wave)[0].copy()
        strength[record.held] = 0.0
        return strength / unit_A(wave)
    assert isinstance(excitation, Pulse | Periodic)
    strength = np.zeros(record.pairs)
    if wave != excitation.wave:
        return strength
    excited = excited_pairs(excitation, record.scene.ends)
    # Da and nm, or Da nm^2 and rad; forces in pN, torques in pN nm.
    mass = pair_masses(record, wave)[excited].sum()
    strength[excited] = excitation.amplitude * KJ_PER_MOL_PER_PN_NM / mass
    return strength


def pair_masses(record: Record, wave: str) -> Array:
    """Return the mass (Da) or moment of inertia (Da nm^2) of each pair in a wave's coordinate."""
    if wave in TURNS_ABOUT:
        return record.inertias_Da_A2(TURNS_ABOUT[wave]) / A_PER_NM**2
    return np.asarray(record.motion["mass"].values, dtype=np.float64)


def mean_mass(record: Record, wave: str) -> float:
    """Return the mean of `pair_masses`."""
    return float(pair_masses(record, wave).mean())


def unit_A(wave: str) -> float:
    """Return what a wave's velocity is divided by to be in nm or rad."""
    return 1.0 if wave in TURNS_ABOUT else A_PER_NM


def velocity_nm(record: Record, wave: str, frames: int | None = None) -> Array:
    """Return the first frames (all) of a velocity field (time, pair) in nm/ps or rad/ps."""
    return record.velocity(wave)[:frames] / unit_A(wave)
