"""The four waves as fields along the helix axis: the answer to the excitation, odd in its sign."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Which displacement or rotation, along or about which direction, each wave is.
WAVE_COMPONENTS = {
    "extension": ("linear", "helix"),
    "twist": ("angular", "helix"),
    "bend": ("angular", "second"),
    "shear": ("linear", "first"),
    "bend_across": ("angular", "first"),
    "shear_across": ("linear", "second"),
}
FIELD_UNITS = {"linear": "angstrom", "angular": "rad"}


def wave_fields(motion: xr.Dataset) -> xr.Dataset:
    """Return each wave's displacement and velocity, (time, pair), from a recorded run.

    Half the difference of the two signs, so that what does not depend on the excitation and all
    even orders cancel; a null, which has one sign, is returned as it is. The linear motion is that
    of the base pair's point on the helix axis, not of its centre of mass: the centres wind about
    the axis, and a turn about it would otherwise show as shear. `bend_across` and `shear_across`
    are the components across the plane of the kick.
    """
    odd = _odd(motion)
    fields: dict[str, tuple[tuple[str, str], Array, dict[str, str]]] = {}
    lever = motion["pivot"].values - motion["centre"].values
    for kind, names in {
        "displacement": ("displacement", "rotation"),
        "velocity": ("velocity", "angular_velocity"),
    }.items():
        angular = odd[names[1]].values
        parts = {"linear": odd[names[0]].values + np.cross(angular, lever), "angular": angular}
        for wave, (part, direction) in WAVE_COMPONENTS.items():
            along = motion["direction"].sel(axis=direction).values
            units = FIELD_UNITS[part] + ("/ps" if kind == "velocity" else "")
            fields[f"{wave}_{kind}"] = (("time", "pair"), parts[part] @ along, {"units": units})
    dataset = xr.Dataset(fields, coords={name: motion[name] for name in ("time", "pair", "height")})
    dataset["kinetic_energy"] = motion["difference_kinetic_energy"]
    dataset["energy_put_in"] = energy_put_in(motion)
    return dataset.drop_vars("sign", errors="ignore")


def energy_put_in(motion: xr.Dataset) -> xr.DataArray:
    """Return the most energy, kJ/mol, that the excitation has given the difference so far, (time,).

    For a kick the kinetic energy at t = 0; for a drive the work done on half the difference,
    which is the mean over the two signs; for a null zero.
    """
    if motion.sizes["sign"] == 1:
        return xr.zeros_like(motion["difference_kinetic_energy"])
    work = motion["work"].mean("sign")
    largest = np.maximum.accumulate(work.values)
    start = motion["difference_kinetic_energy"].values[0]
    return xr.DataArray(start + largest, dims="time", attrs={"units": "kJ/mol"})


def _odd(motion: xr.Dataset) -> xr.Dataset:
    vectors = motion[["displacement", "rotation", "velocity", "angular_velocity"]]
    if motion.sizes["sign"] == 1:
        return vectors.isel(sign=0)
    return 0.5 * (vectors.sel(sign=1) - vectors.sel(sign=-1))
