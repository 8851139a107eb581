"""Synthetic records: thermal motion of a chain, and noise of a chosen strength on a known wave."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.modal import ModalChain, impulse_response

Array = NDArray[np.float64]


def thermal_velocity(
    chain: ModalChain,
    frames: int,
    interval_ps: float,
    friction_per_ps: float,
    energy: float,
    rng: np.random.Generator,
) -> Array:
    """Return velocities (time, *field) of a chain in equilibrium at kT = `energy`.

    Exact at any interval: the modes' Langevin equation is propagated in closed form.
    """
    frequencies = chain.frequencies_rad_per_ps
    position, velocity = (
        part[0] for part in impulse_response([interval_ps], frequencies, friction_per_ps)
    )
    step = np.array(
        [
            [velocity + friction_per_ps * position, position],
            [-(frequencies**2) * position, velocity],
        ]
    ).transpose(2, 0, 1)
    moving = frequencies > 0
    # Where a motion that nothing resists has got to does not matter for its velocity.
    step[~moving, 0] = 0.0
    stationary = np.zeros_like(step)
    stationary[moving, 0, 0] = energy / frequencies[moving] ** 2
    stationary[:, 1, 1] = energy
    values, vectors = np.linalg.eigh(stationary - step @ stationary @ step.transpose(0, 2, 1))
    root = vectors * np.sqrt(np.maximum(values, 0))[:, np.newaxis]
    state = np.sqrt(stationary) @ rng.standard_normal((len(frequencies), 2, 1))
    kicks = root @ rng.standard_normal((frames, len(frequencies), 2, 1))
    modal = np.empty((frames, len(frequencies)))
    for frame, kick in enumerate(kicks):
        modal[frame] = state[:, 1, 0]
        state = step @ state + kick
    return np.tensordot(modal, chain.shapes, axes=1)


def white_noise(record: Array, sd: float, rng: np.random.Generator) -> Array:
    """Return independent noise of the shape of a record."""
    return sd * rng.standard_normal(record.shape)


def noise_sd_for_snr(wave: Array, snr: float) -> float:
    """Return the noise's sd at a ratio to the peak of a noise-free (time,) signal."""
    return float(np.abs(wave).max() / snr)
