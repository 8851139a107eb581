"""Advice from a table whose errors are known: 0.25 % (h/fs)² and 3 % times the kick's scale."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from dnawaves.accuracy.advise import (
    Wanted,
    advise,
    choose,
    in_words,
    parse_error,
    parse_minutes,
    times,
)
from dnawaves.accuracy.match import family, row_of, shipped, unstudied
from dnawaves.accuracy.table import tables, write_csv
from dnawaves.errors import InputError
from dnawaves.scene.environment import Environment
from dnawaves.scene.models import NamedDuplex, SceneSpec, SystemSpec

from .conftest import row

CONFIG = Path(__file__).parents[2] / "config" / "config.yaml"


def scene(excitation: dict[str, object], **other: object) -> SceneSpec:
    return SceneSpec.model_validate(
        {
            "name": "one",
            "system": SystemSpec(
                duplex=NamedDuplex(name="ten", sequence="CGATCAGTCG"),
                environment_name="condensed",
                environment=Environment(),
            ),
            "ends": {},
            "excitation": excitation,
            "observation": {},
            **other,
        }
    )


KICK = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.1, "pairs": 3}


@pytest.mark.parametrize(
    ("error", "timestep_fs", "scale"),
    [
        # 5 %: the longest step, 1.6 + 3 %, is enough and cheapest; but at the same cost a smaller
        # kick errs less.
        (0.05, 2.5, 0.1),
        # 1.4 %: 2 fs errs by 1 + 0.3 %, 2.5 fs by 1.9 %.
        (0.014, 2.0, 0.1),
        # 0.5 %: half a fs more than is wanted at 1 fs, 0.25 + 0.3 %.
        (0.005, 0.5, 0.1),
    ],
)
def test_the_cheapest_that_meets_an_error(
    settings: pd.DataFrame, error: float, timestep_fs: float, scale: float
) -> None:
    rows = settings.assign(minutes=times(settings, 20.0))
    chosen = choose(rows, Wanted("waveform", error=error))
    assert chosen is not None
    assert (chosen["timestep_fs"], chosen["scale"]) == (timestep_fs, scale)


def test_time_goes_by_the_measured_ratio(settings: pd.DataFrame) -> None:
    # 20 minutes at 1 fs are 10 at the default's 2 fs, and 8 at 2.5 fs.
    minutes = times(settings, 20.0)
    assert minutes[settings["timestep_fs"] == 2.0].tolist() == [10.0, 10.0]
    assert minutes[settings["timestep_fs"] == 2.5].tolist() == [8.0, 8.0]


def test_the_least_error_within_a_time(settings: pd.DataFrame) -> None:
    rows = settings.assign(minutes=times(settings, 20.0))
    chosen = choose(rows, Wanted("waveform", minutes=12.0))
    assert chosen is not None
    assert (chosen["timestep_fs"], chosen["scale"]) == (2.0, 0.1)
    assert choose(rows, Wanted("waveform", minutes=1.0)) is None


def test_what_cannot_be_met_is_said_with_what_comes_nearest(settings: pd.DataFrame) -> None:
    rows = settings.assign(minutes=times(settings, 20.0))
    own = scene(KICK)
    words = in_words(own, rows, row_of(rows, own), Wanted("waveform", error=1e-4))
    assert words.startswith("no setting studied meets an error of 0.01 %")
    # The smallest error of the table: 0.5 fs and a tenth of the kick, 0.06 + 0.3 %.
    assert "velocity_A_per_ps: 0.01}" in words
    assert "timestep_fs: 0.5}" in words
    assert "error 0.36 %" in words
    assert "as it is: error 4 %" in words


def test_a_scene_finds_its_own_row(settings: pd.DataFrame) -> None:
    own = row_of(settings, scene(KICK))
    assert own is not None
    assert own["setting"] == "made-2-1"
    # A drive has no kick: only its timestep is chosen, at the size that it declares.
    drive = scene(
        {"kind": "periodic", "wave": "extension", "force_pN": 20, "frequencies_GHz": [100]},
        ends={"first": "held", "last": "held"},
    )
    assert set(family(settings, drive)["scale"]) == {1.0}
    twist = scene({"kind": "kick", "wave": "twist", "angular_velocity_rad_per_ps": 0.01})
    assert row_of(settings, twist) is None


def test_the_nearest_length_speaks_for_a_scene() -> None:
    rows = [row(2.0), row(2.0, setting="longer", base_pairs=24, case="long", usual_case="long")]
    own = row_of(tables(rows)[0], scene(KICK))
    assert own is not None
    assert own["setting"] == "made-2-1"


def test_scenes_without_a_timestep_say_so(settings: pd.DataFrame) -> None:
    exact = scene(KICK, method="harmonic")
    assert "no timestep" in unstudied(exact)
    nothing = scene({"kind": "none"})
    marks = shipped(settings, {"exact": exact, "nothing": nothing, "kick": scene(KICK)})
    assert marks["setting"].tolist() == ["", "", "made-2-1"]


def test_a_missing_study_names_the_command() -> None:
    with pytest.raises(InputError, match="snakemake --cores 2 accuracy"):
        advise(
            CONFIG,
            "extension_kick",
            Path("none"),
            Path("none/settings.csv"),
            Wanted("waveform", 0.02),
        )


def test_a_table_comes_back_from_disk(settings: pd.DataFrame, tmp_path: Path) -> None:
    from dnawaves.accuracy.table import read_csv

    write_csv(tmp_path / "settings.csv", settings)
    found = read_csv(tmp_path / "settings.csv")
    assert found["setting"].tolist() == settings["setting"].tolist()
    assert found["front_waveform"].tolist() == settings["front_waveform"].tolist()


@pytest.mark.parametrize(("text", "share"), [("2%", 0.02), ("0.5 %", 0.005), ("0.02", 0.02)])
def test_errors_are_read(text: str, share: float) -> None:
    assert parse_error(text) == share


@pytest.mark.parametrize(("text", "minutes"), [("30s", 0.5), ("10min", 10.0), ("2h", 120.0)])
def test_times_are_read(text: str, minutes: float) -> None:
    assert parse_minutes(text) == minutes


@pytest.mark.parametrize("text", ["", "x%", "-1%", "0", "nan", "2%%"])
def test_errors_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="--error: found"):
        parse_error(text)


@pytest.mark.parametrize("text", ["", "10", "min", "-3min", "nans", "infh"])
def test_times_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="--time: found"):
        parse_minutes(text)
