"""The machine that times are measured on."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import openmm


def machine() -> dict[str, str | int]:
    """Return the processor's name, its cores, and OpenMM's version."""
    return {
        "processor": processor(),
        "cores": os.cpu_count() or 1,
        "openmm": openmm.Platform.getOpenMMVersion(),
    }


def processor() -> str:
    """Return the processor's name as the system knows it."""
    lines = Path("/proc/cpuinfo")
    if lines.is_file():
        for line in lines.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
