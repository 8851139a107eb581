"""`dnawaves helical`: files in, files out, and a message for each misuse."""

from __future__ import annotations

import gc
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import MDAnalysis
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from typer.testing import CliRunner

from dnawaves.cli import app
from dnawaves.errors import InputError
from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.steps import helical_step

pytestmark = [
    pytest.mark.filterwarnings("ignore::UserWarning:MDAnalysis"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:MDAnalysis"),
]

FRAMES = 11
STEP_COLUMNS = (
    "frame,time_ps,step,pair_1,pair_2,shift_A,slide_A,rise_A,tilt_deg,roll_deg,twist_deg,flags"
)
PAIR_COLUMNS = (
    "frame,time_ps,pair,base_1,base_2,"
    "shear_A,stretch_A,stagger_A,buckle_deg,propeller_deg,opening_deg,flags"
)
Maker = Callable[[str], MDAnalysis.Universe]


@pytest.fixture
def files(make_universe: Maker, make_dcd: Callable[..., Path], tmp_path: Path) -> tuple[Path, Path]:
    """Return a structure and a noisy trajectory of it, in whose fourth frame a pair is open."""
    universe = make_universe("CGATTA")
    universe.add_TopologyAttr("chainIDs", universe.atoms.segids)
    structure = tmp_path / "duplex.pdb"
    universe.atoms.write(str(structure))
    still = universe.atoms.positions
    frames = still + np.random.default_rng(1).normal(scale=0.1, size=(FRAMES, *still.shape))
    frames[3, universe.select_atoms("segid A and resid 2").indices] += [7, 0, 0]
    return structure, make_dcd(tmp_path / "moving.dcd", frames)


def test_netcdf_is_the_data_set_of_the_analysis(files: tuple[Path, Path], tmp_path: Path) -> None:
    output = tmp_path / "new" / "out.nc"
    helical_step(files[0], [files[1]], output)
    expected = HelicalParameters(MDAnalysis.Universe(*map(str, files))).run().results.dataset
    with xr.open_dataset(output) as found:
        # Blocks are worked on in matrix products of another size.
        xr.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)
        assert found.twist.units == "degree" and found.time.units == "ps"
        assert found.pair_flag.attrs["flag_meanings"].split()[3] == "open"
        assert found.attrs["version_MDAnalysis"] == MDAnalysis.__version__


