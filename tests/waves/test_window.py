"""The record is trusted only while the difference holds no more energy than was put in."""

from __future__ import annotations

import numpy as np
import xarray as xr

from dnawaves.waves.estimators.window import FEWEST_FRAMES, usable_frames, windows


def fields(kinetic: np.ndarray, put_in: np.ndarray) -> xr.Dataset:
    return xr.Dataset({"kinetic_energy": ("time", kinetic), "energy_put_in": ("time", put_in)})


def test_a_stable_record_is_usable_to_its_end() -> None:
    kinetic = 0.5 + 0.5 * np.cos(np.linspace(0, 20, 100)) ** 2
    assert usable_frames(fields(kinetic, np.ones(100))) == 100


def test_a_growing_difference_ends_the_record_where_it_passes_what_was_put_in() -> None:
    kinetic = 0.2 * np.exp(np.linspace(0, 3, 61))
    # 0.2 e^x passes 1.002 at x = 1.61, between frames 32 and 33 of steps of 0.05.
    assert usable_frames(fields(kinetic, np.ones(61))) == 33


def test_a_null_has_no_usable_frame() -> None:
    assert usable_frames(fields(np.zeros(50), np.zeros(50))) == 0
    assert usable_frames(fields(np.full(50, 1e-9), np.zeros(50))) == 0


def test_windows_are_never_shorter_than_a_fit_needs() -> None:
    assert windows(80) == [80, 60, 40]
    assert all(length >= FEWEST_FRAMES for length in windows(15))
    assert windows(FEWEST_FRAMES - 1) == []
