"""The analysis of a trajectory, in the manner of MDAnalysis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np
import xarray as xr
from MDAnalysis import Universe
from MDAnalysis.analysis.backends import BackendBase, BackendSerial
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.analysis.results import Results
from MDAnalysis.core.groups import AtomGroup
from MDAnalysis.lib.log import ProgressBar
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.helical.compute import Arrays, Duplexes, keep_freed_memory
from dnawaves.helical.dataset import allocate, fill, make_dataset
from dnawaves.helical.pairs import find_pairs
from dnawaves.helical.precision import coordinate_precision
from dnawaves.helical.reader import read_chunks
from dnawaves.helical.shared import shared_file


class HelicalParameters(AnalysisBase):
    """Base-pair, step and helical-axis parameters of every duplex among `atoms`.

    `pairs` overrides which bases pair (see `find_pairs`, whose `InputError` this raises). Pairs
    and their forms are those of the time at which the universe stands. After `.run()`,
    `.results.dataset` is the data set of `make_dataset`, time in ps; without `keep_frames` it has
    no origins and axes, which are three quarters of it. Backends "multiprocessing" and "dask"
    share the times out between processes of one machine.
    """

    _analysis_algorithm_is_parallelizable = True
    _shared: str
    _arrays: Arrays

    @classmethod
    def get_supported_backends(cls) -> tuple[str, ...]:
        """Return the backends that `run` takes."""
        return ("serial", "multiprocessing", "dask")

    def __init__(
        self,
        atoms: AtomGroup | Universe,
        pairs: Sequence[tuple[str, str]] | None = None,
        keep_frames: bool = True,
        verbose: bool = False,
    ) -> None:
        super().__init__(atoms.universe.trajectory, verbose=verbose)
        self.duplexes = Duplexes(find_pairs(atoms, pairs), keep_frames)
        self.precision = coordinate_precision(atoms.universe.trajectory)

    def run(
        self,
        start: int | None = None,
        stop: int | None = None,
        step: int | None = None,
        frames: ArrayLike | None = None,
        *args: Any,
        **kwargs: Any,
    ) -> HelicalParameters:
        """Analyse the trajectory; arguments as for every analysis of MDAnalysis.

        Raises `InputError` for `frames` that there are not.
        """
        if frames is None and step is not None and step < 0:
            # Back to the first frame, stop is -1, which MDAnalysis then takes for the last.
            frames = np.arange(*self._trajectory.check_slice_indices(start, stop, step))
            start = stop = step = None
        if frames is not None:
            frames = _frame_numbers(frames, self._trajectory.n_frames)
        # What an earlier run left would travel to every worker and back.
        self._arrays, self.results = {}, Results()
        with shared_file() as self._shared:
            super().run(start, stop, step, frames, *args, **kwargs)
        return self

    def block(self, frames: NDArray[np.int64]) -> xr.Dataset:
        """Return the data set of some frames of the trajectory, by number: part of a long one."""
        arrays = allocate(self.duplexes, len(frames))
        times_ps = np.concatenate([times for _, times in self._chunks(frames, arrays)])
        return self._dataset(arrays, times_ps, frames)

    def _chunks(
        self, frames: NDArray[np.int64], arrays: Arrays, first: int = 0
    ) -> Iterator[tuple[slice, NDArray[np.float64]]]:
        """Fill arrays from time `first` on; yield for each chunk its frames and times in ps."""
        keep_freed_memory()
        duplexes = self.duplexes
        done = 0
        for chunk in read_chunks(self._trajectory, frames, duplexes.indices, duplexes.chunk):
            now = slice(done, done + len(chunk.times_ps))
            result = duplexes(chunk.positions_A, chunk.boxes, frames[now])
            fill(arrays, slice(first + now.start, first + now.stop), result)
            yield now, chunk.times_ps
            done = now.stop

    def _configure_backend(self, *args: Any, **kwargs: Any) -> BackendBase:
        executor = super()._configure_backend(*args, **kwargs)
        self._elsewhere = not isinstance(executor, BackendSerial)
        return executor

    def _setup_frames(self, *args: Any, **kwargs: Any) -> None:
        super()._setup_frames(*args, **kwargs)
        self._total = self.n_frames
        if self._elsewhere:
            # Other processes write their frames into memory that is mapped here as well: sent
            # through a pipe, the result would cost more than computing it.
            self._mapped("w+")
        else:
            self._arrays = allocate(self.duplexes, self._total)

    def _mapped(self, mode: Literal["r+", "w+"]) -> Arrays:
        """Map the shared file of the result; what is mapped lives on when the file is gone."""
        size = self.duplexes.bytes_per_time() * self._total
        memory = np.memmap(self._shared, np.uint8, mode, shape=(max(1, size),))
        return self.duplexes.views(memory, self._total)

    def _compute(
        self,
        indexed_frames: NDArray[np.int64],
        verbose: bool | None = None,
        *,
        progressbar_kwargs: Mapping[str, Any] | None = None,
    ) -> HelicalParameters:
        """Analyse one group of frames, (place in the result, frame number), in whole chunks."""
        frames = np.asarray(indexed_frames[:, 1])
        self.frames, self.times = frames, np.zeros(len(frames))
        if not len(frames):
            return self
        arrays = self._mapped("r+") if self._elsewhere else self._arrays
        chunks = self._chunks(frames, arrays, int(indexed_frames[0, 0]))
        shown = self._verbose if verbose is None else verbose
        bar = ProgressBar(total=len(frames), **(progressbar_kwargs or {})) if shown else None
        for now, times_ps in chunks:
            self.times[now] = times_ps
            if bar is not None:
                bar.update(len(times_ps))
        if bar is not None:
            bar.close()
        return self

    def _single_frame(self) -> None:
        """Not used: `_compute` works on whole chunks."""

    def _conclude(self) -> None:
        arrays = self._mapped("r+") if self._elsewhere else self._arrays
        self.results.dataset = self._dataset(arrays, self.times, self.frames)

    def _dataset(
        self, arrays: Arrays, times_ps: NDArray[np.float64], frames: NDArray[np.int64]
    ) -> xr.Dataset:
        return make_dataset(arrays, self.duplexes, times_ps, frames, self.precision)


def _frame_numbers(frames: ArrayLike, total: int) -> NDArray[np.int64]:
    """Return the numbers of frames from numbers, negative ones from the end, or from a mask."""
    chosen = np.asarray(frames)
    if chosen.dtype == bool and chosen.shape == (total,):
        return np.flatnonzero(chosen)
    if chosen.ndim != 1 or (chosen.size and chosen.dtype.kind not in "iu"):
        raise InputError(
            f"frames: found shape {chosen.shape} of {chosen.dtype}; allowed are a list of frame"
            f" numbers or a mask of all {total} frames"
        )
    numbers = chosen.astype(np.int64)
    outside = numbers[(numbers < -total) | (numbers >= total)]
    if outside.size:
        raise InputError(f"frames: there is no frame {outside[0]}; there are {total}, from 0 on")
    return np.where(numbers < 0, numbers + total, numbers)
