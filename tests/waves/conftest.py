"""Records of scenes whose truth is known: a lattice's own answer in the form of a simulation's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from dnawaves.scene.models import Ends, Environment, NamedDuplex, Observation, SceneSpec, SystemSpec
from dnawaves.waves.record import Record

PAIRS, SPACING_NM = 24, 0.34
MASS_DA, INERTIA_DA_NM2 = 600.0, (180.0, 180.0, 300.0)
TIMES_PS = np.arange(0, 9, 0.1)
Fields = dict[str, np.ndarray]


def scene(excitation: Any, first: str = "free", last: str = "held", name: str = "one") -> SceneSpec:
    return SceneSpec(
        name=name,
        system=SystemSpec(
            duplex=NamedDuplex(name="d", sequence="CGATCAGTCAGCTAGCATGCGTAC"),
            environment_name="e",
            environment=Environment(),
        ),
        ends=Ends(first=first, last=last),
        excitation=excitation,
        observation=Observation(),
    )


def motion(spec: SceneSpec, fields: Fields, **attrs: Any) -> xr.Dataset:
    """Return the record of two signs whose half difference has these velocities (time, pair).

    Fields by wave, in nm/ps and rad/ps; a straight duplex along z, centres on the axis.
    """
    frames = len(next(iter(fields.values())))
    nothing = np.zeros((frames, PAIRS))
    part = {
        wave: fields.get(wave, nothing)
        for wave in ("shear", "across", "extension", "bend_across", "bend", "twist")
    }
    linear = 10 * np.stack([part["shear"], part["across"], part["extension"]], axis=-1)
    angular = np.stack([part["bend_across"], part["bend"], part["twist"]], axis=-1)
    kinetic = 0.5 * MASS_DA * np.sum(linear**2, axis=(1, 2)) / 100 + 0.5 * np.sum(
        np.array(INERTIA_DA_NM2) * angular**2, axis=(1, 2)
    )
    dims = ("sign", "time", "pair", "xyz")
    signed = {
        name: (dims, np.stack([field, -field]))
        for name, field in (
            ("velocity", linear),
            ("angular_velocity", angular),
            ("displacement", 0 * linear),
            ("rotation", 0 * angular),
        )
    }
    pivot = np.outer(10 * SPACING_NM * np.arange(PAIRS), [0.0, 0.0, 1.0])
    return xr.Dataset(
        {
            **signed,
            "mass": (("pair",), np.full(PAIRS, MASS_DA)),
            "inertia": (
                ("pair", "xyz", "abc"),
                np.tile(100 * np.diag(INERTIA_DA_NM2), (PAIRS, 1, 1)),
            ),
            "pivot": (("pair", "xyz"), pivot),
            "centre": (("pair", "xyz"), pivot),
            "direction": (("axis", "xyz"), np.eye(3)),
            "difference_kinetic_energy": ("time", kinetic),
            # The work of a drive: never less than what moves.
            "work": (("sign", "time"), np.tile(np.maximum.accumulate(kinetic), (2, 1))),
        },
        coords={
            "sign": [1, -1],
            "axis": ["first", "second", "helix"],
            "time": 0.1 * np.arange(frames),
            "height": ("pair", pivot[:, 2]),
            "pair": [f"p{n}" for n in range(PAIRS)],
        },
        attrs={"scene": spec.model_dump_json(), **attrs},
    )


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., SceneSpec]:
    return scene


@pytest.fixture(scope="session")
def make_motion() -> Callable[..., xr.Dataset]:
    return motion


@pytest.fixture(scope="session")
def make_record() -> Callable[..., Record]:
    def make(spec: SceneSpec, member: str, fields: Fields, **attrs: Any) -> Record:
        return Record(spec, member, motion(spec, fields, **attrs))

    return make
