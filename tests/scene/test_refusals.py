"""What cannot be run is refused; the message names file, scene, field, found and allowed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dnawaves.errors import InputError
from dnawaves.scene.duplexes import load_duplexes
from dnawaves.scene.load import load_scenes

from .conftest import refusal


def test_the_configuration_that_the_tests_spoil_is_valid(write_configuration: Any) -> None:
    assert len(load_scenes(write_configuration())) == 11


@pytest.mark.parametrize(
    ("place", "value", "found", "allowed"),
    [
        ("kicked.duplex", "mixed99", "'mixed99'", "mixed12, mixed8"),
        ("kicked.environment", "water", "'water'", "condensed, warm"),
        ("kicked.ends.first", "glued", "'glued'", "'free', 'held' or 'restrained'"),
        ("kicked.ends.pairs", 0, "0", "greater than or equal to 1"),
        ("kicked.ends.pairs", 11, "11", "less than or equal to 10"),
        ("quiet.ends.pairs", 6, "6", "at least 2 of the 12 base pairs stay free"),
        ("kicked.excitation.kind", "push", "'push'", "kick, none, periodic, pulse"),
        ("kicked.excitation.wave", "sound", "'sound'", "'extension', 'twist', 'bend'"),
        ("kicked.excitation.velocity_A_per_ps", -0.2, "-0.2", "greater than 0"),
        ("kicked.excitation.velocity_A_per_ps", "fast", "'fast'", "valid number"),
        ("kicked.excitation.velocity_A_per_ps", float("nan"), "nan", "finite number"),
        ("kicked.excitation.pairs", 11, "11", "fewer than the 11 free base pairs"),
        ("kicked.excitation.scales", [1, 1], "[1.0, 1.0]", "differ from each other"),
        ("kicked.excitation.scales", [], "[]", "at least 1 item"),
        ("standing.excitation.mode", 11, "11", "1 to 10, the number of free base pairs"),
        ("swept.excitation.sweep.scenes", ["quiet"], "'quiet'", "kicked"),
        ("swept.excitation.sweep.points", 1, "1", "greater than or equal to 2"),
        ("kicked.observation.timestep_fs", 5, "5", "less than or equal to 2.5"),
        ("kicked.observation.duration_ps", 0, "0", "greater than 0"),
        ("loaded.observation.helical", True, "true", "false"),
        # 50 and 100 GHz are driven; frames 5 ps apart resolve frequencies below 100 GHz.
        ("driven.observation.interval_fs", 5000.0, "100", "Nyquist frequency, 100 GHz"),
        ("driven.observation.interval_fs", 1.0, "1", "at least timestep_fs (2)"),
        # 19 fs are fewer than ten timesteps of 2 fs.
        ("pulsed.excitation.width_fs", 19.0, "19", "at least 10 timesteps, 20 fs"),
        ("standing.ends.first", "free", "ends.first 'free'", "needs both ends held"),
        ("loaded.ends.last", "free", "kind 'static' with 'held' and 'free'", "last 'guided'"),
        ("kicked.ends.last", "guided", "kind 'kick' with 'free' and 'guided'", "'static'"),
        ("kicked.method", "exact", "'exact'", "'simulated' or 'harmonic'"),
        ("loaded.method", "harmonic", "kind 'static'", "'kick', 'standing_wave', 'pulse'"),
        ("quiet.method", "harmonic", "kind 'none'", "without excitation nothing moves"),
        ("exact.observation.helical", True, "true", "method 'harmonic' knows base pairs"),
        ("driven.excitation.ramp_periods", -1, "-1", "greater than or equal to 0"),
        ("driven.excitation.frequencies_GHz", [50, 50], "[50.0, 50.0]", "differ from each other"),
        ("kicked.excitation.first_pair", 11, "11", "1 to 10, from which on 3 of the 12 base pairs"),
        ("kicked.excitation.first_pair", 0, "0", "greater than 0"),
        ("by_mode.excitation.modes", [1, 11], "[1, 11]", "1 to 10, the number of free base pairs"),
        ("by_mode.excitation.modes", [0], "0", "greater than or equal to 1"),
        ("by_mode.excitation.modes", [], "[]", "at least 1 item"),
        ("by_mode.excitation.rod", "textbook", "'textbook'", "'measured' or 'paper'"),
        ("by_mode.excitation.periods", 0, "0", "greater than 0"),
        ("ranged.excitation.range_GHz.points", 1, "1", "greater than or equal to 2"),
        ("ranged.excitation.range_GHz.from", -1, "-1", "greater than 0"),
        ("warm.replicas", 0, "0", "greater than or equal to 1"),
        ("kicked.masses", [{"pair": 13, "mass_Da": 9}], "13", "1 to 12, the number of base pairs"),
    ],
)
def test_a_bad_value(
    write_configuration: Any, place: str, value: object, found: str, allowed: str
) -> None:
    scene, _, field = place.partition(".")
    message = refusal(write_configuration(f"scenes.{place}", value))
    # Some refusals concern two fields at once and name the other one first.
    names = {field, "ends.last", "excitation.frequencies_GHz"}
    assert message.startswith(f"{write_configuration()}: scene '{scene}': ")
    assert any(name in message for name in names)
    assert f"found {found}" in message
    assert allowed in message
    assert "\n" not in message, "one mistake, one line"


def test_a_seed_that_openmm_cannot_take(write_configuration: Any) -> None:
    message = refusal(write_configuration("environments.condensed.relaxation.seed", 2**31))
    assert "relaxation.seed: found 2147483648; allowed: " in message


def test_a_drive_that_never_comes_to_its_strength(write_configuration: Any) -> None:
    message = refusal(write_configuration("scenes.by_mode.excitation.ramp_periods", 4))
    assert "scene 'by_mode': excitation: ramp_periods must be below periods (4)" in message
    assert "found 4" in message


def test_a_record_that_ends_before_its_pulse(write_configuration: Any) -> None:
    """A pulse is at its height five widths after the start."""
    excitation = {"kind": "pulse", "wave": "twist", "torque_pN_nm": 20, "width_fs": 500}
    scene = {"duplex": "mixed12", "environment": "condensed", "excitation": excitation}
    short = write_configuration("scenes.pulsed", {**scene, "observation": {"duration_ps": 2.5}})
    message = refusal(short)
    assert "scene 'pulsed': observation.duration_ps must be above 2.5" in message
    assert "width_fs 500" in message
    load_scenes(write_configuration("scenes.pulsed", {**scene, "observation": {"duration_ps": 3}}))


def test_an_amplitude_of_the_wrong_kind(write_configuration: Any) -> None:
    message = refusal(write_configuration("scenes.kicked.excitation.wave", "twist"))
    assert "scene 'kicked': excitation" in message
    assert "twist takes angular_velocity_rad_per_ps" in message
    assert "found velocity_A_per_ps" in message


@pytest.mark.parametrize("frequencies", [[50], None])
def test_a_drive_has_one_source_of_frequencies(
    write_configuration: Any, missing: object, frequencies: object
) -> None:
    place = "swept.excitation.frequencies_GHz" if frequencies else "swept.excitation.sweep"
    message = refusal(write_configuration(f"scenes.{place}", frequencies or missing))
    assert "scene 'swept': excitation" in message
    assert "either frequencies_GHz, range_GHz, sweep or modes" in message
    assert f"found {'frequencies_GHz and sweep' if frequencies else 'none'}" in message


def test_a_range_that_does_not_rise(write_configuration: Any) -> None:
    message = refusal(write_configuration("scenes.ranged.excitation.range_GHz.to", 40))
    assert "scene 'ranged': excitation.range_GHz: to must be above from (50), found 40" in message


def test_a_range_past_the_nyquist_frequency(write_configuration: Any) -> None:
    # Frames 6.25 ps apart resolve frequencies below 80 GHz, the last of the range.
    message = refusal(write_configuration("scenes.ranged.observation", {"interval_fs": 6250.0}))
    assert "below the recording's Nyquist frequency, 80 GHz" in message
    assert "found 80" in message


@pytest.mark.parametrize("place", ["duplex", "environment", "excitation", "excitation.kind"])
def test_a_value_left_out(write_configuration: Any, missing: object, place: str) -> None:
    message = refusal(write_configuration(f"scenes.kicked.{place}", missing))
    assert f"scene 'kicked': {place}: found nothing; allowed: " in message


def test_an_environment_is_refused_by_its_own_name(write_configuration: Any) -> None:
    message = refusal(write_configuration("environments.condensed.counterion_fraction", 1.5))
    assert "environment 'condensed': counterion_fraction: found 1.5; allowed: " in message
    message = refusal(write_configuration("environments.condensed.switch_nm", 0.9))
    assert "switch_nm must be below cutoff_nm (0.9), found 0.9" in message


def test_every_mistake_is_told_at_once(write_configuration: Any) -> None:
    path = write_configuration("scenes.kicked.observation", {"helicall": True, "crossings": -1})
    assert refusal(path).count("scene 'kicked': observation.") == 2


KNOWN_KEYS = {
    "": ["structures", "environments", "scenes"],
    "environments.condensed": ["force_field", "solvent", "salt_M", "cutoff_nm", "relaxation"],
    "scenes.kicked": ["duplex", "ends", "observation"],
    "scenes.kicked.ends": ["first", "last", "pairs"],
    "scenes.kicked.excitation": ["wave", "velocity_A_per_ps", "scales"],
    "scenes.kicked.observation": ["timestep_fs", "duration_ps", "crossings", "helical"],
    "scenes.swept.excitation.sweep": ["scenes", "points"],
    "scenes.ranged.excitation.range_GHz": ["from", "to", "points"],
    "scenes.by_mode.excitation": ["modes", "rod", "periods", "ramp_periods", "first_pair"],
}


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_any_misspelt_key_is_named_with_what_was_meant(
    write_configuration: Any, data: st.DataObject
) -> None:
    place = data.draw(st.sampled_from(sorted(KNOWN_KEYS)))
    key = data.draw(st.sampled_from(KNOWN_KEYS[place]))
    at = data.draw(st.integers(1, len(key) - 1))
    misspelt = key[:at] + key[at - 1 :]  # one letter twice
    path = write_configuration(f"{place}.{misspelt}" if place else misspelt, 1)
    message = refusal(path)
    parts = place.split(".")
    if parts[0]:
        assert f"{path}: {parts[0][:-1]} '{parts[1]}': " in message
    assert f"{'.'.join([*parts[2:], misspelt])}: found an unknown key" in message
    assert f"(did you mean '{key}'?)" in message
    assert "allowed: " in message


@settings(max_examples=40, deadline=None)
@given(
    place=st.sampled_from(
        [
            "ends.pairs",
            "excitation.velocity_A_per_ps",
            "excitation.pairs",
            "observation.timestep_fs",
            "observation.duration_ps",
            "observation.interval_fs",
        ]
    ),
    value=st.one_of(
        st.floats(max_value=0), st.just(float("inf")), st.text(alphabet="abc", min_size=1)
    ),
)
def test_no_number_below_zero_nor_text_is_taken(
    write_configuration: Any, place: str, value: object
) -> None:
    path = write_configuration(f"scenes.kicked.{place}", value)
    assert refusal(path).startswith(f"{path}: scene 'kicked': {place}: found {value!r}; allowed: ")


def test_a_scene_needs_a_name_that_a_path_can_hold(write_configuration: Any) -> None:
    message = refusal(write_configuration("scenes.up/down", {}))
    assert "scene 'up/down': name: found 'up/down'" in message


def test_a_missing_structures_file_is_named_with_the_field(write_configuration: Any) -> None:
    path = write_configuration("structures", "nowhere.yaml")
    assert refusal(path).startswith(f"{path}: structures: found 'nowhere.yaml'; allowed: ")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("short: ACG", "duplex 'short': sequence: found 3 base pairs in 'ACG'; allowed: 4 or more"),
        ("rna: ACGU", "duplex 'rna': sequence: found 'U' at position 4 of 'ACGU'; allowed: "),
        ("number: 12", "duplex 'number': found 12; allowed: "),
        ("- ACGT", "found ['ACGT']; allowed: a mapping of names to sequences"),
        ("up/down: ACGT", "duplex 'up/down': found 'up/down'; allowed: a letter first"),
        ("mine: {file: nowhere.pdb}", "duplex 'mine': file: found 'nowhere.pdb'; allowed: a PDB"),
        ("mine: {path: x.pdb}", "duplex 'mine': found {'path': 'x.pdb'}; allowed: a sequence"),
        ("mine: {file: 3}", "duplex 'mine': found {'file': 3}; allowed: a sequence"),
        ("mine: {file: duplexes.yaml}", "duplexes.yaml: file: found '.yaml'; allowed: .pdb"),
        ("twice: ACGT\ntwice: ACCT", "key 'twice' is given twice"),
    ],
)
def test_a_bad_sequence_is_named(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "duplexes.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_duplexes(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("scenes: [a, b", "is not valid YAML"),
        ("", "found None"),
        ("structures: a\nstructures: b", "key 'structures' is given twice"),
    ],
)
def test_a_file_that_is_no_configuration(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(text)
    assert refusal(path).startswith(f"{path}: ")
    assert said in refusal(path)


def test_a_missing_file(tmp_path: Path) -> None:
    assert refusal(tmp_path / "config.yaml").endswith("cannot be read: No such file or directory")
