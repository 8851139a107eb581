"""The null: an undisturbed duplex shows no wave, and one that moves by itself is told from it."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from dnawaves.scene.excitations import Nothing
from dnawaves.scene.models import Ends, Environment, NamedDuplex, Observation, SceneSpec, SystemSpec
from dnawaves.waves.analyse import analyse
from dnawaves.waves.record import Record

PAIRS, TIMES = 10, 30
NULL = SceneSpec(
    name="null_run",
    system=SystemSpec(
        duplex=NamedDuplex(name="d", sequence="CGATCAGTCG"),
        environment_name="e",
        environment=Environment(),
    ),
    ends=Ends(first="held", last="held"),
    excitation=Nothing(kind="none"),
    observation=Observation(),
)


def undisturbed(velocity_A_per_ps: float) -> xr.Dataset:
    """Return the record of a null in which every free pair moves along the axis at one speed."""
    dims = ("sign", "time", "pair", "xyz")
    nothing = np.zeros((1, TIMES, PAIRS, 3))
    moving = nothing.copy()
    moving[..., 1:-1, 2] = velocity_A_per_ps
    pivot = np.outer(3.4 * np.arange(PAIRS), [0.0, 0.0, 1.0])
    return xr.Dataset(
        {
            "velocity": (dims, moving),
            **{name: (dims, nothing) for name in ("displacement", "rotation", "angular_velocity")},
            "pivot": (("pair", "xyz"), pivot),
            "centre": (("pair", "xyz"), pivot),
            "direction": (("axis", "xyz"), np.eye(3)),
            "difference_kinetic_energy": ("time", np.zeros(TIMES)),
            "work": (("sign", "time"), np.zeros((1, TIMES))),
        },
        coords={
            "sign": [1],
            "axis": ["first", "second", "helix"],
            "time": 0.1 * np.arange(TIMES),
            "height": ("pair", pivot[:, 2]),
            "pair": [f"p{n}" for n in range(PAIRS)],
        },
    )


@pytest.mark.parametrize(("velocity", "found"), [(2e-5, "no wave"), (5e-3, "moves by itself")])
def test_a_null_is_judged_by_what_moved(velocity: float, found: str) -> None:
    estimates = analyse([Record(NULL, "run", undisturbed(velocity))])
    by_wave = {estimate.wave: estimate for estimate in estimates}
    assert set(by_wave) == {"extension", "twist", "bend", "shear"}
    assert by_wave["extension"].reason.startswith(found)
    assert f"{velocity:.2g} Å/ps" in by_wave["extension"].reason
    assert by_wave["twist"].reason.startswith("no wave")
    assert all(estimate.speed_A_per_ps is None for estimate in estimates)
