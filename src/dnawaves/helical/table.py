"""Helical parameters as CSV tables: one row for each frame of time and step, or pair."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from dnawaves.frames.parameters import PAIR_PARAMETERS, STEP_PARAMETERS
from dnawaves.helical.compute import Duplexes
from dnawaves.helical.flags import flag_words

_UNITS = ("A", "A", "A", "deg", "deg", "deg")


def _header(columns: Sequence[str], parameters: Sequence[str]) -> str:
    named = [f"{name}_{unit}" for name, unit in zip(parameters, _UNITS, strict=True)]
    return ",".join(["frame", "time_ps", *columns, *named, "flags"]) + "\n"


STEP_HEADER = _header(("step", "pair_1", "pair_2"), STEP_PARAMETERS)
PAIR_HEADER = _header(("pair", "base_1", "base_2"), PAIR_PARAMETERS)


class Tables:
    """The rows of both tables: four decimals, blank where undefined, flags joined by "|"."""

    def __init__(self, duplexes: Duplexes) -> None:
        pairs = duplexes.pairs
        self._pairs = [
            f"{number},{_cell(pair.first.label)},{_cell(pair.second.label)}"
            for number, pair in enumerate(pairs, start=1)
        ]
        self._steps = [
            f"{number},{_cell(pairs[step].label)},{_cell(pairs[step + 1].label)}"
            for number, step in enumerate(duplexes.steps, start=1)
        ]

    def __call__(self, dataset: xr.Dataset) -> tuple[bytes, bytes]:
        """Return the rows of the step table and those of the pair table, as they are in a file."""
        return (
            "".join(_rows(dataset, self._steps, STEP_PARAMETERS, "step_flag")).encode(),
            "".join(_rows(dataset, self._pairs, PAIR_PARAMETERS, "pair_flag")).encode(),
        )


def _rows(
    dataset: xr.Dataset, names: Sequence[str], parameters: Sequence[str], flag: str
) -> Iterator[str]:
    values = np.stack([dataset[name].values for name in parameters], axis=-1)
    defined = np.isfinite(values).all(axis=-1).tolist()
    times = zip(
        dataset["frame"].values.tolist(),
        dataset["time"].values.tolist(),
        values.tolist(),
        defined,
        dataset[flag].values.tolist(),
        strict=True,
    )
    for frame, time_ps, rows, whole, flags in times:
        start = f"{frame},{time_ps:.10g}"
        for name, row, known, bits in zip(names, rows, whole, flags, strict=True):
            if known:
                # One formatting of the whole row: the fastest that plain Python has.
                numbers = "%.4f,%.4f,%.4f,%.4f,%.4f,%.4f" % tuple(row)  # noqa: UP031
            else:
                numbers = ",".join("" if np.isnan(value) else f"{value:.4f}" for value in row)
            yield f"{start},{name},{numbers},{flag_words(bits)}\n"


def _cell(text: str) -> str:
    """Return text as a CSV cell: names of segments may hold anything."""
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\n') else text
