"""What was done to the molecule, as a function of the chain that answers: kick, pulse, drive."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.modal import ModalChain

Array = NDArray[np.float64]

# Velocities (time, *field) of a chain for a pattern (*field) and a friction per ps.
Respond = Callable[[ModalChain, Array, float], Array]


def kick(times_ps: Array) -> Respond:
    """Velocities `pattern` at t = 0."""
    return lambda chain, pattern, friction: chain.kick_response(times_ps, pattern, friction)[1]


def pulse(times_ps: Array, centre_ps: float, width_ps: float) -> Respond:
    """Forces pattern exp(-(t - centre)^2/(2 width^2))."""
    return lambda chain, pattern, friction: chain.pulse_response(
        times_ps, pattern, centre_ps, width_ps, friction
    )[1]


def drive(times_ps: Array, frequency_rad_per_ps: float, ramp_ps: float = 0.0) -> Respond:
    """Forces pattern sin(frequency t) from t = 0 on, rising during the ramp."""
    return lambda chain, pattern, friction: chain.driven_response(
        times_ps, pattern, frequency_rad_per_ps, friction, ramp_ps
    )[1]
