"""How often a long run is saved."""

from __future__ import annotations

import pytest

from dnawaves.scene.environment import Environment
from dnawaves.system.saving import parts_between_checkpoints


def test_checkpoints_lie_some_twenty_seconds_apart() -> None:
    # 24 base pairs, both signs, frames of 30 steps: 2e7/(1521*2*30).
    assert parts_between_checkpoints(Environment(), 1521, 30, copies=2) == 219
    # However large the system, not more often than every frame.
    assert parts_between_checkpoints(Environment(), 10**6, 1000, copies=2) == 1


@pytest.mark.parametrize(("atoms", "ms_per_step"), [(760, 11.6), (1522, 46.2)])
def test_so_they_do_in_implicit_solvent(atoms: int, ms_per_step: float) -> None:
    # Times of benchmarks/solvent.py; 2 % is what two lengths differ from the square law.
    steps = parts_between_checkpoints(Environment(solvent="OBC2"), atoms, 1)
    assert steps * 1e-3 * ms_per_step == pytest.approx(20, rel=0.02)
