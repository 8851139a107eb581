"""The frequency of a periodic drive: given, that of a standing wave, or from fitted rods."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dnawaves.errors import InputError
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import (
    Ends,
    axial_frequency_rad_per_ps,
    bend_standing_wave,
    shear_standing_wave,
)
from dnawaves.scene.excitations import AXIAL_WAVES, Periodic
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import span
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS

SWEEP_MARGIN = 1.3


@dataclass(frozen=True)
class Drive:
    """A sine that rises over `ramp_ps`; `mode` where the scene asks for it by its number."""

    frequency_GHz: float
    ramp_ps: float = 0.0
    mode: int | None = None

    @property
    def period_ps(self) -> float:
        """Time of one period."""
        return 1e3 / self.frequency_GHz


def drive_of(
    scene: SceneSpec,
    member: str,
    estimates_A_per_ps: Mapping[str, float],
    length_A: float,
    spacing_A: float,
    fitted_speeds_A_per_ps: Sequence[float] = (),
) -> Drive:
    """Return the drive of one member of a periodic scene; arguments as of `plan.make_plan`."""
    excitation = scene.excitation
    assert isinstance(excitation, Periodic)
    number = re.match(r"f(\d+)", member)
    assert number is not None
    index = int(number[1]) - 1
    mode = None
    if excitation.modes is not None:
        mode = excitation.modes[index]
        frequency_GHz = mode_frequency_GHz(scene, mode, estimates_A_per_ps, spacing_A)
    elif excitation.sweep is not None:
        frequency_GHz = sweep_GHz(excitation, length_A, fitted_speeds_A_per_ps)[index]
    else:
        frequency_GHz = excitation.given_GHz[index]
    return Drive(frequency_GHz, excitation.ramp_periods * 1e3 / frequency_GHz, mode)


def mode_frequency_GHz(
    scene: SceneSpec, mode: int, estimates_A_per_ps: Mapping[str, float], spacing_A: float
) -> float:
    """Return the frequency of a standing wave of the chain of base pairs between these ends.

    Modes are counted as a standing-wave scene counts them: of the wave's own branch. The chain has
    the duplex's own spacing; its speed is the first estimate or the paper's, its bend and shear are
    those of the paper's rod. A restrained end counts as held.

    Raises
    ------
    InputError
        When the chain has no such mode.
    """
    excitation = scene.excitation
    assert isinstance(excitation, Periodic)
    first, last = span(scene.ends, len(scene.system.duplex.sequence))
    pairs, wave = last - first + 1, excitation.wave
    ends = _chain_ends(scene)
    rod = replace(Rod.paper(), spacing_nm=spacing_A / A_PER_NM)
    if wave in AXIAL_WAVES:
        speeds = (
            estimates_A_per_ps
            if excitation.rod == "measured"
            else short_wave_speeds_A_per_ps(Rod.paper())
        )
        rate = axial_frequency_rad_per_ps(pairs, mode, ends, speeds[wave], rod.spacing_nm)
    else:
        standing = bend_standing_wave if wave == "bend" else shear_standing_wave
        rate = standing(rod, pairs, mode, ends).frequency_rad_per_ps
    return rate * GHZ_PER_RAD_PER_PS


def sweep_GHz(
    excitation: Periodic, length_A: float, fitted_speeds_A_per_ps: Sequence[float]
) -> tuple[float, ...]:
    """Return frequencies that span the lowest modes V/2L of the paper's rod and of fitted ones.

    With a margin at either end.
    """
    assert excitation.sweep is not None
    wanted = excitation.sweep.scenes
    if len(fitted_speeds_A_per_ps) != len(wanted):
        raise InputError(
            f"excitation.sweep: found {len(fitted_speeds_A_per_ps)} fitted speeds; "
            f"allowed: one for each of {', '.join(wanted)}"
        )
    paper = short_wave_speeds_A_per_ps(Rod.paper())[excitation.wave]
    modes_GHz = [1e3 * speed / (2 * length_A) for speed in (paper, *fitted_speeds_A_per_ps)]
    sweep = np.linspace(
        min(modes_GHz) / SWEEP_MARGIN, max(modes_GHz) * SWEEP_MARGIN, excitation.sweep.points
    )
    return tuple(float(frequency) for frequency in sweep)


def _chain_ends(scene: SceneSpec) -> Ends:
    free = [scene.ends.first, scene.ends.last].count("free")
    kinds: tuple[Ends, Ends, Ends] = ("held", "one_held", "free")
    return kinds[free]
