"""The lattice with the constants of the same molecule, after the kick that a scene gave."""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr

from dnawaves.comparison.predictions import constant, long_wave_routes, straight_rod
from dnawaves.report.gather import SceneResults
from dnawaves.rod.chain import FiniteChain
from dnawaves.rod.rod import BEND_2, EXTENSION, SHEAR_1, TWIST, Rod
from dnawaves.scene.pairs import held_pairs
from dnawaves.units import A_PER_NM

# Which of the six coordinates a wave's field is; a length is Å on the page and nm in the chain.
COORDINATES = {"extension": EXTENSION, "twist": TWIST, "shear": SHEAR_1, "bend": BEND_2}
LENGTHS = ("extension", "shear")


def own_rod(constants: pd.DataFrame) -> tuple[Rod, str] | None:
    """Return the rod of the first route that knows all constants, and that route."""
    for route in long_wave_routes(constants):
        rod = straight_rod(constants, route)
        if rod is not None:
            return rod, route
    return None


def lattice_velocity(scene: SceneResults, wave: str, rod: Rod) -> xr.DataArray:
    """Return the velocity field (time, pair) of a wave on the coupled lattice, without friction.

    The lattice starts with the velocities of the scene's own first frame, in all four waves.
    """
    chain = FiniteChain(rod, scene.pairs, held_pairs(scene.spec.ends, scene.pairs))
    start = np.zeros((scene.pairs, 6))
    for name, coordinate in COORDINATES.items():
        field = scene.waves.get(f"{name}_velocity")
        if field is not None:
            start[:, coordinate] = field.values[0] / (A_PER_NM if name in LENGTHS else 1.0)
    times = scene.waves["time"].values
    velocity = chain.kick_response(times, start * chain.free)[1][:, :, COORDINATES[wave]]
    field = scene.waves[f"{wave}_velocity"]
    return field.copy(data=velocity * (A_PER_NM if wave in LENGTHS else 1.0))


def own_speed_A_per_ps(constants: pd.DataFrame, wave: str) -> float | None:
    """Return the speed of long waves by the first route that knows it."""
    for route in long_wave_routes(constants):
        speed = constant(constants, route, f"speed_{wave}_A_per_ps")
        if speed is not None:
            return speed.value
    return None
