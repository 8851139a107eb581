"""What a run keeps: the rigid-body motion of every base pair, energies, and the base atoms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import MDAnalysis
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.files import provenance
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.plan import Plan
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]
State = tuple[Array, Array, float]

SIGNS = {"plus": 1, "minus": -1}


class Recorder:
    """Collects the frames of the copies of one run; `keep_atoms` for trajectories too."""

    def __init__(
        self,
        duplex: SimulatedDuplex,
        scene: SceneSpec,
        plan: Plan,
        signs: tuple[int, ...],
        keep_atoms: bool = False,
        platform: str = "CPU",
    ) -> None:
        self._duplex, self._scene, self._plan, self._signs = duplex, scene, plan, signs
        self._platform = platform
        self._atoms = base_atoms(duplex) if keep_atoms else None
        self._frames: dict[str, list[NDArray[Any]]] = {}

    def __len__(self) -> int:
        return len(self._frames.get("motion", ()))

    def add(
        self,
        states: list[State],
        work_kJ_per_mol: list[float],
        momenta: Sequence[Array] | None = None,
        temperatures_K: Sequence[float] | None = None,
    ) -> None:
        """Record one frame: for each sign the state, the drive's work and what was put in.

        Of the states only the duplex's atoms matter, which come first: what has gone over into
        water is lost to the wave. `momenta` are momentum (Da nm/ps) and angular momentum about the
        origin (Da nm²/ps), (2, 3); `temperatures_K` those of all that moves, above 0 K.
        """
        bodies, atoms = self._duplex.bodies, slice(self._duplex.solute)
        states = [(positions[atoms], v[atoms], energy) for positions, v, energy in states]
        half = antisymmetric([velocities for _, velocities, _ in states])
        frame = {
            "motion": [
                [*bodies.pose(positions), *bodies.velocity(positions, velocities)]
                for positions, velocities, _ in states
            ],
            "energy": [energy for _, _, energy in states],
            "work": work_kJ_per_mol,
            "difference_energy": 0.5 * np.sum(self._duplex.masses_Da[atoms, None] * half**2),
        }
        if momenta is not None:
            frame["momenta"] = momenta
        if temperatures_K is not None:
            frame["temperature"] = temperatures_K
        for name, value in frame.items():
            self._frames.setdefault(name, []).append(np.array(value))
        if self._atoms is not None:
            # In single precision, as the files are.
            kept = [np.float32(positions[self._atoms] * A_PER_NM) for positions, _, _ in states]
            self._frames.setdefault("atoms", []).append(np.array(kept))

    def frames(self, first: int = 0) -> dict[str, NDArray[Any]]:
        """Return what was recorded from frame `first` on, by name; the first axis is time."""
        return {name: np.array(values[first:]) for name, values in self._frames.items()}

    def extend(self, frames: Mapping[str, NDArray[Any]]) -> None:
        """Record what `frames` returned."""
        for name, values in frames.items():
            self._frames.setdefault(name, []).extend(values)

    def write_trajectories(self, trajectories: dict[int, Path]) -> None:
        """Write the base atoms of each sign that has a path, as DCD."""
        for sign, path in trajectories.items():
            assert self._atoms is not None
            universe = MDAnalysis.Universe.empty(len(self._atoms), trajectory=True)
            which = self._signs.index(sign)
            with MDAnalysis.Writer(
                str(path), n_atoms=len(self._atoms), dt=self._plan.interval_ps, nsavc=1
            ) as writer:
                for positions_A in self._frames["atoms"]:
                    universe.atoms.positions = positions_A[which]
                    writer.write(universe.atoms)

    def dataset(self) -> xr.Dataset:
        """Return the record with labels and units; velocities and positions in Å."""
        frames = self.frames()
        dataset = motion_dataset(
            self._duplex,
            self._scene,
            self._plan,
            self._signs,
            # Collected as (time, sign, quantity, pair, xyz).
            frames["motion"].transpose(2, 1, 0, 3, 4),
            frames["energy"].T,
            frames["work"].T,
            frames["difference_energy"],
        )
        if "momenta" in frames:
            dataset = dataset.assign(injected_momenta(frames["momenta"].transpose(2, 1, 0, 3)))
        if "temperature" in frames:
            kelvin = {
                "units": "K",
                "long_name": "kinetic temperature of all that moves, half a step before the frame",
            }
            dataset["kinetic_temperature_K"] = (("sign", "time"), frames["temperature"].T, kelvin)
        dataset.attrs |= {"timestep_fs": self._plan.timestep_ps * 1e3, "platform": self._platform}
        dataset.attrs |= thermal_attributes(self._scene)
        return dataset


def thermal_attributes(scene: SceneSpec) -> dict[str, float]:
    """Return the temperature of a scene above 0 K, and its thermostat's friction if it has one."""
    found = {}
    if scene.system.thermal:
        found["temperature_K"] = scene.system.environment.temperature_K
    if scene.thermostat is not None:
        found["thermostat_friction_per_ps"] = scene.thermostat.friction_per_ps
    return found


