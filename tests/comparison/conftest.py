"""A rod with known constants, as a table of constants, and scenes on duplexes of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pandas as pd
import pytest

from dnawaves.scene.models import SceneSpec

SEQUENCE = "CGATCAGTCAGCTAGCATGCGTAC"
EXCITATIONS: dict[str, dict[str, Any]] = {
    "standing": {
        "kind": "standing_wave",
        "wave": "extension",
        "mode": 1,
        "velocity_A_per_ps": 0.1,
    },
    "bend": {
        "kind": "standing_wave",
        "wave": "bend",
        "mode": 2,
        "angular_velocity_rad_per_ps": 0.1,
    },
    "kick": {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.1, "pairs": 3},
    "shear kick": {"kind": "kick", "wave": "shear", "velocity_A_per_ps": 0.1, "pairs": 3},
    "static": {"kind": "static", "wave": "extension", "force_pN": 100},
    "none": {"kind": "none"},
}


def constants_table(routes: dict[str, dict[str, object]]) -> pd.DataFrame:
    """Return constants by route; a value may be (value, low, high)."""
    rows = []
    for route, quantities in routes.items():
        for quantity, value in quantities.items():
            three = value if isinstance(value, tuple) else (value, None, None)
            rows.append((route, quantity, *three, "", ""))
    columns = ["route", "quantity", "value", "low", "high", "interval", "source"]
    return pd.DataFrame(rows, columns=columns).astype({"low": float, "high": float})


@pytest.fixture(name="constants_table")
def constants_table_fixture() -> Callable[..., pd.DataFrame]:
    return constants_table


@pytest.fixture
def scene() -> Callable[..., SceneSpec]:
    """Return a function that makes a scene of a kind, in a system of a name."""

    def make(
        name: str,
        kind: str = "standing",
        duplex: str = "d",
        environment: str = "e",
        sequence: str = SEQUENCE,
        **relaxation: object,
    ) -> SceneSpec:
        free = "kick" in kind
        return SceneSpec.model_validate(
            {
                "name": name,
                "system": {
                    "duplex": {"name": duplex, "sequence": sequence},
                    "environment_name": environment,
                    "environment": {"relaxation": relaxation},
                },
                "ends": {"first": "free" if free else "held", "last": "held"},
                "excitation": EXCITATIONS[kind],
                "observation": {},
            }
        )

    return make
