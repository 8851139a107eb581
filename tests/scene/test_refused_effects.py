"""Effects that contradict each other, or would do nothing, are refused with both of them named."""

from __future__ import annotations

from typing import Any

import pytest

from .conftest import refusal

IMPLICIT = {"solvent": "OBC2"}
WARM = {"solvent": "OBC2", "temperature_K": 300}


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (
            "by_mode.excitation.rod",
            "measured",
            "rod 'measured' contradicts wave 'bend': the duplex's first estimate is of extension",
        ),
        ("by_mode.excitation.rod", None, "modes and rod go together"),
        ("ranged.excitation.rod", "paper", "found modes None and rod 'paper'"),
        (
            "swept.excitation",
            {
                "kind": "periodic",
                "wave": "shear",
                "force_pN": 20,
                "sweep": {"scenes": ["kicked"]},
            },
            "sweep contradicts wave 'shear': it spans the modes of waves with one speed",
        ),
    ],
)
def test_a_mode_is_that_of_a_rod_that_is_known(
    write_configuration: Any, place: str, value: object, said: str
) -> None:
    message = refusal(write_configuration(f"scenes.{place}", value))
    assert message.startswith(f"{write_configuration()}: scene '{place.split('.')[0]}': excitation")
    assert said in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("place", "value", "first", "second"),
    [
        # Base pair 12 is held.
        (
            "kicked.excitation.first_pair",
            10,
            "an excitation of base pairs 12",
            "frozen base pairs 12",
        ),
        (
            "by_mode.excitation.first_pair",
            1,
            "excitation of base pairs 1",
            "frozen base pairs 1, 12",
        ),
        (
            "by_mode.observation",
            {"duration_ps": 9},
            "excitation.periods 4",
            "observation.duration_ps 9",
        ),
        ("kicked.replicas", 2, "replicas 2", "temperature_K 0"),
        ("kicked.thermostat", {"friction_per_ps": 1}, "thermostat", "temperature_K 0"),
        ("warm.replicas", 4, "replicas 4", "equilibration.snapshots 3"),
        ("warm.method", "harmonic", "method harmonic", "temperature_K 300"),
        ("loaded.environment", "warm", "kind static", "temperature_K 300"),
    ],
)
def test_effects_of_a_scene_that_contradict_each_other_are_both_named(
    write_configuration: Any, place: str, value: object, first: str, second: str
) -> None:
    message = refusal(write_configuration(f"scenes.{place}", value))
    assert message.startswith(f"{write_configuration()}: scene '{place.split('.')[0]}': ")
    assert f"{first} contradicts {second}: " in message
    assert message.count("contradicts") == 1


def test_constraints_and_frozen_ends_are_both_named(write_configuration: Any) -> None:
    message = refusal(write_configuration("environments.warm.constraints", "hbonds"))
    assert "scene 'warm': constraints hbonds contradicts frozen base pairs 12: " in message


@pytest.mark.parametrize(
    "ends",
    [
        {"first": "restrained"},
        {"stiffness_pN_per_nm": 100},
    ],
)
def test_springs_and_their_stiffness_go_together(
    write_configuration: Any, ends: dict[str, Any]
) -> None:
    message = refusal(write_configuration("scenes.warm.ends", ends))
    assert (
        "scene 'warm': ends: stiffness_pN_per_nm goes with an end that is 'restrained'" in message
    )


@pytest.mark.parametrize(
    ("environment", "first", "second"),
    [
        ({**IMPLICIT, "counterion_fraction": 1}, "counterion_fraction 1", "solvent OBC2"),
        ({**IMPLICIT, "cutoff_nm": 0.9}, "cutoff_nm 0.9", "solvent OBC2"),
        ({**IMPLICIT, "switch_nm": 0.8}, "switch_nm 0.8", "solvent OBC2"),
        ({"salt_M": 0.1}, "salt_M 0.1", "solvent none"),
        ({"surface_area": True}, "surface_area", "solvent none"),
        ({**WARM, "solvent": "TIP3P", "surface_area": True}, "surface_area", "solvent TIP3P"),
        ({"solvent": "GBn2"}, "solvent GBn2", "temperature_K 0"),
        ({"solvent": "OPC"}, "solvent OPC", "temperature_K 0"),
        ({"constraints": "hbonds"}, "constraints hbonds", "temperature_K 0"),
        ({"equilibration": {}}, "equilibration", "temperature_K 0"),
        ({"water": {}}, "water", "solvent none"),
        ({**WARM, "relaxation": {}}, "relaxation", "temperature_K 300"),
        (
            {**WARM, "equilibration": {"pressure_bar": 1}},
            "barostat",
            "solvent OBC2",
        ),
        (
            {**WARM, "solvent": "TIP3P", "counterion_fraction": 1},
            "counterion_fraction 1",
            "solvent TIP3P",
        ),
    ],
)
def test_effects_of_an_environment_that_contradict_each_other_are_both_named(
    write_configuration: Any, environment: dict[str, Any], first: str, second: str
) -> None:
    message = refusal(write_configuration("environments.condensed", environment))
    assert "environment 'condensed': " in message
    assert f"{first} contradicts {second}: " in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("scene", "pairs", "first", "second"),
    [
        # Base pair 12 is held.
        ("kicked", [12], "added mass on base pairs 12", "contradicts frozen base pairs 12"),
        ("exact", [3], "masses", "contradict method 'harmonic'"),
        ("loaded", [3], "masses", "contradict excitation.kind 'static'"),
        ("quiet", [3], "masses", "contradict excitation.kind 'none'"),
        ("kicked", [3, 3], "masses", "base pairs that differ, found [3, 3]"),
    ],
)
def test_added_mass_that_would_do_nothing_is_refused(
    write_configuration: Any, scene: str, pairs: list[int], first: str, second: str
) -> None:
    masses = [{"pair": pair, "mass_Da": 5000} for pair in pairs]
    message = refusal(write_configuration(f"scenes.{scene}.masses", masses))
    assert f"scene '{scene}': " in message
    assert first in message and second in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ({"first": 2, "last": 2, "twist_deg": 9}, "last must be above first (2), found 2"),
        ({"first": 2, "last": 4}, "give twist_deg, bend_deg or both, found neither"),
        ({"first": 2, "last": 13, "twist_deg": 9}, "start.last: found 13; allowed: 1 to 12"),
    ],
)
def test_a_start_that_turns_nothing_is_refused(
    write_configuration: Any, start: dict[str, Any], said: str
) -> None:
    message = refusal(write_configuration("environments.condensed.relaxation", {"start": start}))
    assert said in message
    assert "relaxation.start" in message
