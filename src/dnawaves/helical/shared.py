"""Memory that several processes map as a file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from tempfile import mkstemp


@contextmanager
def shared_file() -> Iterator[str]:
    """Yield the path of an empty file that lives in memory where the system has such files.

    On Linux an anonymous file: not on a disk, and not bounded as /dev/shm is in containers. What
    is mapped when the block ends stays mapped.
    """
    if hasattr(os, "memfd_create"):
        handle = os.memfd_create("dnawaves")
        try:
            yield f"/proc/{os.getpid()}/fd/{handle}"
        finally:
            os.close(handle)
    else:
        handle, path = mkstemp(prefix="dnawaves-")
        os.close(handle)
        try:
            yield path
        finally:
            os.unlink(path)
