"""How often a long run is saved: after a number of steps that follows from its size alone."""

from __future__ import annotations

from dnawaves.scene.environment import Environment

# Of one copy between two checkpoints, each about 20 s on one core: steps times atoms at 1 µs, and
# where every pair of atoms interacts steps times pairs at 20 ns, as in OBC2 (46 ms a step of 1522
# atoms). Not a probe's time: noise, forces and so the last digits depend on where a run is cut.
ATOM_STEPS = 2e7
PAIR_STEPS = 1e9


def steps_between_checkpoints(environment: Environment, atoms: int) -> float:
    """Return how many steps of so many atoms lie between two checkpoints."""
    return ATOM_STEPS / atoms if environment.cutoff_nm else PAIR_STEPS / atoms**2
