"""What a scene resolves to: its system, its runs, and what they depend on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.errors import InputError
from dnawaves.files import read_json, write_json
from dnawaves.scene.duplexes import load_duplexes
from dnawaves.scene.environment import Equilibration
from dnawaves.scene.freeze import freeze, freeze_scene, freeze_system
from dnawaves.scene.load import load_scenes, read_scene, read_system
from dnawaves.scene.models import Ends, Environment, NamedDuplex
from dnawaves.scene.pairs import held_counts, held_pairs
from dnawaves.scene.table import scene_table
from dnawaves.system.forces import load_force_field


def test_names_are_resolved(write_configuration: Any) -> None:
    system = load_scenes(write_configuration())["kicked"].system
    assert system.name == "mixed12-condensed"
    assert system.duplex.sequence == "CGATCAGTCACG"
    assert system.environment.to_minimum.anneal_ps == 2


@pytest.mark.parametrize(
    ("scene", "members", "signs", "needs"),
    [
        ("kicked", ("x1",), ("plus", "minus"), ()),
        ("standing", ("x1", "x0.5"), ("plus", "minus"), ()),
        ("driven", ("f1", "f2"), ("plus", "minus"), ()),
        ("swept", ("f1", "f2", "f3"), ("plus", "minus"), ("kicked",)),
        ("by_mode", ("f1", "f2", "f3"), ("plus", "minus"), ()),
        ("ranged", ("f1", "f2", "f3", "f4"), ("plus", "minus"), ()),
        ("warm", ("x1r1", "x1r2"), ("plus", "minus"), ()),
        ("loaded", ("x1",), ("plus", "minus"), ()),
        ("exact", ("x1",), ("plus", "minus"), ()),
        ("quiet", ("run",), ("plus",), ()),
    ],
)
def test_runs_of_a_scene(
    write_configuration: Any,
    scene: str,
    members: tuple[str, ...],
    signs: tuple[str, ...],
    needs: tuple[str, ...],
) -> None:
    spec = load_scenes(write_configuration())[scene]
    assert (spec.members, spec.signs, spec.needs) == (members, signs, needs)


@pytest.mark.parametrize(
    ("ends", "counts", "held"),
    [
        (Ends(first="free", last="free"), (0, 0), []),
        (Ends(first="free", last="held", pairs=2), (0, 2), [10, 11]),
        (Ends(first="held", last="held"), (1, 1), [0, 11]),
        (Ends(first="held", last="guided", pairs=3), (3, 0), [0, 1, 2]),
    ],
)
def test_held_base_pairs(ends: Ends, counts: tuple[int, int], held: list[int]) -> None:
    assert held_counts(ends) == counts
    assert held_pairs(ends, 12) == held


@pytest.mark.parametrize("kind", ["standing", "driven"])
def test_springs_may_hold_what_a_standing_wave_needs_held(
    write_configuration: Any, kind: str
) -> None:
    springs = {"first": "restrained", "last": "restrained", "stiffness_pN_per_nm": 4e5}
    scene = load_scenes(write_configuration(f"scenes.{kind}.ends", springs))[kind]
    assert held_pairs(scene.ends, 12) == []


def test_what_is_left_out_of_an_environment_follows_from_its_solvent() -> None:
    def filled_in(**given: Any) -> tuple[float | None, ...]:
        environment = Environment.model_validate(given)
        # As a file that was frozen reads back.
        assert Environment.model_validate_json(environment.model_dump_json()) == environment
        return environment.counterion_fraction, environment.cutoff_nm, environment.switch_nm

    assert filled_in() == (1, 0.9, 0.8)
    assert filled_in(counterion_fraction=0, cutoff_nm=1.2) == (0, 1.2, 0.8)
    assert filled_in(solvent="OBC2") == (0, None, None)
    assert Environment() == Environment(counterion_fraction=1, cutoff_nm=0.9, switch_nm=0.8)


@pytest.mark.parametrize("given", [Equilibration, dict])
def test_water_is_put_under_pressure_unless_the_environment_says_not(given: Any) -> None:
    def pressure_bar(**equilibration: Any) -> float | None:
        steady = given(**equilibration)
        environment = Environment(solvent="OPC", temperature_K=300, equilibration=steady)
        assert environment.to_snapshots.seed == 7
        return environment.to_snapshots.pressure_bar

    assert pressure_bar(seed=7) == 1
    assert pressure_bar(seed=7, pressure_bar=5) == 5
    assert pressure_bar(seed=7, pressure_bar=None) is None


def test_models_are_frozen() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Environment().cutoff_nm = 2.0  # type: ignore[misc]


def test_a_frozen_scene_and_system_read_back_as_they_were(
    write_configuration: Any, tmp_path: Path
) -> None:
    path = write_configuration()
    for name, scene in load_scenes(path).items():
        freeze_scene(path, name, tmp_path / "scene.json")
        assert read_scene(tmp_path / "scene.json") == scene
        freeze_system(path, scene.system.name, tmp_path / "system.json")
        assert read_system(tmp_path / "system.json") == scene.system


def test_freezing_an_unknown_name_lists_the_known(write_configuration: Any, tmp_path: Path) -> None:
    path = write_configuration()
    with pytest.raises(
        InputError,
        match=r"scene: found 'kick' \(did you mean 'kicked'\?\); allowed: by_mode, driven, exact",
    ):
        freeze(path, "kick", None, tmp_path / "scene.json")
    with pytest.raises(
        InputError, match="system: found 'x'; allowed: mixed12-condensed, mixed12-warm"
    ):
        freeze(path, None, "x", tmp_path / "system.json")
    with pytest.raises(InputError, match="either --scene or --system"):
        freeze(path, None, None, tmp_path / "neither.json")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("broken", ["{}", "[1]", "{"])
def test_a_file_that_was_not_frozen_is_refused_by_name(tmp_path: Path, broken: str) -> None:
    path = tmp_path / "scene.json"
    path.write_text(broken)
    with pytest.raises(InputError, match=r"scene\.json: "):
        read_scene(path)


def test_a_frozen_scene_with_one_key_too_many_is_refused(
    write_configuration: Any, tmp_path: Path
) -> None:
    path = tmp_path / "scene.json"
    freeze_scene(write_configuration(), "quiet", path)
    write_json(path, {**read_json(path), "colour": "blue"})
    with pytest.raises(InputError, match="colour"):
        read_scene(path)


def test_the_table_has_a_line_for_each_scene(write_configuration: Any) -> None:
    header, *lines = scene_table(load_scenes(write_configuration())).splitlines()
    assert header.split() == [
        "scene",
        "duplex",
        "bp",
        "environment",
        "ends",
        "excitation",
        "method",
        "runs",
    ]
    assert lines[2].split() == [
        "standing",
        "mixed12",
        "12",
        "condensed",
        "held-held",
        "standing_wave",
        "bend",
        "simulated",
        "x1",
        "x0.5",
    ]


def test_a_part_that_is_used_again_may_be_changed_where_it_is_used(
    write_configuration: Any,
) -> None:
    path = write_configuration()
    path.write_text(
        """
