"""A relaxation can start from a bent or overtwisted duplex."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.relax import relax, started

AsBuilt = Callable[..., SimulatedDuplex]


def turned_duplex(as_built: AsBuilt, **start: float) -> SimulatedDuplex:
    return as_built("CGATCG", relaxation={"start": {"first": 2, "last": 5, **start}})


def test_twist_is_shared_out_between_the_two_pairs(as_built: AsBuilt) -> None:
    built = turned_duplex(as_built, twist_deg=30)
    displacement, rotation = built.bodies.pose(started(built).positions_nm)
    along = np.rad2deg(rotation @ built.frame.axis)
    # Rigid pairs, turned about the axis by exact steps: round-off.
    np.testing.assert_allclose(along, [0, 0, 10, 20, 30, 30], atol=1e-6)
    np.testing.assert_allclose(displacement @ built.frame.axis, 0, atol=1e-9)


@pytest.mark.parametrize("direction_deg", [0, 90])
def test_a_bend_turns_about_its_direction(as_built: AsBuilt, direction_deg: float) -> None:
    built = turned_duplex(as_built, bend_deg=15, direction_deg=direction_deg)
    _, rotation = built.bodies.pose(started(built).positions_nm)
    about = built.frame.directions[0 if direction_deg == 0 else 1]
    # Exact steps again: round-off.
    np.testing.assert_allclose(
        np.rad2deg(rotation), np.outer([0, 0, 5, 10, 15, 15], about), atol=1e-6
    )


class EnoughError(Exception):
    """Ends a relaxation once it has said what is looked for."""


def test_the_relaxation_starts_from_there(as_built: AsBuilt) -> None:
    def annealed(**relaxation: object) -> str:
        said = []

        def report(line: str) -> None:
            said.append(line)
            if line.startswith("annealed"):
                raise EnoughError

        with pytest.raises(EnoughError):
            relax(as_built("CGAT", relaxation={"anneal_ps": 0.02, **relaxation}), 1, report)
        return said[-1]

    start = {"first": 1, "last": 4, "twist_deg": 40}
    assert annealed(start=start) != annealed()
    assert annealed() == annealed()
