"""Speeds that the displacement under constant loads implies for the whole duplex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dnawaves.errors import SimulationError
from dnawaves.scene.excitations import Static
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.record import Record
from dnawaves.waves.table import Estimate, spread

LOCK_REASONS = {
    "nothing": "limit of a vanishing load",
    "across": "as a wave too fast for the base pairs to move across the axis would find it",
    "across_and_tilt": "as a wave too fast for them to tilt as well would find it",
}

# The guided end moves along the axis or turns about it, not both: a wave does.
COUPLED = {
    "extension": "at fixed twist: a wave, coupled to the slower twist, is faster",
    "twist": "at fixed length: a wave, coupled to the faster extension, is slower",
}


def static_rows(records: Sequence[Record], excitation: Static) -> list[Estimate]:
    """Return the row of all loads, of those that left the basin, and of a vanishing load.

    The interval of the first is the range over the loads and their limit, the vanishing load: one
    load alone has one too.
    """
    first, wave = records[0], excitation.wave
    paper = first.paper_speeds_A_per_ps[wave]
    name = first.scene.name
    response = first.motion["linear_response"]
    limits = {
        str(lock): _static_speed(first, 1.0, float(response.sel(lock=lock)))
        for lock in response["lock"].values
    }
    inside = [record for record in records if not record.motion.attrs["left_basin"]]
    estimates = []
    if inside:
        speeds = [
            _static_speed(
                record,
                _load(record),
                float(record.fields[f"{wave}_displacement"][0, -1]),
            )
            for record in inside
        ]
        loads = ", ".join(f"{_load(record):g}" for record in inside)
        unit = "pN" if wave == "extension" else "pN nm"
        estimates.append(
            replace(
                spread(Estimate(name, wave, "static"), [*speeds, limits["nothing"]], paper),
                reason=f"spread over loads of ±{loads} {unit} and their limit; {COUPLED[wave]}",
            )
        )
    for record in records:
        if record.motion.attrs["left_basin"]:
            estimates.append(
                Estimate(
                    name,
                    wave,
                    f"static {record.member}",
                    paper_A_per_ps=paper,
                    reason=f"a load of {record.motion.attrs['left_basin']} times "
                    f"{_load(record):g} drove the duplex into another minimum",
                )
            )
    for lock, speed in limits.items():
        label = "static, no load" if lock == "nothing" else f"static, held {lock}"
        coupled = f"; {COUPLED[wave]}" if lock == "nothing" else ""
        estimates.append(
            Estimate(
                name,
                wave,
                label.replace("_", " "),
                speed_A_per_ps=speed,
                interval="none: exact linear response",
                paper_A_per_ps=paper,
                ratio_to_paper=speed / paper,
                reason=LOCK_REASONS[lock] + coupled,
            )
        )
    return estimates


def _load(record: Record) -> float:
    return float(record.motion.attrs["load"])


def _static_speed(record: Record, load: float, displacement: float) -> float:
    """Return the speed of the rod whose whole length is displaced so far (Å or rad) by a load.

    Raises `SimulationError` where the end has moved against the load: no rod does.
    """
    if not float(displacement) * load > 0:
        raise SimulationError(
            f"scene '{record.scene.name}': under a load of {load:g} the end moved by "
            f"{displacement:g}, against it: the structure it started from is no minimum"
        )
    strain = float(displacement) / record.free_length_A
    if record.scene.excitation.wave == "extension":  # type: ignore[union-attr]
        density = float(record.motion["mass"].values.mean()) / (record.spacing_nm * A_PER_NM)
        modulus = load * KJ_PER_MOL_PER_PN_NM * A_PER_NM / strain
    else:
        density = record.inertia_Da_A2("helix") / (record.spacing_nm * A_PER_NM)
        modulus = load * KJ_PER_MOL_PER_PN_NM * A_PER_NM**2 / strain
    return float(np.sqrt(modulus / density))
