"""Several processes give what one gives, in the analysis and in blocks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
import xarray as xr

from dnawaves.errors import InputError
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.helical.blocks import render_blocks
from dnawaves.helical.dataset import make_dataset

pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning:MDAnalysis"),
    pytest.mark.filterwarnings("ignore::UserWarning:MDAnalysis"),
]

FRAMES = 61


@pytest.fixture
def moving(
    make_universe: Callable[[str], MDAnalysis.Universe],
    make_dcd: Callable[..., Path],
    tmp_path: Path,
) -> MDAnalysis.Universe:
    """Return a noisy trajectory on disk."""
    universe = make_universe("CGATTA")
    still = universe.atoms.positions
    noise = np.random.default_rng(1).normal(scale=0.1, size=(FRAMES, *still.shape))
    return universe.load_new(str(make_dcd(tmp_path / "a.dcd", still + noise)))


def test_serial_is_what_whole_frames_give(moving: MDAnalysis.Universe) -> None:
    found = HelicalParameters(moving).run().results.dataset
    one = HelicalParameters(moving).run(start=40, stop=41).results.dataset
    assert found.sizes["time"] == FRAMES
    # The same numbers, in matrix products of another size.
    xr.testing.assert_allclose(found.isel(time=[40]), one, rtol=0, atol=1e-10)
    np.testing.assert_array_equal(found.frame, np.arange(FRAMES))
    np.testing.assert_allclose(found.time, np.arange(FRAMES))


@pytest.mark.parametrize("backend", ["multiprocessing", "dask"])
@pytest.mark.parametrize("keep_frames", [True, False])
def test_backends(moving: MDAnalysis.Universe, backend: str, keep_frames: bool) -> None:
    if backend == "dask":
        pytest.importorskip("dask")
    analysis = HelicalParameters(moving, keep_frames=keep_frames)
    alone = analysis.run(start=1, step=2).results.dataset
    shared = analysis.run(start=1, step=2, backend=backend, n_workers=2, n_parts=3)
    # Each part is worked on in matrix products of its own size.
    xr.testing.assert_allclose(shared.results.dataset, alone, rtol=0, atol=1e-10)
    assert shared.results.dataset.attrs == alone.attrs


def test_single_pair_has_no_steps(moving: MDAnalysis.Universe) -> None:
    analysis = HelicalParameters(moving, [("A:2", "B:5")])
    for backend in ("serial", "multiprocessing"):
        found = analysis.run(backend=backend, n_workers=1).results.dataset
        assert dict(found.sizes)["step"] == 0
        assert np.isfinite(found.shear).all()


def test_chosen_frames(moving: MDAnalysis.Universe) -> None:
    found = HelicalParameters(moving).run(frames=[7, 3, 50]).results.dataset
    assert found.frame.values.tolist() == [7, 3, 50]
    np.testing.assert_allclose(found.time, [7, 3, 50])


@pytest.mark.parametrize("backend", ["serial", "multiprocessing"])
def test_backwards(moving: MDAnalysis.Universe, backend: str) -> None:
    analysis = HelicalParameters(moving)
    forwards = analysis.run(step=3).results.dataset
    workers = {"serial": 1, "multiprocessing": 2}[backend]
    backwards = analysis.run(step=-3, backend=backend, n_workers=workers).results.dataset
    # 60, 57, ... 0: 61 frames, so the same ones; in matrix products of another size.
    xr.testing.assert_allclose(backwards.isel(time=slice(None, None, -1)), forwards, atol=1e-10)


def test_frames_by_number_and_by_mask(moving: MDAnalysis.Universe) -> None:
    analysis = HelicalParameters(moving)
    found = analysis.run(frames=[-1, 0, -FRAMES]).results.dataset
    assert found.frame.values.tolist() == [FRAMES - 1, 0, 0]
    mask = np.arange(FRAMES) % 20 == 7
    assert analysis.run(frames=mask).results.dataset.frame.values.tolist() == [7, 27, 47]


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        ([0, FRAMES], "there is no frame 61; there are 61"),
        ([-FRAMES - 1], "there is no frame -62"),
        ([True, False], "a mask of all 61 frames"),
        ([0.5], "allowed are a list of frame numbers"),
        (slice(3), "allowed are a list of frame numbers"),
    ],
)
def test_frames_that_there_are_not(
    moving: MDAnalysis.Universe, frames: object, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        HelicalParameters(moving).run(frames=frames)


def test_no_frames(moving: MDAnalysis.Universe) -> None:
    found = HelicalParameters(moving).run(stop=0).results.dataset
    assert found.sizes["time"] == 0 and found.sizes["pair"] == 6


def times_of(dataset: xr.Dataset) -> list[float]:
    return dataset["time"].values.tolist()


@pytest.mark.parametrize("workers", [1, 2])
def test_blocks_come_in_order(
    moving: MDAnalysis.Universe, workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("dnawaves.helical.blocks._BLOCK_BYTES", 0)
    analysis = HelicalParameters(moving)
    analysis.duplexes.chunk = 4
    frames = np.arange(0, FRAMES, 3)
    blocks = list(render_blocks(analysis, frames, times_of, workers))
    assert [length for length, _ in blocks] == [4, 4, 4, 4, 4, 1]
    # A DCD file keeps its timestep in float32.
    np.testing.assert_allclose([time for _, times in blocks for time in times], frames, rtol=1e-6)


def test_a_progress_bar(moving: MDAnalysis.Universe, capsys: pytest.CaptureFixture[str]) -> None:
    HelicalParameters(moving).run(verbose=True)
    assert f"{FRAMES}/{FRAMES}" in capsys.readouterr().err


def test_the_dataset_shares_the_memory_of_the_result(moving: MDAnalysis.Universe) -> None:
    analysis = HelicalParameters(moving).run()
    dataset = analysis.results.dataset
    again = make_dataset(analysis._arrays, analysis.duplexes)
    assert np.shares_memory(dataset.twist.values, again.twist.values)