def motion_dataset(
    duplex: SimulatedDuplex,
    scene: SceneSpec,
    plan: Plan,
    signs: tuple[int, ...],
    motion: Array,
    energy_kJ_per_mol: Array,
    work_kJ_per_mol: Array,
    difference_energy_kJ_per_mol: Array,
) -> xr.Dataset:
    """Return a record with labels and units; velocities and positions in Å.

    `motion` is (4, signs, frames, N, 3): displacement, rotation, velocity, angular velocity in nm,
    ps and rad; energy and work are (signs, frames), the difference's kinetic energy (frames,).
    """
    frame, energy = duplex.frame, {"units": "kJ/mol"}

    def vectors(values: Array, units: str, what: str) -> tuple[object, ...]:
        return ("sign", "time", "pair", "xyz"), values, {"units": units, "long_name": what}

    return xr.Dataset(
        {
            "displacement": vectors(
                motion[0] * A_PER_NM, "angstrom", "displacement of the centre of mass"
            ),
            "rotation": vectors(motion[1], "rad", "rotation vector from the reference"),
            "velocity": vectors(
                motion[2] * A_PER_NM, "angstrom/ps", "velocity of the centre of mass"
            ),
            "angular_velocity": vectors(motion[3], "rad/ps", "angular velocity"),
            "total_energy": (("sign", "time"), energy_kJ_per_mol, energy),
            "work": (("sign", "time"), work_kJ_per_mol, energy),
            "difference_kinetic_energy": (("time",), difference_energy_kJ_per_mol, energy),
            "mass": (("pair",), duplex.bodies.masses_Da, {"units": "Da"}),
            "inertia": (
                ("pair", "xyz", "abc"),
                duplex.bodies.inertia_Da_nm2 * A_PER_NM**2,
                {"units": "Da angstrom^2", "long_name": "about the centre of mass"},
            ),
            "centre": (
                ("pair", "xyz"),
                duplex.bodies.centres_nm * A_PER_NM,
                {"units": "angstrom"},
            ),
            "pivot": (
                ("pair", "xyz"),
                duplex.pivots_nm * A_PER_NM,
                {"units": "angstrom", "long_name": "point of the helix axis at the pair"},
            ),
            "direction": (("axis", "xyz"), frame.directions, {"units": "1"}),
        },
        coords={
            "sign": list(signs),
            "time": (
                "time",
                np.arange(motion.shape[2]) * plan.interval_ps,
                {"units": "ps"},
            ),
            "pair": duplex.labels,
            "height": ("pair", duplex.heights_nm * A_PER_NM, {"units": "angstrom"}),
            "xyz": ["x", "y", "z"],
            "axis": ["first", "second", "helix"],
        },
        attrs={
            "scene": scene.model_dump_json(),
            "method": scene.method,
            **(
                {"frequency_GHz": plan.frequency_GHz, "ramp_ps": plan.ramp_ps}
                if plan.frequency_GHz
                else {}
            ),
            **({"drive_mode": plan.drive_mode} if plan.drive_mode else {}),
            **({"pulse_width_ps": plan.pulse_width_ps} if plan.pulse_width_ps else {}),
            **provenance("openmm", "numpy"),
        },
    )


def injected_momenta(momenta: Array) -> dict[str, tuple[tuple[str, ...], Array, dict[str, str]]]:
    """Return what kick and drive have put in as variables of a record.

    `momenta` is (2, signs, frames, 3): Da nm/ps, and Da nm²/ps about the origin.
    """
    dims, what = ("sign", "time", "xyz"), "put in by kick and drive"
    return {
        "injected_momentum": (
            dims,
            momenta[0] * A_PER_NM,
            {"units": "Da angstrom/ps", "long_name": f"momentum {what}"},
        ),
        "injected_angular_momentum": (
            dims,
            momenta[1] * A_PER_NM**2,
            {
                "units": "Da angstrom^2/ps",
                "long_name": f"angular momentum about the origin {what}",
            },
        ),
    }


def antisymmetric(values: list[Array]) -> Array:
    """Return half the difference of the two signs, in which even orders cancel; one as it is."""
    return values[0] if len(values) == 1 else 0.5 * (values[0] - values[1])


def base_atoms(duplex: SimulatedDuplex) -> NDArray[np.intp]:
    """Return the indices of the atoms that base frames need: the rings, and C1' for pairing."""
    ring = {"N1", "C2", "N3", "C4", "C5", "C6", "N7", "C8", "N9", "C1'"}
    return np.array(
        [
            atom.index
            for atom in islice(duplex.topology.atoms(), duplex.solute)
            if atom.name in ring
        ],
        dtype=np.intp,
    )
