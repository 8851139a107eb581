"""A static load on a guided end: the duplex relaxed to its minimum under it, with both signs."""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from dnawaves.scene.excitations import Static
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.guided import GuidedEnd, linear_response
from dnawaves.system.hessian import ReferenceForces
from dnawaves.system.minimum import BasinLeftError, minimise, shifted_factor
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.record import Recorder
from dnawaves.units import A_PER_NM, PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]
SIGNS = (1, -1)
# Gain of energy, over that of the linear response, at which the basin counts as left. A softening
# spring at its limit of stability gains less than this.
BASIN_GAIN = 3.0


def relax_under_load(
    duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan, scale: float, hessian: Array
) -> xr.Dataset:
    """Return one frame per sign: the minimum under a constant force or torque on the last pair.

    The minimisation ends at the force tolerance of the unloaded structure, so no slow relaxation
    is left over. Where the load drives the duplex into another basin there is no response of this
    structure to report: the attribute `left_basin` names the sign, and the displacements are
    those of the linear response.
    """
    assert isinstance(scene.excitation, Static)
    end = GuidedEnd(duplex, scene.excitation.wave, scene.ends.pairs)
    # pN nm per kJ/mol is the same number as pN per kJ/mol/nm.
    load = scale * scene.excitation.amplitude / PN_PER_KJ_PER_MOL_NM
    start, reduced = end.start(), end.hessian(hessian)
    locked = linear_response(end, hessian)
    push = np.zeros(start.size)
    push[-1] = load
    factor, _ = shifted_factor(reduced.copy())
    linear = cho_solve(factor, push)
    forces = ReferenceForces(duplex.system)
    unloaded, _ = forces(duplex.positions_nm)
    states, left = [], []
    for sign in SIGNS:
        report = _reporter(f"{scene.name} x{sign * scale:g}")
        try:
            minimum = minimise(
                _loaded(end, forces, sign * load),
                lambda _: reduced.copy(),
                start,
                scene.system.environment.to_minimum.force_tolerance_kJ_per_mol_nm,
                lowest_energy=unloaded - BASIN_GAIN * 0.5 * float(push @ linear),
                report=report,
            )
            coordinates, energy = minimum.coordinates_nm, minimum.energy_kJ_per_mol
        except BasinLeftError as error:
            report(f"left the basin: {error}")
            left.append(sign)
            coordinates, energy = start + sign * linear, unloaded
        states.append((end.positions(coordinates), np.zeros_like(duplex.positions_nm), energy))
    recorder = Recorder(duplex, scene, plan, SIGNS)
    recorder.add(states, [0.0, 0.0])
    dataset = recorder.dataset()
    dataset.attrs["left_basin"] = ",".join(f"{sign:+d}" for sign in left)
    dataset.attrs["load"] = scale * scene.excitation.amplitude
    # Å per pN, or rad per pN nm.
    per_unit = (A_PER_NM if end.wave == "extension" else 1.0) / PN_PER_KJ_PER_MOL_NM
    dataset["linear_response"] = (("lock",), per_unit * np.array(list(locked.values())))
    return dataset.assign_coords(lock=list(locked))


def _loaded(
    end: GuidedEnd, forces: ReferenceForces, load: float
) -> Callable[[Array], tuple[float, Array]]:
    def evaluate(coordinates: Array) -> tuple[float, Array]:
        positions = end.positions(coordinates)
        energy, atoms = forces(positions)
        force = end.force(positions, atoms)
        force[-1] += load
        return energy - load * float(coordinates[-1]), force

    return evaluate


def _reporter(title: str) -> Callable[[str], None]:
    return lambda line: print(f"{title}: {line}", file=sys.stderr, flush=True)