structures: duplexes.yaml
environments: {condensed: {}}
scenes:
  one: &one
    duplex: mixed12
    environment: condensed
    ends: &held {first: held, last: held}
    excitation: &kick {kind: kick, wave: extension, velocity_A_per_ps: 0.2}
  other: {<<: *one, duplex: mixed8}
  third: {<<: *one, ends: {<<: *held, pairs: 2}, excitation: {<<: *kick, pairs: 4}}
"""
    )
    scenes = load_scenes(path)
    assert scenes["other"].excitation == scenes["one"].excitation
    assert [its.system.duplex.name for its in scenes.values()] == ["mixed12", "mixed8", "mixed12"]
    assert scenes["third"].ends == Ends(first="held", last="held", pairs=2)
    assert scenes["third"].excitation.pairs == 4  # type: ignore[union-attr]
    assert scenes["one"].excitation.pairs == 3  # type: ignore[union-attr]


def test_a_users_own_structure_is_a_duplex(tmp_path: Path) -> None:
    topology, positions = build_duplex("CGATCG", load_force_field(Environment()))
    write_pdb(topology, positions, tmp_path / "mine.pdb")
    (tmp_path / "duplexes.yaml").write_text("mine: {file: mine.pdb}\nother: CGCG\n")
    mine, other = load_duplexes(tmp_path / "duplexes.yaml").values()
    assert (mine.name, mine.sequence) == ("mine", "CGATCG")
    assert mine.file == str(tmp_path / "mine.pdb")
    assert other == NamedDuplex(name="other", sequence="CGCG")
    # Another content is another duplex, whose results must not stand in for the first's.
    shifted = positions + 0.01
    write_pdb(topology, shifted, tmp_path / "mine.pdb")
    assert load_duplexes(tmp_path / "duplexes.yaml")["mine"].digest != mine.digest
