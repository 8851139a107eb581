"""Helical parameters of a trajectory file, as a file."""

from __future__ import annotations

from pathlib import Path

from MDAnalysis import Universe

from dnawaves.errors import InputError
from dnawaves.files import provenance, write_netcdf
from dnawaves.helical.analysis import HelicalParameters


def helical_step(topology: Path, trajectory: Path, output: Path) -> None:
    """Write the helical parameters of every frame as NetCDF.

    Raises
    ------
    InputError
        When MDAnalysis cannot read the two files together, or finds no duplex in them.
    """
    try:
        universe = Universe(str(topology), str(trajectory))
    except (IndexError, OSError, TypeError, ValueError) as error:
        raise InputError(f"{trajectory}: cannot be read with {topology}: {error}") from error
    dataset = HelicalParameters(universe).run().results.dataset
    write_netcdf(output, dataset.assign_attrs(provenance("MDAnalysis", "numpy")))
