"""A long trajectory in blocks, by one process or several, in order and in constant memory."""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.helical.analysis import HelicalParameters

_BLOCK_BYTES = 16 * 2**20

Rendered = TypeVar("Rendered")

# What a worker process has been given: an analysis and what to make of its data sets.
_given: list[Any] = []


def render_blocks(
    analysis: HelicalParameters,
    frames: NDArray[np.int64],
    render: Callable[[xr.Dataset], Rendered],
    workers: int = 1,
) -> Iterator[tuple[int, Rendered]]:
    """Yield for successive blocks of frames their number and what `render` makes of them.

    With several workers, `render` runs in them; results wait for their turn, a few at a time.
    """
    size = _block_size(analysis)
    blocks = [frames[begin : begin + size] for begin in range(0, len(frames), size)]
    if workers == 1:
        for block in blocks:
            yield len(block), render(analysis.block(block))
        return
    # Pickled here, so that each worker opens the trajectory for itself.
    given = pickle.dumps((analysis, render))
    waiting: deque[tuple[int, Future[Any]]] = deque()
    with ProcessPoolExecutor(workers, initializer=_receive, initargs=(given,)) as pool:
        try:
            for number, block in enumerate(blocks, start=1):
                waiting.append((len(block), pool.submit(_render, block)))
                while len(waiting) > 2 * workers or (waiting and number == len(blocks)):
                    length, future = waiting.popleft()
                    yield length, future.result()
        finally:
            for _, future in waiting:
                future.cancel()


def _block_size(analysis: HelicalParameters) -> int:
    chunk = analysis.duplexes.chunk
    chunks = _BLOCK_BYTES // (chunk * analysis.duplexes.bytes_per_time())
    return chunk * max(1, chunks)


def _receive(given: bytes) -> None:
    _given[:] = pickle.loads(given)


def _render(block: NDArray[np.int64]) -> Any:
    analysis, render = _given
    return render(analysis.block(block))
