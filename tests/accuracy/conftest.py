"""A study table made by hand, of a method whose errors are known."""

from __future__ import annotations

import pandas as pd
import pytest

from dnawaves.accuracy.models import Numerics
from dnawaves.accuracy.row import Row
from dnawaves.accuracy.table import tables


def row(timestep_fs: float, scale: float = 1.0, **other: object) -> Row:
    """A second-order method, 0.25 % at 1 fs, with an error of 3 % from the kick at scale 1."""
    numerics = Numerics(timestep_fs=timestep_fs, scale=scale)
    integration = 0.0025 * timestep_fs**2
    return {
        "setting": f"made-{timestep_fs:g}-{scale:g}",
        "line": "made",
        "title": "made",
        "label": f"{timestep_fs:g}",
        "table": "settings",
        "slope": "timestep",
        "status": "ok",
        "case": "kick",
        "usual_case": "kick",
        "is_default": timestep_fs == 2 and scale == 1,
        "declarable": True,
        "base_pairs": 10,
        "kind": "kick",
        "wave": "extension",
        "mode": None,
        "amplitude": 0.1 * scale,
        **numerics.model_dump(exclude={"replicas", "temperature_K"}),
        "replicas": None,
        "waveform_error": integration + 0.03 * scale,
        "speed_error": 0.1 * (integration + 0.03 * scale),
        "helical_error": None,
        "waveform_integration_error": integration,
        "relative_cost": 2 / timestep_fs,
        **other,  # type: ignore[dict-item]
    }


@pytest.fixture
def settings() -> pd.DataFrame:
    """Timesteps at the full kick and at a tenth of it."""
    rows = [row(timestep, scale) for scale in (1.0, 0.1) for timestep in (0.5, 1.0, 2.0, 2.5)]
    return tables(rows)[0]
