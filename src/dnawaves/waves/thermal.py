"""A scene above 0 K: its estimates, and what its figures show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from dnawaves.motion.fields import WAVE_COMPONENTS
from dnawaves.motion.pair_frames import following_velocities
from dnawaves.scene.excitations import Nothing
from dnawaves.waves.estimators.spectrum import frequency_wavenumber
from dnawaves.waves.record import Record
from dnawaves.waves.table import Estimate
from dnawaves.waves.thermal_replicas import replica_rows, variant
from dnawaves.waves.thermal_spectrum import spectrum_rows

# Where waves of base pairs end.
TOP_GHZ = 3000.0
AVERAGED = ("displacement", "rotation", "velocity", "angular_velocity", "work")


def thermal_estimates(records: Sequence[Record]) -> list[Estimate]:
    """Return the rows of a thermal scene's members: of replicas if excited, else of spectra."""
    if isinstance(records[0].scene.excitation, Nothing):
        return spectrum_rows(records)
    return replica_rows(records)


def averaged_records(records: Sequence[Record]) -> list[Record]:
    """Return one record for each kick or drive, the average of its replicas, to look at.

    Its difference never counts as holding more energy than was put in: how long the average can
    be trusted is for the replicas' spread to say.
    """
    groups: dict[str, list[Record]] = {}
    for record in records:
        groups.setdefault(variant(record.member), []).append(record)
    found = []
    for group in groups.values():
        motion = group[0].motion.copy()
        for name in AVERAGED:
            motion[name] = (
                motion[name].dims,
                np.mean([one.motion[name].values for one in group], axis=0),
                motion[name].attrs,
            )
        energy = np.minimum(
            motion["difference_kinetic_energy"], group[0].fields["energy_put_in"].values
        )
        found.append(replace(group[0], motion=motion.assign(difference_kinetic_energy=energy)))
    return found


def thermal_maps(records: Sequence[Record]) -> dict[str, xr.DataArray]:
    """Return the frequency-wavenumber map of each wave in equilibrium, the runs' mean."""
    first = records[0]
    start, stop = first.span
    held = tuple(end for end, pair in ((0, start), (-1, stop)) if pair in first.held)
    motions = [following_velocities(record.motion) for record in records]
    maps = {}
    for wave in WAVE_COMPONENTS:
        powers = [
            frequency_wavenumber(
                record.times_ps, one[wave][:, start : stop + 1], first.spacing_nm, held
            )
            for record, one in zip(records, motions, strict=True)
        ]
        mean = xr.concat(powers, "run").mean("run", keep_attrs=True)
        below = mean["frequency"] <= TOP_GHZ
        maps[f"{wave}_power"] = mean.assign_attrs(powers[0].attrs).sel(frequency=below)
    return maps
