"""A valid configuration to spoil in one place."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from dnawaves.errors import InputError
from dnawaves.scene.load import load_scenes

SCENE = {"duplex": "mixed12", "environment": "condensed"}
BOTH_HELD = {"first": "held", "last": "held"}
CONFIGURATION: dict[str, Any] = {
    "structures": "duplexes.yaml",
    "environments": {
        "condensed": {"relaxation": {"anneal_ps": 2}},
        "warm": {"temperature_K": 300, "solvent": "OBC2", "equilibration": {"snapshots": 3}},
    },
    "scenes": {
        "kicked": {
            **SCENE,
            "excitation": {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.2},
        },
        "pulsed": {
            **SCENE,
            "excitation": {"kind": "pulse", "wave": "twist", "torque_pN_nm": 20},
        },
        "standing": {
            **SCENE,
            "ends": BOTH_HELD,
            "excitation": {
                "kind": "standing_wave",
                "wave": "bend",
                "mode": 2,
                "angular_velocity_rad_per_ps": 0.02,
                "scales": [1, 0.5],
            },
        },
        "driven": {
            **SCENE,
            "ends": BOTH_HELD,
            "excitation": {
                "kind": "periodic",
                "wave": "extension",
                "force_pN": 20,
                "frequencies_GHz": [50, 100],
            },
        },
        "swept": {
            **SCENE,
            "ends": BOTH_HELD,
            "excitation": {
                "kind": "periodic",
                "wave": "extension",
                "force_pN": 20,
                "sweep": {"scenes": ["kicked"], "points": 3},
            },
        },
        "by_mode": {
            **SCENE,
            "ends": BOTH_HELD,
            "excitation": {
                "kind": "periodic",
                "wave": "bend",
                "torque_pN_nm": 20,
                "modes": [1, 2, 3],
                "rod": "paper",
                "periods": 4,
                "ramp_periods": 1,
            },
        },
        "ranged": {
            **SCENE,
            "ends": BOTH_HELD,
            "excitation": {
                "kind": "periodic",
                "wave": "shear",
                "force_pN": 20,
                "range_GHz": {"from": 50, "to": 80, "points": 4},
                "first_pair": 5,
            },
        },
        "warm": {
            **SCENE,
            "environment": "warm",
            "replicas": 2,
            "excitation": {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 2},
        },
        "loaded": {
            **SCENE,
            "ends": {"first": "held", "last": "guided"},
            "excitation": {"kind": "static", "wave": "extension", "force_pN": 100},
        },
        "exact": {
            **SCENE,
            "excitation": {"kind": "kick", "wave": "shear", "velocity_A_per_ps": 0.1},
            "method": "harmonic",
        },
        "quiet": {**SCENE, "ends": BOTH_HELD, "excitation": {"kind": "none"}},
    },
}

MISSING = object()
Write = Callable[..., Path]


def refusal(path: Path) -> str:
    """Return the message with which a configuration file is refused."""
    with pytest.raises(InputError) as caught:
        load_scenes(path)
    return str(caught.value)


@pytest.fixture(scope="session")
def write_configuration(tmp_path_factory: pytest.TempPathFactory) -> Write:
    """Return a function that writes the configuration with one place changed.

    The place is a path of keys joined by dots; the value `MISSING` removes what stands there.
    """
    folder = tmp_path_factory.mktemp("configuration")
    (folder / "duplexes.yaml").write_text("mixed12: CGATCAGTCACG\nmixed8: CGATCACG\n")

    def write(place: str = "", value: Any = None) -> Path:
        # Unlike a deep copy, this leaves no two scenes with one and the same part.
        content = json.loads(json.dumps(CONFIGURATION))
        if place:
            *way, last = place.split(".")
            inner = content
            for key in way:
                inner = inner.setdefault(key, {})
            if value is MISSING:
                del inner[last]
            else:
                inner[last] = value
        path = folder / "config.yaml"
        path.write_text(yaml.safe_dump(content, sort_keys=False))
        return path

    return write


@pytest.fixture(scope="session")
def missing() -> object:
    """Return the value that removes a place from the configuration."""
    return MISSING
