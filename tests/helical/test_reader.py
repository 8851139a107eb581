"""Chunks of a trajectory: the fast reader gives what the loop over frames gives."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
from MDAnalysis.transformations import translate

from dnawaves.helical.dcd import open_plain
from dnawaves.helical.reader import read_chunks

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:MDAnalysis")

ATOMS, FRAMES = 7, 23
INDICES = np.array([5, 0, 3])
CELLS = {
    "none": [0, 0, 0, 0, 0, 0],
    "degrees": [40, 60, 50, 70, 80, 45],
    "cosines": [40, 0.5, 50, 0.34, 0.17, 45],
    "box matrix": [40, -3, 50, 2, 4, 45],
}

Writer = Callable[..., Path]


def universe(*files: Path) -> MDAnalysis.Universe:
    names = [str(file) for file in files]
    empty = MDAnalysis.Universe.empty(ATOMS, trajectory=True)
    return empty.load_new(names if len(names) > 1 else names[0])


def expected(trajectory: object, frames: np.ndarray) -> list[np.ndarray]:
    """Return positions, boxes and times as MDAnalysis' own loop gives them."""
    rows = []
    for timestep in trajectory[frames]:
        box = np.zeros(6) if timestep.dimensions is None else timestep.dimensions
        rows.append((timestep.positions[INDICES], box, trajectory.time))
    return [np.array(column) for column in zip(*rows, strict=True)]


def check(universe: MDAnalysis.Universe, frames: np.ndarray, size: int) -> None:
    chunks = list(read_chunks(universe.trajectory, frames, INDICES, size))
    assert max(len(chunk.times_ps) for chunk in chunks) <= size
    positions_A, boxes, times_ps = expected(universe.trajectory, frames)
    np.testing.assert_array_equal(np.concatenate([c.positions_A for c in chunks]), positions_A)
    found = [np.zeros((len(c.times_ps), 6)) if c.boxes is None else c.boxes for c in chunks]
    # MDAnalysis keeps boxes in float32.
    np.testing.assert_allclose(np.concatenate(found), boxes, atol=1e-4)
    np.testing.assert_allclose(np.concatenate([c.times_ps for c in chunks]), times_ps, rtol=1e-12)


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize(
    "frames",
    [
        np.arange(FRAMES),
        np.arange(3, 20, 4),
        np.arange(FRAMES)[::-1],
        np.array([2, 3, 11, 4]),
        np.array([22]),
    ],
    ids=["all", "strided", "backwards", "any", "one"],
)
def test_dcd(make_dcd: Writer, tmp_path: Path, cell: str, frames: np.ndarray) -> None:
    positions = np.random.default_rng(0).normal(size=(FRAMES, ATOMS, 3))
    file = make_dcd(tmp_path / "a.dcd", positions, np.tile(CELLS[cell], (FRAMES, 1)))
    check(universe(file), frames, size=5)


def test_chained_dcd(make_dcd: Writer, tmp_path: Path) -> None:
    positions = np.random.default_rng(0).normal(size=(FRAMES, ATOMS, 3))
    files = [
        make_dcd(tmp_path / "a.dcd", positions[:9]),
        make_dcd(tmp_path / "b.dcd", positions[9:]),
    ]
    check(universe(*files), np.arange(FRAMES), size=5)
    check(universe(*files), np.arange(0, FRAMES, 3), size=2)


@pytest.mark.parametrize("ending", ["xtc", "trr", "nc"])
def test_other_formats(tmp_path: Path, ending: str) -> None:
    source = MDAnalysis.Universe.empty(ATOMS, trajectory=True)
    source.dimensions = [40, 50, 45, 80, 75, 70]
    file = tmp_path / f"a.{ending}"
    with MDAnalysis.Writer(str(file), ATOMS) as writer:
        for number in range(FRAMES):
            source.atoms.positions = np.random.default_rng(number).normal(size=(ATOMS, 3))
            source.trajectory.ts.time = 0.5 * number
            writer.write(source.atoms)
    check(universe(file), np.arange(1, FRAMES, 2), size=4)


def test_transformations_are_applied(make_dcd: Writer, tmp_path: Path) -> None:
    positions = np.random.default_rng(0).normal(size=(FRAMES, ATOMS, 3))
    moved = universe(make_dcd(tmp_path / "a.dcd", positions))
    moved.trajectory.add_transformations(translate([1, 2, 3]))
    (chunk,) = read_chunks(moved.trajectory, np.arange(2), INDICES, 5)
    # Sums of float32 numbers of order 1.
    np.testing.assert_allclose(chunk.positions_A, positions[:2, INDICES] + [1, 2, 3], atol=1e-6)


def test_dcd_of_an_unusual_layout(make_dcd: Writer, tmp_path: Path) -> None:
    positions = np.random.default_rng(0).normal(size=(FRAMES, ATOMS, 3))
    file = make_dcd(tmp_path / "a.dcd", positions)
    assert open_plain(file) is not None
    # Cut off in the middle of its last frame, as a killed simulation leaves it.
    file.write_bytes(file.read_bytes()[:-50])
    assert open_plain(file) is None
    check(universe(file), np.arange(FRAMES - 1), size=5)
