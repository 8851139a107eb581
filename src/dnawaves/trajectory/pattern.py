"""The shape in space of an excitation: each base pair moved or pushed as a rigid body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dnawaves.rod.rod import Rod
from dnawaves.rod.standing import axial_standing_wave, bend_standing_wave, shear_standing_wave
from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import Ends
from dnawaves.scene.pairs import excited_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.units import A_PER_NM, PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]

# Distance of a base pair's outermost atoms from the helix axis.
RIM_NM = 1.0


@dataclass(frozen=True)
class Pattern:
    """Rigid-body motion of each base pair.

    `linear` (N,) along the wave's direction in nm/ps, `angular` (N,) about the wave's rotation
    axis through the point of the helix axis at the base pair's height, in rad/ps.
    """

    wave: str
    linear: Array
    angular: Array

    def velocities(self, duplex: SimulatedDuplex) -> Array:
        """Return the velocities of the duplex's atoms, (solute, 3) in nm/ps."""
        along, about = directions(duplex, self.wave)
        arms = duplex.positions_nm[: duplex.solute] - duplex.pivots_nm[duplex.pairs]
        return self.linear[duplex.pairs, None] * along + self.angular[
            duplex.pairs, None
        ] * np.cross(about, arms)


def directions(duplex: SimulatedDuplex, wave: str) -> tuple[Array, Array]:
    """Return the direction of a wave's displacement and the axis of its rotation, (3,) each."""
    first, second, axis = duplex.frame.directions
    return (axis, axis) if wave in ("extension", "twist") else (first, second)


def kick_pattern(excitation: Kick | StandingWave, ends: Ends, pairs: int) -> Pattern:
    """Return the velocities that a kick of scale 1 puts in."""
    if isinstance(excitation, StandingWave):
        return _standing_pattern(excitation, ends, pairs)
    return _local_pattern(excitation, ends, pairs, excitation.amplitude)


def forces_at_full_strength(
    excitation: Pulse | Periodic, ends: Ends, duplex: SimulatedDuplex
) -> Array:
    """Return the forces on the duplex's atoms, (solute, 3), in kJ/mol/nm at full strength.

    The excited base pairs are accelerated as rigid bodies; the forces add up to the declared
    total force, or the torques about the pivots to the declared total torque.
    """
    unit = _local_pattern(excitation, ends, duplex.pair_count, 1.0)
    forces = duplex.masses_Da[: duplex.solute, None] * unit.velocities(duplex)
    along, about = directions(duplex, excitation.wave)
    arms = duplex.positions_nm[: duplex.solute] - duplex.pivots_nm[duplex.pairs]
    if excitation.wave in ("extension", "shear"):
        total = float(np.sum(forces @ along))
    else:
        total = float(np.sum(np.cross(arms, forces) @ about))
    # pN nm per kJ/mol is the same number as pN per kJ/mol/nm.
    scaled: Array = forces * (excitation.amplitude / PN_PER_KJ_PER_MOL_NM / total)
    return scaled


def _local_pattern(
    excitation: Kick | Pulse | Periodic, ends: Ends, pairs: int, amplitude: float
) -> Pattern:
    chosen = np.zeros(pairs)
    chosen[excited_pairs(excitation, ends)] = 1.0
    nothing = np.zeros(pairs)
    if excitation.wave in ("extension", "shear"):
        return Pattern(excitation.wave, chosen * amplitude / A_PER_NM, nothing)
    return Pattern(excitation.wave, nothing, chosen * amplitude)


def _standing_pattern(excitation: StandingWave, ends: Ends, pairs: int) -> Pattern:
    linear, angular = np.zeros(pairs), np.zeros(pairs)
    outer = ends.pairs - 1
    inside = slice(outer, pairs - outer)
    count = pairs - 2 * outer
    if excitation.wave in ("extension", "twist"):
        shape = axial_standing_wave(count, excitation.mode, "held")
        shape = shape * (excitation.amplitude / np.abs(shape).max())
        if excitation.wave == "extension":
            linear[inside] = shape / A_PER_NM
        else:
            angular[inside] = shape
        return Pattern(excitation.wave, linear, angular)
    # The paper's rod only chooses the shape that is kicked, not the frequency that is measured.
    standing = bend_standing_wave if excitation.wave == "bend" else shear_standing_wave
    plane = standing(Rod.paper(), count, excitation.mode, "held")
    if excitation.wave == "bend":
        scale = excitation.amplitude / np.abs(plane.rotation_rad_per_nm).max()
    else:
        # In these shapes the base pairs turn more than they shift: what is scaled is the fastest
        # of the base pair itself and of atoms at its rim.
        rim = RIM_NM * np.abs(plane.rotation_rad_per_nm).max()
        scale = excitation.amplitude / A_PER_NM / max(np.abs(plane.displacement).max(), rim)
    linear[inside] = plane.displacement * scale
    angular[inside] = plane.rotation_rad_per_nm * scale
    return Pattern(excitation.wave, linear, angular)
