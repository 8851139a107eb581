"""The exact answer of the linearised duplex, in the form of a simulated record."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.rod.oscillator import (
    gaussian_pulse_response,
    impulse_response,
    sine_drive_response,
)
from dnawaves.scene.excitations import PULSE_DELAY_WIDTHS, Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.modes import NormalModes
from dnawaves.trajectory.pattern import forces_at_full_strength, kick_pattern
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.record import SIGNS, injected_momenta, motion_dataset

Array = NDArray[np.float64]


def respond(
    duplex: SimulatedDuplex,
    modes: NormalModes,
    scene: SceneSpec,
    plan: Plan,
    scale: float,
    minimum_kJ_per_mol: float,
) -> xr.Dataset:
    """Return the motion of both signs after the scene's excitation, times `scale`.

    `modes` are those of the scene's held ends. Energies are those of all atoms, not only of the
    pairs' rigid-body motion; the work of a drive is the energy that the modes have gained.

    Raises
    ------
    SimulationError
        When the structure is no minimum.
    """
    driven = isinstance(scene.excitation, Pulse | Periodic)
    momenta = scale * _momenta(duplex, scene)
    amplitudes, frequencies = modes.amplitudes(momenta), modes.frequencies_rad_per_ps
    position, velocity = (amplitudes * part for part in _responses(frequencies, scene, plan))
    motion = np.concatenate([modes.motion(position), modes.motion(velocity)], axis=-1)
    kinetic = 0.5 * np.sum(velocity**2, axis=1)
    potential = 0.5 * np.sum((frequencies * position) ** 2, axis=1)
    signs = tuple(SIGNS[name] for name in scene.signs)
    energy = np.tile(kinetic + potential, (len(signs), 1))
    dataset = motion_dataset(
        duplex,
        scene,
        plan,
        signs,
        # From (sign, time, pair, quantity, xyz) to (quantity, sign, time, pair, xyz).
        np.moveaxis(np.multiply.outer(signs, motion.reshape(*motion.shape[:2], 4, 3)), 3, 0),
        minimum_kJ_per_mol + energy,
        energy if driven else np.zeros_like(energy),
        kinetic,
    )
    # What nothing holds back takes up the whole impulse: 1 for a kick.
    impulse = _responses(np.zeros(1), scene, plan)[1][:, 0]
    linear, angular = momenta[:, :3], momenta[:, 3:]
    total = [linear.sum(0), (angular + np.cross(duplex.bodies.centres_nm, linear)).sum(0)]
    put_in = np.einsum("s,t,qx->qstx", signs, impulse, total)
    return dataset.assign(injected_momenta(put_in))


def _momenta(duplex: SimulatedDuplex, scene: SceneSpec) -> Array:
    """Return momenta (N, 6) that a kick gives the pairs, or forces and torques of a drive alike."""
    excitation = scene.excitation
    if isinstance(excitation, Kick | StandingWave):
        kick = kick_pattern(excitation, scene.ends, duplex.pair_count)
        atoms = kick.velocities(duplex)
    else:
        assert isinstance(excitation, Pulse | Periodic)
        forces = forces_at_full_strength(excitation, scene.ends, duplex)
        atoms = forces / duplex.masses_Da[:, None]
    rigid = np.concatenate(duplex.bodies.velocity(duplex.positions_nm, atoms), axis=1)
    return duplex.bodies.momenta(rigid)


def _responses(frequencies: Array, scene: SceneSpec, plan: Plan) -> tuple[Array, Array]:
    """Return coordinates and velocities (frames, modes) for an amplitude of 1 in each mode."""
    times_ps = plan.interval_ps * np.arange(plan.frames)
    if isinstance(scene.excitation, Periodic):
        assert plan.frequency_GHz is not None
        drive = 2e-3 * np.pi * plan.frequency_GHz
        return sine_drive_response(times_ps, frequencies, 0.0, drive, plan.ramp_ps)
    if isinstance(scene.excitation, Pulse):
        assert plan.pulse_width_ps is not None
        centre_ps = PULSE_DELAY_WIDTHS * plan.pulse_width_ps
        return gaussian_pulse_response(times_ps, frequencies, 0.0, centre_ps, plan.pulse_width_ps)
    return impulse_response(times_ps, frequencies, 0.0)
