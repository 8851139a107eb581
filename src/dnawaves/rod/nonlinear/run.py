"""Motion of a nonlinear chain in time: kick, drift, kick."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from dnawaves.errors import InputError
from dnawaves.rod.nonlinear.chain import NonlinearChain
from dnawaves.rod.nonlinear.motion import Motion, motions
from dnawaves.rod.nonlinear.state import State
from dnawaves.rod.rod import FloatArray


class Load(NamedTuple):
    """External forces and torques: a pattern times a function of time.

    The pattern (bodies, 6), or (..., bodies, 6) for rods with leading axes, acts at the origins
    along the laboratory's axes: kJ/mol/nm, kJ/mol. The function takes ps.
    """

    pattern: FloatArray
    envelope: Callable[[float], float]


class Record(NamedTuple):
    """Times (times,), ps, and the states then, with a first axis (times, ...)."""

    times_ps: FloatArray
    states: State


def run(
    chain: NonlinearChain,
    start: State,
    timestep_ps: float,
    steps: int,
    *,
    record_every: int = 1,
    load: Load | None = None,
) -> Record:
    """Move a chain, or many along the leading axes of `start`, and record their states.

    Symplectic and of second order in the timestep; without a load the total momentum and angular
    momentum are conserved to round-off, and the energy to an error that does not grow.

    Raises
    ------
    InputError
        If the timestep is not below the limit of stability (`NonlinearChain.timestep_limit_ps`).
    SimulationError
        If a link is rotated by more than 0.9 pi, or its strain is not finite.
    """
    limit = chain.timestep_limit_ps
    if not 0 < timestep_ps < limit:
        raise InputError(
            f"the timestep is {timestep_ps:g} ps; for this chain it must be positive and below "
            f"{limit:.4g} ps, where its fastest wave becomes unstable; a tenth of that is accurate"
        )
    if start.momenta.shape[-2] == chain.bodies and np.any(start.momenta[..., ~chain.free, :]):
        raise InputError("a held body has momentum at the start; it cannot move")
    if steps < 1 or record_every < 1:
        raise InputError(f"{steps} steps, recorded every {record_every}: both must be at least 1")
    return integrate(chain, start, timestep_ps, steps, record_every=record_every, load=load)


def integrate(
    chain: NonlinearChain,
    start: State,
    timestep_ps: float,
    steps: int,
    *,
    record_every: int = 1,
    load: Load | None = None,
) -> Record:
    """Do what `run` does at any timestep, stable or not."""
    leading = start.leading
    recorded = [0, *range(record_every, steps + 1, record_every)]
    total = int(np.prod(leading))
    kept = [np.empty((len(recorded), total, chain.bodies, k)) for k in (3, 4, 6)]
    # what overflows is found by its link, and reported with it
    with np.errstate(over="ignore", invalid="ignore"):
        for portion, motion in motions(chain, start):
            pattern = None
            if load is not None:
                shape = (*leading, chain.bodies, 6)
                flat = np.broadcast_to(load.pattern, shape).reshape(total, chain.bodies, 6)
                pattern = Load(motion.laid_out(flat[portion]), load.envelope)
            states = _states(motion, timestep_ps, steps, record_every, pattern, portion.start)
            for row, state in enumerate(states):
                for array, values in zip(kept, vars(state).values(), strict=True):
                    array[row, portion] = values
    shaped = (array.reshape(len(recorded), *leading, *array.shape[2:]) for array in kept)
    return Record(timestep_ps * np.array(recorded), State(*shaped))


def _states(
    motion: Motion,
    timestep_ps: float,
    steps: int,
    record_every: int,
    load: Load | None,
    first_rod: int,
) -> Iterator[State]:
    """Yield the states (batch, bodies, ...) at the start and every `record_every` steps."""
    half_kick = motion.links.stiffness * (timestep_ps / 2)
    drifts = motion.bodies.drifts(timestep_ps)

    def pull(step: int, halves: int) -> None:
        time_ps = step * timestep_ps
        impulse = None
        if load is not None:
            impulse = load.pattern * (load.envelope(time_ps) * halves * timestep_ps / 2)
        motion.strain(time_ps, first_rod)
        motion.pull(half_kick * halves, impulse)
        motion.kick()

    yield motion.state()
    pull(0, 1)
    for step in range(1, steps + 1):
        motion.bodies.drift(*drifts)
        recorded = step % record_every == 0
        pull(step, 1 if recorded else 2)
        if recorded:
            yield motion.state()
            # the same half kick again, which begins the next step
            motion.kick()
