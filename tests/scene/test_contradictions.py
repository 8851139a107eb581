"""Effects that exclude each other are found, both named; sound scenes pass."""

from __future__ import annotations

from typing import Any

import pytest

from dnawaves.scene.contradictions import contradictions


@pytest.mark.parametrize(
    ("declared", "first", "second"),
    [
        ({"solvent": "OPC", "counterion_fraction": 0.76}, "counterion_fraction 0.76", "OPC"),
        ({"solvent": "OBC2", "counterion_fraction": 1.0}, "counterion_fraction 1", "OBC2"),
        ({"salt_M": 0.1}, "salt_M 0.1", "solvent none"),
        ({"surface_area": True}, "surface_area", "solvent none"),
        ({"surface_area": True, "solvent": "OPC"}, "surface_area", "solvent OPC"),
        ({"solvent": "GBn2", "cutoff_nm": 0.9}, "cutoff_nm 0.9", "solvent GBn2"),
        ({"solvent": "OBC2", "switch_nm": 0.8}, "switch_nm 0.8", "solvent OBC2"),
        ({"barostat": True, "thermostat": True}, "barostat", "solvent none"),
        ({"barostat": True, "solvent": "TIP3P"}, "barostat", "no thermostat"),
        (
            {"barostat": True, "thermostat": True, "solvent": "TIP3P", "frozen": [0, 9]},
            "barostat",
            "frozen base pairs 1, 10",
        ),
        ({"thermostat": True, "conserves_energy": True}, "thermostat", "constant energy"),
        ({"constraints": "hbonds", "frozen": [0]}, "constraints hbonds", "frozen base pairs 1"),
        ({"loaded": [3, 9], "frozen": [9]}, "load on base pairs 10", "frozen base pairs 10"),
        ({"heavier": [0], "frozen": [0]}, "mass on base pairs 1", "frozen base pairs 1"),
        ({"excited": [1, 2], "frozen": [0, 1]}, "excitation of base pairs 2", "base pairs 1, 2"),
        ({"solvent": "GBn2", "temperature_K": 0}, "solvent GBn2", "temperature_K 0"),
        ({"solvent": "TIP3P", "temperature_K": 0}, "solvent TIP3P", "temperature_K 0"),
        ({"constraints": "hbonds", "temperature_K": 0}, "constraints hbonds", "temperature_K 0"),
        ({"equilibration": True, "temperature_K": 0}, "equilibration", "temperature_K 0"),
        ({"thermostat": True, "temperature_K": 0}, "thermostat", "temperature_K 0"),
        ({"replicas": 2, "temperature_K": 0}, "replicas 2", "temperature_K 0"),
        ({"relaxation": True, "temperature_K": 310}, "relaxation", "temperature_K 310"),
        ({"harmonic": True, "temperature_K": 310}, "method harmonic", "temperature_K 310"),
        ({"static": True, "temperature_K": 310}, "kind static", "temperature_K 310"),
        ({"replicas": 5, "snapshots": 4}, "replicas 5", "equilibration.snapshots 4"),
        ({"water": True}, "water", "solvent none"),
        ({"periods": 3.0, "duration_ps": 9.0}, "excitation.periods 3", "observation.duration_ps 9"),
    ],
)
def test_each_contradiction_is_named(declared: dict[str, Any], first: str, second: str) -> None:
    (found,) = contradictions(**declared)
    assert first in found.first
    assert second in found.second
    assert found.first in str(found) and found.second in str(found) and found.why in str(found)


@pytest.mark.parametrize(
    "declared",
    [
        {},
        {"counterion_fraction": 1.0, "conserves_energy": True, "frozen": [0, 23]},
        {"solvent": "OBC2", "salt_M": 0.15, "thermostat": True, "loaded": [23], "frozen": [0]},
        {"solvent": "OPC", "salt_M": 0.15, "barostat": True, "thermostat": True},
        {"solvent": "TIP3P", "constraints": "hbonds", "conserves_energy": True},
        {
            "solvent": "GBn2",
            "temperature_K": 300,
            "thermostat": True,
            "replicas": 4,
            "snapshots": 4,
        },
        {"solvent": "OPC", "barostat": True, "equilibration": True, "temperature_K": 300},
        {"temperature_K": 0, "harmonic": True, "relaxation": True, "excited": [0], "frozen": [9]},
    ],
)
def test_sound_scenes_have_none(declared: dict[str, Any]) -> None:
    assert contradictions(**declared) == []


def test_all_are_found_at_once() -> None:
    found = contradictions(
        solvent="OPC", counterion_fraction=1, barostat=True, conserves_energy=True, frozen=[0]
    )
    assert [one.first for one in found] == ["counterion_fraction 1"] + 3 * ["barostat"]