def test_a_file_of_many_blocks(
    files: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, parts = tmp_path / "whole.nc", tmp_path / "parts.nc"
    helical_step(files[0], [files[1]], whole)
    monkeypatch.setattr("dnawaves.helical.blocks._BLOCK_BYTES", 0)
    monkeypatch.setattr("dnawaves.helical.compute._CHUNK", 4 * 12)
    helical_step(files[0], [files[1]], parts)
    with xr.open_dataset(whole) as one, xr.open_dataset(parts) as other:
        xr.testing.assert_allclose(one, other, rtol=0, atol=1e-10)
        assert one.sizes == other.sizes


@pytest.mark.parametrize("workers", [1, 2])
def test_tables(files: tuple[Path, Path], tmp_path: Path, workers: int) -> None:
    output = tmp_path / "out.csv"
    helical_step(files[0], [files[1]], output, start=1, step=2, workers=workers)
    assert output.read_text().splitlines()[0] == STEP_COLUMNS
    assert (tmp_path / "out.pairs.csv").read_text().splitlines()[0] == PAIR_COLUMNS
    expected = HelicalParameters(MDAnalysis.Universe(*map(str, files))).run(start=1, step=2)
    for file, dimension, names in (
        (output, "step", STEP_PARAMETERS),
        (tmp_path / "out.pairs.csv", "pair", PAIR_PARAMETERS),
    ):
        table = pd.read_csv(file)
        dataset = expected.results.dataset
        assert len(table) == 5 * dataset.sizes[dimension]
        assert table["frame"].unique().tolist() == [1, 3, 5, 7, 9]
        np.testing.assert_allclose(table["time_ps"].unique(), [1, 3, 5, 7, 9])
        for name in names:
            (column,) = (column for column in table if column.startswith(name))
            # Four decimals are written.
            np.testing.assert_allclose(table[column], dataset[name].values.ravel(), atol=5.1e-5)
    pairs = pd.read_csv(tmp_path / "out.pairs.csv")
    assert pairs.loc[pairs["flags"] == "open", ["frame", "base_1", "base_2"]].values.tolist() == [
        [3, "A:2", "B:5"]
    ]


def test_what_is_undefined_is_blank(make_universe: Maker, tmp_path: Path) -> None:
    universe = make_universe("CGATTA")
    universe.add_TopologyAttr("chainIDs", universe.atoms.segids)
    stub = universe.select_atoms("not (segid A and resid 3 and not name P OP1 OP2 *' N9)")
    stub.write(str(tmp_path / "stub.pdb"))
    with pytest.warns(UserWarning, match="its frame is undefined"):
        helical_step(tmp_path / "stub.pdb", [], tmp_path / "out.csv")
    table = pd.read_csv(tmp_path / "out.csv")
    assert table["twist_deg"].isna().tolist() == [False, True, True, False, False]
    assert table["flags"][1] == "no_frame|ring_atoms_missing"
    assert ",,,,,,no_frame" in (tmp_path / "out.csv").read_text()


def test_trajectories_one_after_the_other(files: tuple[Path, Path], tmp_path: Path) -> None:
    structure, trajectory = files
    arguments = ["helical", str(structure), str(trajectory), str(trajectory)]
    output = tmp_path / "out.nc"
    run = CliRunner().invoke(app, [*arguments, "--output", str(output), "--no-frames"])
    assert run.exit_code == 0, run.output
    with xr.open_dataset(output) as found:
        assert found.sizes["time"] == 2 * FRAMES
        assert "axes" not in found
        # Chunks end elsewhere: matrix products of another size.
        np.testing.assert_allclose(found.twist[:FRAMES], found.twist[FRAMES:], atol=1e-10)
        assert (np.diff(found.time) > 0).all()


def test_pairs_from_a_file(files: tuple[Path, Path], tmp_path: Path) -> None:
    pairs = tmp_path / "pairs.csv"
    pairs.write_text("chain1,resid1,chain2,resid2\nA,2,B,5\nA,3,B,4\n")
    helical_step(files[0], [], tmp_path / "out.csv", pairs)
    assert pd.read_csv(tmp_path / "out.csv")["pair_1"].tolist() == ["A:2-B:5"]


def test_a_structure_alone_says_how_precise_it_is(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    helical_step(files[0], [], tmp_path / "out.nc")
    assert "rounded to 0.001 Å" in capsys.readouterr().err
    with xr.open_dataset(tmp_path / "out.nc") as found:
        assert "0.001 Å" in found.attrs["coordinate_precision"]
        assert found.sizes["time"] == 1
    helical_step(files[0], [files[1]], tmp_path / "dcd.nc")
    assert "rounded" not in capsys.readouterr().err


def test_mmcif(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    gemmi = pytest.importorskip("gemmi", reason="MDAnalysis reads mmCIF with gemmi")
    structure = gemmi.read_structure(str(files[0]))
    structure.setup_entities()
    mmcif = tmp_path / "duplex.cif"
    structure.make_mmcif_document().write_file(str(mmcif))
    for source, name in ((files[0], "pdb.csv"), (mmcif, "cif.csv")):
        helical_step(source, [], tmp_path / name)
        assert "rounded to 0.001 Å" in capsys.readouterr().err
    assert (tmp_path / "pdb.csv").read_text() == (tmp_path / "cif.csv").read_text()
    second = structure[0].clone()
    second.num = 2
    structure.add_model(second)
    structure.make_mmcif_document().write_file(str(mmcif))
    with pytest.warns(UserWarning, match="has 2 models, but only the first one"):
        helical_step(mmcif, [], tmp_path / "first.csv")
    assert (tmp_path / "pdb.csv").read_text() == (tmp_path / "first.csv").read_text()


def test_a_trajectory_of_another_topology(
    files: tuple[Path, Path], make_dcd: Callable[..., Path], tmp_path: Path
) -> None:
    other = make_dcd(tmp_path / "other.dcd", np.zeros((2, 5, 3)))
    with pytest.raises(InputError, match=r"other.dcd: cannot be read with .*duplex.pdb"):
        helical_step(files[0], [other], tmp_path / "out.nc")
    atoms = MDAnalysis.Universe(str(files[0])).atoms
    shuffled = make_dcd(tmp_path / "shuffled.dcd", atoms.positions[::-1][None])
    with pytest.raises(InputError, match=r"duplex.pdb: .*same atoms in the same order"):
        helical_step(files[0], [shuffled], tmp_path / "out.nc")
    assert not list(tmp_path.glob("*.nc"))


def test_an_error_in_a_later_frame_names_the_trajectory_and_leaves_no_file(
    files: tuple[Path, Path], make_dcd: Callable[..., Path], tmp_path: Path
) -> None:
    still = MDAnalysis.Universe(str(files[0])).select_atoms("all").positions
    jumped = still.copy()
    jumped[len(still) // 2 :] += [50, 0, 0]
    broken = make_dcd(tmp_path / "broken.dcd", np.array([still, jumped]))
    for workers in (1, 2):
        with pytest.raises(InputError, match=r"broken.dcd: frame 1: the strands do not lie"):
            helical_step(files[0], [broken], tmp_path / "out.csv", workers=workers)
    assert not list(tmp_path.glob("*.csv"))


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ({"start": 20}, "choose none of the 11 frames"),
        ({"step": 0}, "--start, --stop, --step"),
    ],
)
def test_frames_that_there_are_not(
    files: tuple[Path, Path], tmp_path: Path, chosen: dict[str, int], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        helical_step(files[0], [files[1]], tmp_path / "out.nc", **chosen)


def test_no_input_is_overwritten(
    files: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    structure, trajectory = files
    pairs = tmp_path / "out.pairs.csv"
    pairs.write_text("chain1,resid1,chain2,resid2\nA,2,B,5\nA,3,B,4\n")
    amber = tmp_path / "run.nc"
    amber.write_bytes(trajectory.read_bytes())
    (tmp_path / "link.nc").symlink_to(amber)
    monkeypatch.chdir(tmp_path)
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    for trajectories, listed, output in (
        ([], pairs, Path("out.csv")),
        ([], pairs, pairs),
        ([trajectory, Path("run.nc")], None, amber),
        ([amber], None, tmp_path / "link.nc"),
        ([Path("link.nc")], None, Path("nowhere/../run.nc").resolve()),
    ):
        with pytest.raises(InputError, match="would be written, but it is read as"):
            helical_step(structure, trajectories, output, listed)
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before


@pytest.mark.parametrize("ending", ["nc", "csv"])
def test_an_output_that_cannot_be_written(
    files: tuple[Path, Path], tmp_path: Path, ending: str
) -> None:
    (tmp_path / f"folder.{ending}").mkdir()
    for output in (
        files[0] / f"out.{ending}",  # within a file
        tmp_path / f"folder.{ending}",
        tmp_path / f"{300 * 'n'}.{ending}",  # names have 255 bytes at most
    ):
        # The output is at fault: the trajectory, which is being read then, is not blamed.
        with pytest.raises(InputError, match=rf"^{output.parent}/.*: cannot be written: "):
            helical_step(files[0], [files[1]], output)
    assert {file.name for file in tmp_path.iterdir()} == {
        "duplex.pdb",
        "moving.dcd",
        f"folder.{ending}",
    }


def test_no_noise(
    files: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    unraisable: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", unraisable.append)
    empty = tmp_path / "empty.dcd"
    empty.touch()
    with warnings.catch_warnings():
        # What would be printed.
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", ResourceWarning)
        helical_step(files[0], [], tmp_path / "out.csv")
        with pytest.raises(InputError, match=r"empty.dcd: cannot be read with"):
            helical_step(files[0], [empty], tmp_path / "none.csv")
    assert capsys.readouterr().err.splitlines() == [
        "Note: coordinates are rounded to 0.001 Å in the file: angles are off by up to 0.03 degrees"
    ]
    gc.collect()
    assert not unraisable


def test_a_pair_list_without_chains(make_universe: Maker, tmp_path: Path) -> None:
    # GRO has no chains: both strands number from 1.
    structure = tmp_path / "duplex.gro"
    make_universe("CGATTA").atoms.write(str(structure))
    helical_step(structure, [], tmp_path / "found.csv")
    found = pd.read_csv(tmp_path / "found.pairs.csv")
    assert found["base_1"].tolist() == [f"SYSTEM:{n}#{n}" for n in range(1, 7)]
    assert found["base_2"].tolist() == [f"SYSTEM:{n}#{n + 6}" for n in range(6, 0, -1)]
    listed = tmp_path / "listed.csv"
    lines = [", #1, , #12", "SYSTEM, 2#2, SYSTEM, 5#11", " ,3#3, ,4#10"]
    listed.write_text("\n".join(["chain1, resid1 , chain2, resid2", *lines]))
    helical_step(structure, [], tmp_path / "part.csv", listed)
    part = (tmp_path / "part.csv").read_text()
    assert (tmp_path / "found.csv").read_text().startswith(part)


def test_other_misuse(files: tuple[Path, Path], make_universe: Maker, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"allowed are \.nc and \.csv"):
        helical_step(files[0], [], tmp_path / "out.txt")
    pairs = tmp_path / "pairs.csv"
    pairs.write_text("chain1,resid1,chain2,resid2\nA,2,B,99\n")
    with pytest.raises(InputError, match=r"duplex.pdb, .*pairs.csv: base pairs: 0 nucleotides"):
        helical_step(files[0], [], tmp_path / "out.nc", pairs)
    strand = tmp_path / "strand.pdb"
    universe = make_universe("CGATTA")
    universe.add_TopologyAttr("chainIDs", universe.atoms.segids)
    universe.select_atoms("segid A").write(str(strand))
    with pytest.raises(InputError, match=r"strand.pdb: a duplex has two strands"):
        helical_step(strand, [], tmp_path / "out.nc")
    text = tmp_path / "text.pdb"
    text.write_text("nothing\n")
    with pytest.raises(InputError, match=r"text.pdb"):
        helical_step(text, [], tmp_path / "out.nc")
