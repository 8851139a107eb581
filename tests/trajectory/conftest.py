"""Scenes of the relaxed duplex, made in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex

FREE = {"first": "free", "last": "free"}
HELD = {"first": "held", "last": "held"}
AMPLITUDES = {
    "extension": {"velocity_A_per_ps": 0.2},
    "shear": {"velocity_A_per_ps": 0.2},
    "twist": {"angular_velocity_rad_per_ps": 0.02},
    "bend": {"angular_velocity_rad_per_ps": 0.02},
}


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., SceneSpec]:
    """Return a function of a duplex, an excitation, the ends and the observation's fields."""

    def make(
        duplex: SimulatedDuplex,
        excitation: Mapping[str, Any],
        ends: Mapping[str, Any] = FREE,
        **observation: Any,
    ) -> SceneSpec:
        return SceneSpec.model_validate(
            {
                "name": "test",
                "system": duplex.spec,
                "ends": ends,
                "excitation": excitation,
                "observation": observation,
            }
        )

    return make


@pytest.fixture(scope="session")
def make_kick() -> Callable[..., dict[str, Any]]:
    """Return a function of a wave: the excitation of a kick, 0.2 Å/ps or 0.02 rad/ps."""

    def make(wave: str, **fields: Any) -> dict[str, Any]:
        return {"kind": "kick", "wave": wave, "pairs": 2, **AMPLITUDES[wave], **fields}

    return make
