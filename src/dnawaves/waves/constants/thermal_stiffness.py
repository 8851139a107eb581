"""The rod's constants from thermal motion: covariances of the strains of base-pair steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames
from dnawaves.frames.strain import step_strains
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K
from dnawaves.waves.constants.axis_strains import AxisStrains, mean_structure
from dnawaves.waves.constants.rod_mass import SPEEDS, RodMass
from dnawaves.waves.constants.rod_stiffness import (
    SIGNED,
    STIFFNESS,
    WAVES_IN_STEPS,
    kinds_compliance,
    segments_compliance,
    step_kinds,
    stiffness_of,
    wave_compliance,
)
from dnawaves.waves.constants.segments import inner_pairs, segment_lengths
from dnawaves.waves.constants.table import Constant
from dnawaves.waves.constants.thermal_blocks import Blocks, blocks_of, jackknife

Array = NDArray[np.float64]

LONGEST_WAVE = "K(q->0)"


@dataclass(frozen=True, eq=False)
class ThermalStrains:
    """Strains along the axis of the mean structure: runs of (time, step, 6), Å and rad."""

    runs: tuple[Array, ...]
    heights_A: Array
    temperature_K: float

    @property
    def energy_kJ_per_mol(self) -> float:
        """kBT."""
        return BOLTZMANN_KJ_PER_MOL_K * self.temperature_K

    def blocks(self) -> Blocks:
        """Return the blocks that the whole duplex's six strains ask for: nothing is slower."""
        inside = inner_pairs(len(self.heights_A))
        steps = slice(inside[0], inside[-1])
        return blocks_of([run[:, steps].sum(axis=1) for run in self.runs])


def thermal_strains(frames: Sequence[Frames], temperature_K: float) -> ThermalStrains:
    """Return the strains of runs of base-pair frames (pairs, times) of one duplex, in Å.

    Strains are mid-step displacements and rotation vectors, referred to the axis of the structure
    that their means over all runs make.
    """
    if temperature_K <= 0:
        raise InputError(f"temperature: found {temperature_K:g} K; allowed: above 0")
    # (6, step, time) to (time, step, 6)
    steps = [step_strains(one).values.transpose(2, 1, 0) for one in frames]
    if not all(np.isfinite(one).all() for one in steps):
        raise InputError("a base-pair frame is missing in some frame of the trajectories")
    mean = np.concatenate(steps).mean(axis=0)
    axis = AxisStrains.of_structure(mean_structure(mean.T))
    return ThermalStrains(
        tuple(axis(one - mean) for one in steps), axis.heights_A, float(temperature_K)
    )


def covariance(sums: Array, steps: int) -> Array:
    """Return the covariance (step, 6, step, 6) of what `moments` summed."""
    size = 6 * steps
    count, first, second = sums[0], sums[1 : size + 1], sums[size + 1 :].reshape(size, size)
    matrix = (second - np.outer(first, first) / count) / (count - 1)
    return np.asarray(matrix.reshape(steps, 6, steps, 6))


def moments(block: Array) -> Array:
    """Return number, sums and sums of products of a block (time, step, 6), flat."""
    flat = block.reshape(len(block), -1)
    return np.concatenate([[len(flat)], flat.sum(axis=0), (flat.T @ flat).ravel()])


def thermal_constants(
    strains: ThermalStrains, mass: RodMass, kind: str, source: str = "", sequence: str = ""
) -> list[Constant]:
    """Return the constants and speeds of segments and waves of every length, with intervals.

    Routes `{kind}, segments of {n} steps`, `{kind}, wave of {n} steps`, q = 0 as `{kind} K(q->0)`,
    and, with the `sequence` of strand I, `{kind}, steps {AG}` of each kind of step. The inverse of
    a covariance of n independent samples is too large by about (p + 1)/n for p strains; the block
    jackknife takes that off.
    """
    pairs = len(strains.heights_A)
    blocks = strains.blocks()
    sums = np.array([moments(block) for block in blocks.of(strains.runs)])
    waves = [n for n in WAVES_IN_STEPS if n <= 2 * (len(inner_pairs(pairs)) - 1)]
    names = (*STIFFNESS, *SPEEDS)

    def estimate(total: Array) -> Array:
        compliance = covariance(total, pairs - 1) / strains.energy_kJ_per_mol
        parts = [
            segments_compliance(compliance, strains.heights_A, n).mean(axis=0)
            for n in segment_lengths(pairs)
        ]
        parts += [wave_compliance(compliance, strains.heights_A, n) for n in (*waves, np.inf)]
        if sequence:
            parts += kinds_compliance(compliance, strains.heights_A, sequence).values()
        stiffness = [stiffness_of(part) for part in parts]
        return np.array([list((one | mass.speeds(one)).values()) for one in stiffness])

    found = jackknife(sums, estimate, np.array([name not in SIGNED for name in names]))
    text = interval_text(blocks, len(sums))
    routes = [f"{kind}, segments of {n} steps" for n in segment_lengths(pairs)]
    routes += [f"{kind}, wave of {n} steps" for n in waves]
    routes.append(f"{kind} {LONGEST_WAVE}")
    if sequence:
        routes += [f"{kind}, steps {one}" for one in step_kinds(sequence)]
    return [
        Constant(
            route,
            name,
            float(found.value[row, column]),
            float(found.low[row, column]),
            float(found.high[row, column]),
            text,
            source,
        )
        for row, route in enumerate(routes)
        for column, name in enumerate(names)
    ]


def interval_text(blocks: Blocks, count: int) -> str:
    """Return the method of an interval in words."""
    text = f"95 %, jackknife over {count} blocks"
    if not blocks.long_enough:
        text += f" of {blocks.frames} frames, too short: memory lasts {blocks.inefficiency:.0f}"
    return text
