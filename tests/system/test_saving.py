"""How often a long run is saved."""

from __future__ import annotations

import pytest

from dnawaves.scene.environment import Environment
from dnawaves.system.saving import steps_between_checkpoints


def test_checkpoints_lie_some_twenty_seconds_apart() -> None:
    # 24 base pairs without solvent at 1 µs an atom.
    steps = steps_between_checkpoints(Environment(), 1521)
    assert steps * 1521 * 1e-6 == pytest.approx(20)
    # In implicit solvent a step takes 46 ms (benchmarks/solvent.py).
    steps = steps_between_checkpoints(Environment(solvent="OBC2"), 1522)
    assert steps * 46e-3 == pytest.approx(20, rel=0.02)
    # Half the length a quarter of the time: 11.6 ms.
    steps = steps_between_checkpoints(Environment(solvent="OBC2"), 760)
    assert steps * 11.6e-3 == pytest.approx(20, rel=0.02)
