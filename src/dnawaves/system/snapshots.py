"""Snapshots of an equilibrated system, as `dnawaves equilibrate` wrote them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from dnawaves.errors import InputError
from dnawaves.scene.models import SystemSpec
from dnawaves.system.duplex import SimulatedDuplex, read_built, read_result


def read_equilibrated(
    spec: SystemSpec, built: Path, equilibrated: Path, snapshot: int
) -> SimulatedDuplex:
    """Return the duplex at a snapshot, numbered from 1, with its velocities and its box.

    The velocities belong to the time of the positions. Bodies and helix axis are those of the
    snapshot itself. Raises `InputError` where the file belongs to another duplex or environment,
    or has no such snapshot.
    """
    dataset = _dataset_of(spec, equilibrated)
    count = dataset.sizes["snapshot"]
    if not 1 <= snapshot <= count:
        raise InputError(f"{equilibrated}: snapshot: found {snapshot}; allowed: 1 to {count}")
    chosen = dataset.sel(snapshot=snapshot)
    return replace(
        read_built(spec, built),
        positions_nm=chosen["position_nm"].values,
        velocities_nm_per_ps=chosen["velocity_nm_per_ps"].values,
        box_nm=chosen["box_nm"].values if "box_nm" in chosen else None,
    )


def read_mean(spec: SystemSpec, built: Path, equilibrated: Path) -> SimulatedDuplex:
    """Return the duplex, without water and ions, at the mean structure of the equilibration.

    Raises `InputError` where the file belongs to another duplex or environment.
    """
    dataset = _dataset_of(spec, equilibrated)
    return read_built(spec, built).without_solvent(dataset["reference_position_nm"].values)


def _dataset_of(spec: SystemSpec, equilibrated: Path) -> xr.Dataset:
    needed = ("position_nm", "velocity_nm_per_ps", "reference_position_nm")
    return read_result(spec, equilibrated, "snapshots", *needed)
