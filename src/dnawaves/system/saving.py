"""How often a long run is saved: at step numbers that follow from its size alone."""

from __future__ import annotations

from dnawaves.scene.environment import Environment

# Between two checkpoints, about 20 s on one core: steps times atoms at 1 µs (in water 2 to 3), and
# where every pair of atoms interacts steps times pairs at 20 ns, as in OBC2 (46 ms a step of 1522
# atoms). Not a probe's time: noise, forces and so the last digits depend on where a run is cut.
ATOM_STEPS = 2e7
PAIR_STEPS = 1e9


def parts_between_checkpoints(
    environment: Environment, atoms: int, steps_per_part: int, copies: int = 1
) -> int:
    """Return how many parts of a run, frames or samples, lie between two checkpoints."""
    steps = ATOM_STEPS / atoms if environment.cutoff_nm else PAIR_STEPS / atoms**2
    return max(1, round(steps / (copies * steps_per_part)))
