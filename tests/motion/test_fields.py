"""The fields of the four waves from motions that are one wave and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from dnawaves.motion.fields import WAVE_COMPONENTS, energy_put_in, wave_fields

PAIRS, TIMES = 8, 5


def recorded(velocity: np.ndarray, angular: np.ndarray, signs: tuple[int, ...]) -> xr.Dataset:
    """Return a record of centres that wind about a tilted axis, moving as told (pair, xyz)."""
    directions = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    heights = 3.4 * np.arange(PAIRS)
    pivot = heights[:, None] * directions[2]
    phase = np.deg2rad(36 * np.arange(PAIRS))
    radial = np.cos(phase)[:, None] * directions[0] + np.sin(phase)[:, None] * directions[1]
    centre = pivot + 1.2 * radial
    growth = np.linspace(1, 2, TIMES)[None, :, None, None]
    factor = np.array(signs)[:, None, None, None] * growth
    dims = ("sign", "time", "pair", "xyz")
    return xr.Dataset(
        {
            "velocity": (dims, factor * velocity),
            "angular_velocity": (dims, factor * angular),
            "displacement": (dims, factor * velocity),
            "rotation": (dims, factor * angular),
            "pivot": (("pair", "xyz"), pivot),
            "centre": (("pair", "xyz"), centre),
            "direction": (("axis", "xyz"), directions),
            "difference_kinetic_energy": ("time", np.linspace(2.0, 1.0, TIMES)),
            "work": (("sign", "time"), np.zeros((len(signs), TIMES))),
        },
        coords={
            "sign": list(signs),
            "axis": ["first", "second", "helix"],
            "time": np.arange(TIMES) * 0.1,
            "height": ("pair", heights),
            "pair": [f"p{n}" for n in range(PAIRS)],
        },
    )


@pytest.mark.parametrize("wave", WAVE_COMPONENTS)
def test_a_pure_wave_shows_in_its_own_field_only(wave: str) -> None:
    part, direction = WAVE_COMPONENTS[wave]
    empty = recorded(np.zeros((PAIRS, 3)), np.zeros((PAIRS, 3)), (1, -1))
    along = empty["direction"].sel(axis=direction).values
    amplitude = np.sin(np.arange(PAIRS))[:, None]
    if part == "linear":
        velocity, angular = amplitude * along, np.zeros((PAIRS, 3))
    else:
        # Turning about an axis through the pivot carries the centre, which is beside it, along.
        angular = amplitude * along
        velocity = np.cross(angular, empty["centre"].values - empty["pivot"].values)
    fields = wave_fields(recorded(velocity, angular, (1, -1)))
    for other in WAVE_COMPONENTS:
        expected = amplitude[:, 0] if other == wave else np.zeros(PAIRS)
        np.testing.assert_allclose(fields[f"{other}_velocity"].values[0], expected, atol=1e-12)
        np.testing.assert_allclose(fields[f"{other}_displacement"].values[0], expected, atol=1e-12)


def test_what_both_signs_share_cancels() -> None:
    rng = np.random.default_rng(2)
    kick, shared = rng.standard_normal((2, PAIRS, 3))
    motion = recorded(kick, np.zeros((PAIRS, 3)), (1, -1))
    drifting = motion.copy()
    drifting["velocity"] = motion["velocity"] + xr.DataArray(shared, dims=("pair", "xyz"))
    for name, field in wave_fields(motion).data_vars.items():
        np.testing.assert_allclose(wave_fields(drifting)[name].values, field.values, atol=1e-12)


def test_a_null_is_not_differenced_and_nothing_was_put_in() -> None:
    rng = np.random.default_rng(3)
    motion = recorded(rng.standard_normal((PAIRS, 3)), np.zeros((PAIRS, 3)), (1,))
    assert np.any(wave_fields(motion)["extension_velocity"].values != 0)
    assert not energy_put_in(motion).values.any()


def test_a_drive_has_put_in_the_most_work_so_far() -> None:
    motion = recorded(np.zeros((PAIRS, 3)), np.zeros((PAIRS, 3)), (1, -1))
    motion["difference_kinetic_energy"] = ("time", np.zeros(TIMES))
    motion["work"] = (("sign", "time"), np.array([[0.0, 1, 3, 2, 4], [0.0, 1, 3, 2, 4]]))
    np.testing.assert_array_equal(energy_put_in(motion).values, [0, 1, 3, 3, 4])
