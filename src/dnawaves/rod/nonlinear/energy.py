"""Energy of a nonlinear chain, and its gradient."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dnawaves.rod.nonlinear.chain import NonlinearChain, halves
from dnawaves.rod.nonlinear.motion import Motion, motions
from dnawaves.rod.nonlinear.state import State
from dnawaves.rod.rod import FloatArray


def energy(chain: NonlinearChain, state: State) -> FloatArray:
    """Return kinetic and potential energy together (...), kJ/mol."""
    return chain.kinetic_energy(state) + potential_energy(chain, state)


def potential_energy(chain: NonlinearChain, state: State) -> FloatArray:
    """Return the energy of all links (...), kJ/mol."""
    return _of_strains(chain, state, lambda motion: motion.links.energy().sum(axis=0))


def gradient(chain: NonlinearChain, state: State) -> FloatArray:
    """Return the derivative (..., bodies, 6) of the energy by `State.displaced`.

    kJ/mol/nm and kJ/mol along the bodies' own axes, about their origins: minus force and torque.
    """

    def forces(motion: Motion) -> FloatArray:
        motion.links.impulses(motion.links.stiffness, motion.impulses.all)
        return motion.user_shape(motion.impulses.all)

    in_laboratory = halves(_of_strains(chain, state, forces))
    own = np.einsum("...nji,...nkj->...nki", state.axes, in_laboratory)
    return -own.reshape(*state.leading, chain.bodies, 6)


def _of_strains(
    chain: NonlinearChain, state: State, what: Callable[[Motion], FloatArray]
) -> FloatArray:
    values = []
    for _, motion in motions(chain, state):
        motion.strain()
        values.append(what(motion))
    result = np.concatenate(values)
    return result.reshape((*state.leading, *result.shape[1:]))
