"""What an equilibration leaves behind: snapshots, mean structure, its own checks, in one file."""

from __future__ import annotations

import numpy as np
import xarray as xr

from dnawaves.files import provenance
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.equilibration_record import SAMPLED, UNITS, Record
from dnawaves.system.guided import line_density
from dnawaves.system.stationarity import Check, temperature_check, trend_check
from dnawaves.units import A_PER_NM, PN_PER_KJ_PER_MOL_NM

# Single molecules pulled and turned: Smith, Cui & Bustamante 1996, Science 271, 795; Bryant et al.
# 2003, Nature 424, 338.
STRETCH_MODULUS_pN, TWIST_RIGIDITY_pN_nm2 = 1087.0, 410.0


def equilibrium_dataset(
    built: SimulatedDuplex, record: Record, tested: slice, interval_ps: float, freedom: int
) -> xr.Dataset:
    """Return the file's content from a finished record.

    `tested` are the samples, `interval_ps` apart, by which the run is judged: the second half
    before the first snapshot, of which the mean structure is the mean too. A check that fails is
    named in the attribute `warning`; it does not make the snapshots disappear.
    """
    environment = built.spec.environment
    snapshots = np.array(record.snapshots)
    checks = {
        "temperature_K": temperature_check(
            record.series("temperature_K")[tested],
            environment.temperature_K,
            freedom,
            environment.to_snapshots.friction_per_ps,
            interval_ps,
        ),
        "potential_energy_kJ_per_mol": trend_check(
            record.series("potential_energy_kJ_per_mol")[tested], interval_ps
        ),
        "end_to_end_nm": trend_check(record.series("end_to_end_nm")[tested], interval_ps),
    }
    dataset = xr.Dataset(
        {
            "position_nm": (("snapshot", "atom", "xyz"), snapshots[:, 0], {"units": "nm"}),
            "velocity_nm_per_ps": (
                ("snapshot", "atom", "xyz"),
                snapshots[:, 1],
                {"units": "nm/ps", "long_name": "velocity at the time of the positions"},
            ),
            "reference_position_nm": (
                ("solute", "xyz"),
                record.mean_structure_nm,
                {
                    "units": "nm",
                    "long_name": "mean structure of the duplex over the tested samples, each laid "
                    "on the first by least squares, about the centre of mass",
                },
            ),
            **{
                name: ("time", record.series(name), {"units": UNITS[name]})
                for name in SAMPLED[: 4 if record.boxes[0].size else 3]
            },
        },
        coords={
            "snapshot": np.arange(1, len(snapshots) + 1),
            "xyz": ["x", "y", "z"],
            "time": (
                "time",
                interval_ps * np.arange(1, len(record.samples) + 1),
                {"units": "ps"},
            ),
        },
        attrs={
            "spec": built.spec.model_dump_json(),
            "tested_from_ps": interval_ps * (tested.start + 1),
            "tested_to_ps": interval_ps * tested.stop,
            "degrees_of_freedom": freedom,
            **_told(checks),
            **{f"first_estimate_{w}_A_per_ps": v for w, v in first_estimates(built).items()},
            **provenance("openmm", "numpy", "scipy"),
        },
    )
    if record.boxes[0].size:
        dataset["box_nm"] = (("snapshot", "xyz"), np.array(record.boxes), {"units": "nm"})
    return dataset


def first_estimates(duplex: SimulatedDuplex) -> dict[str, float]:
    """Return extension and twist speeds (Å/ps) of the rod of single-molecule experiments.

    Its stiffness with the duplex's own mass and inertia: √(modulus / density). Made to choose the
    length of a record and its frames, not to be reported as a measurement. Waves of some ps may be
    stiffer; a record that lasts too long and is sampled ten times a period can afford that.
    """
    moduli = {"extension": STRETCH_MODULUS_pN, "twist": TWIST_RIGIDITY_pN_nm2}
    return {
        wave: A_PER_NM * float(np.sqrt(modulus / PN_PER_KJ_PER_MOL_NM / line_density(duplex, wave)))
        for wave, modulus in moduli.items()
    }


def _told(checks: dict[str, Check]) -> dict[str, float | str]:
    """Return the checks as attributes, with one sentence of warning, empty where all is sound."""
    told: dict[str, float | str] = {}
    for name, check in checks.items():
        what = "mean" if name == "temperature_K" else "trend_per_ps"
        told[f"{name}_{what}"] = check.value
        told[f"{name}_{what}_standard_error"] = check.standard_error
        told[f"{name}_verdict"] = check.verdict
    failed = [f"{name}: {check.verdict}" for name, check in checks.items() if not check.sound]
    told["warning"] = f"not in equilibrium: {'; '.join(failed)}" if failed else ""
    return told
