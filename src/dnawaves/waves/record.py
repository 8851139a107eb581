"""One recorded run as the estimators see it: fields, ends, spacing and the paper's speeds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.motion.fields import wave_fields
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import Ends
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import fixed_counts, fixed_pairs, span
from dnawaves.units import A_PER_NM
from dnawaves.waves.estimators.window import usable_frames

Array = NDArray[np.float64]

AXIAL_WAVES = ("extension", "twist")
# By the number of ends at which a wave is reflected.
BY_FIXED: tuple[Ends, ...] = ("free", "one_held", "held")


def chain_ends(scene: SceneSpec) -> Ends:
    """Return how the chain of base pairs that a wave can reach ends."""
    fixed = sum(count > 0 for count in fixed_counts(scene.ends))
    return BY_FIXED[fixed]


@dataclass(frozen=True, eq=False)
class Record:
    """A recorded member of a scene."""

    scene: SceneSpec
    member: str
    motion: xr.Dataset

    @cached_property
    def fields(self) -> xr.Dataset:
        """Displacements and velocities of the waves, (time, pair)."""
        return wave_fields(self.motion)

    @property
    def times_ps(self) -> Array:
        """Times of the frames."""
        return np.asarray(self.motion["time"].values)

    def velocity(self, wave: str) -> Array:
        """Velocity field (time, pair) of a wave, Å/ps or rad/ps."""
        return np.asarray(self.fields[f"{wave}_velocity"].values)

    @cached_property
    def usable(self) -> int:
        """Number of frames before the difference holds more energy than was put in."""
        return usable_frames(self.fields)

    @property
    def pairs(self) -> int:
        """Number of base pairs."""
        return int(self.motion.sizes["pair"])

    @property
    def held(self) -> list[int]:
        """Indices of the base pairs at which a wave is reflected: held or restrained."""
        return fixed_pairs(self.scene.ends, self.pairs)

    @property
    def length_A(self) -> float:
        """Length of the duplex along its axis, first to last base pair."""
        height = self.motion["height"].values
        return float(height[-1] - height[0])

    @property
    def spacing_nm(self) -> float:
        """Mean distance of base pairs along the axis."""
        return self.length_A / (self.pairs - 1) / A_PER_NM

    @property
    def span(self) -> tuple[int, int]:
        """First and last base pair that a wave can reach."""
        return span(self.scene.ends, self.pairs)

    @property
    def ends(self) -> Ends:
        """How the chain of base pairs that a wave can reach ends."""
        return chain_ends(self.scene)

    @property
    def free_length_A(self) -> float:
        """Distance between the innermost held base pairs."""
        height = self.motion["height"].values
        first, last = self.span
        return float(height[last] - height[first])

    def inertia_Da_A2(self, direction: str) -> float:
        """Mean moment of inertia of a base pair about a direction through the helix axis."""
        return float(np.mean(self.inertias_Da_A2(direction)))

    def inertias_Da_A2(self, direction: str) -> Array:
        """Moment of inertia (pair,) of each base pair about a direction through the helix axis."""
        axis = self.motion["direction"].sel(axis=direction).values
        own = np.einsum("x,pxy,y->p", axis, self.motion["inertia"].values, axis)
        arm = self.motion["centre"].values - self.motion["pivot"].values
        arm = arm - np.outer(arm @ axis, axis)
        return np.asarray(own + self.motion["mass"].values * np.sum(arm**2, axis=1))

    @cached_property
    def paper_speeds_A_per_ps(self) -> dict[str, float]:
        """The paper's four speeds."""
        return short_wave_speeds_A_per_ps(Rod.paper())
