"""One rod for all waves of a system: the constants that its scenes imply together.

Long waves see a straight rod averaged about the helix axis: extension and twist, coupled, and bend
and shear in a plane. So the rod falls into two lattices, each fitted at once to all records in
which one of its waves was excited; these share the stiffness and one friction. Each record is
scaled by the energy that was put into it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, whole_file
from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import SceneSpec
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.rod_mass import RodMass
from dnawaves.waves.constants.table import Constant
from dnawaves.waves.estimators.lattice_fit import LatticeFit, Observation, Value, fit_lattice
from dnawaves.waves.estimators.lattices import FRICTION
from dnawaves.waves.estimators.long_waves import Projection
from dnawaves.waves.estimators.window import FEWEST_FRAMES, windows
from dnawaves.waves.observations import AXIAL, PLANE, coupled, plane
from dnawaves.waves.record import Record
from dnawaves.waves.rows import model_class
from dnawaves.waves.scene_source import mean_mass
from dnawaves.waves.table import CSV_FORMAT
from dnawaves.waves.waveforms import COUPLING, long_waves

Array = NDArray[np.float64]
Observe = Callable[[Record, int], Observation]
Constants = dict[str, float]

ROUTE = "waves, joint"
STRETCH, TWIST, COUPLED = (
    "stretch_modulus_pN",
    "twist_rigidity_pN_nm2",
    "twist_stretch_coupling_pN_nm",
)
BEND, SHEAR = "bend_rigidity_pN_nm2", "shear_stiffness_pN"


@dataclass(frozen=True)
class JointConstant(Constant):
    """A constant of the rod, with the misfit of the fit that gave it and whether that fits."""

    misfit: float | None = None
    model_class: str = ""
    friction_per_ps: float | None = None


def joint_step(motions: Sequence[Path], output: Path) -> None:
    """Write the constants that the motion of one system's scenes implies, as CSV.

    `motions` are files that `dnawaves simulate` wrote, of any scenes of the system; those of static
    loads, of nulls and above 0 K have no part in it, nor has a smaller kick beside a larger one. A
    harmonic scene counts where no scene was simulated.
    """
    records = [_read(path) for path in motions]
    systems = {record.scene.system.name for record in records}
    if len(systems) != 1:
        raise InputError(
            f"joint: found motion of {', '.join(sorted(systems)) or 'none'}; allowed: one system"
        )
    rows = joint_constants(records)
    with whole_file(output) as temporary:
        frame = pd.DataFrame(
            [asdict(row) for row in rows], columns=[field.name for field in fields(JointConstant)]
        )
        frame.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def joint_constants(records: Sequence[Record]) -> list[JointConstant]:
    """Return the constants of the rod that the waves in some scenes imply together."""
    chosen = _chosen(records)
    rows = []
    for waves, observe, constants in (
        (AXIAL, coupled, _axial_constants),
        (PLANE, plane, _plane_constants),
    ):
        of_these = [record for record in chosen if _excited(record) in waves]
        if of_these:
            rows += _fit(of_these, waves, observe, constants)
    return rows


def _fit(
    records: Sequence[Record],
    waves: tuple[str, ...],
    observe: Observe,
    constants: Callable[[LatticeFit, Record], Constants],
) -> list[JointConstant]:
    seen = [_by_energy(record, waves) for record in records]

    def fit(
        which: Sequence[int],
        window: int = 0,
        starts: list[dict[str, float]] | None = None,
        intervals: Sequence[str] = (),
    ) -> LatticeFit:
        observations = []
        for index in which:
            frames = windows(records[index].usable)
            observed = observe(records[index], frames[min(window, len(frames) - 1)])
            observations.append(replace(observed, noise=seen[index]))
        return fit_lattice(observations, starts, intervals)

    everything = range(len(records))
    names = [name for name in observe(records[0], 2).lattice.names if name != FRICTION]
    begin = _starts(records, waves, observe, seen)
    first = fit(everything, starts=begin, intervals=names)
    near = [{name: value.value for name, value in first.values.items()}]
    scenes = list(dict.fromkeys(record.scene.name for record in records))
    others = [fit(everything, window, near) for window in (1, 2)]
    if len(scenes) > 1:
        others += [
            fit([i for i in everything if records[i].scene.name != left], starts=near)
            for left in scenes
        ]
    found = constants(first, records[0])
    varied = [constants(one, records[0]) for one in others]
    known = profiled(first, names, lambda one: constants(one, records[0]))
    misfit = first.model_class.misfit
    return [
        JointConstant(
            ROUTE,
            quantity,
            value,
            *_range([value, *known[quantity], *(one[quantity] for one in varied)]),
            "model spread over windows, scenes left out, or profile likelihood where wider",
            ", ".join(scenes),
            misfit,
            model_class(misfit),
            first[FRICTION].value,
        )
        for quantity, value in found.items()
    ]


def _starts(
    records: Sequence[Record], waves: tuple[str, ...], observe: Observe, seen: list[Projection]
) -> list[dict[str, float]]:
    """Return every combination of what the first scene of each wave says of its own wave."""
    found = {}
    for wave in waves:
        own = [index for index, record in enumerate(records) if _excited(record) == wave]
        if own:
            observed = observe(records[own[0]], records[own[0]].usable)
            alone = fit_lattice([replace(observed, noise=seen[own[0]])], intervals=[])
            found[wave] = alone
    starts = [{name: value.value for name, value in one.values.items()} for one in found.values()]
    together = dict(starts[0])
    for wave, one in found.items():
        together[f"{wave}_A_per_ps"] = one[f"{wave}_A_per_ps"].value
    if COUPLING in together:
        return [*starts, *(together | {COUPLING: coupling} for coupling in (-0.3, 0.0, 0.3))]
    return [*starts, together]


def profiled(
    first: LatticeFit, names: Sequence[str], constants: Callable[[LatticeFit], Constants]
) -> dict[str, tuple[float, float]]:
    """Return the ends of each constant that the profile likelihoods of the fitted values allow.

    Each value is moved to its two limits; what that does to a constant of several values is added
    in quadrature. A constant that is not finite at a limit is known on neither side.
    """
    found = constants(first)
    down, up = ({quantity: 0.0 for quantity in found} for _ in range(2))
    for name in names:
        with np.errstate(invalid="ignore"):
            moved = [
                constants(replace(first, values=first.values | {name: Value(limit, limit, limit)}))
                for limit in (first[name].low, first[name].high)
            ]
        for quantity, value in found.items():
            changes = np.array([one.get(quantity, np.nan) - value for one in moved])
            known = np.isfinite(changes).all()
            down[quantity] = np.hypot(down[quantity], -changes.min(initial=0) if known else np.inf)
            up[quantity] = np.hypot(up[quantity], changes.max(initial=0) if known else np.inf)
    # All but the coupling are positive.
    least = {quantity: -np.inf if quantity == COUPLED else 0.0 for quantity in found}
    return {
        quantity: (max(float(value - down[quantity]), least[quantity]), float(value + up[quantity]))
        for quantity, value in found.items()
    }


def _range(values: Sequence[float]) -> tuple[float, float]:
    return min(values), max(values)


def _axial_constants(fit: LatticeFit, record: Record) -> Constants:
    stretch = _stiffness(record, "extension", fit["extension_A_per_ps"].value)
    twist = _stiffness(record, "twist", fit["twist_A_per_ps"].value)
    coupling = fit[COUPLING].value
    given = {STRETCH: stretch, TWIST: twist, COUPLED: coupling * float(np.sqrt(stretch * twist))}
    relaxed = 1 - coupling**2
    return {
        **given,
        "stretch_modulus_relaxed_pN": stretch * relaxed,
        "twist_rigidity_relaxed_pN_nm2": twist * relaxed,
        **_rod_mass(record).speeds(given),
    }


def _plane_constants(fit: LatticeFit, record: Record) -> Constants:
    given = {
        BEND: _stiffness(record, "bend", fit["bend_A_per_ps"].value),
        SHEAR: _stiffness(record, "shear", fit["shear_A_per_ps"].value),
    }
    return {**given, **_rod_mass(record).speeds(given)}


def _stiffness(record: Record, wave: str, speed_A_per_ps: float) -> float:
    """Return mass per length times the speed squared: pN, or pN nm^2 of what turns."""
    per_length = mean_mass(record, wave) / record.spacing_nm
    return per_length * (speed_A_per_ps / A_PER_NM) ** 2 / KJ_PER_MOL_PER_PN_NM


def _rod_mass(record: Record) -> RodMass:
    spacing_A = record.spacing_nm * A_PER_NM
    return RodMass(
        mean_mass(record, "extension") / spacing_A,
        A_PER_NM**2 * mean_mass(record, "twist") / spacing_A,
        A_PER_NM**2 * mean_mass(record, "bend") / spacing_A,
    )


def _by_energy(record: Record, waves: tuple[str, ...]) -> Projection:
    """Return the long waves of a record in units of the energy that was put in."""
    projection = long_waves(record, waves)[0]
    energy = float(record.fields["energy_put_in"].max())
    return Projection(projection.directions / np.sqrt(2 * energy))


def _chosen(records: Sequence[Record]) -> list[Record]:
    """Return the records that a joint fit looks at; see `joint_step`."""
    simulated = any(
        record.scene.method == "simulated" and _moves(record.scene) for record in records
    )
    method = "simulated" if simulated else "harmonic"
    chosen: list[Record] = []
    for record in records:
        scene = record.scene
        if not _moves(scene) or scene.method != method or record.usable < FEWEST_FRAMES:
            continue
        many = isinstance(scene.excitation, Periodic)
        if many or all(other.scene.name != scene.name for other in chosen):
            chosen.append(record)
    return chosen


def _moves(scene: SceneSpec) -> bool:
    return (
        isinstance(scene.excitation, Kick | StandingWave | Pulse | Periodic)
        and not scene.system.thermal
    )


def _excited(record: Record) -> str:
    return str(getattr(record.scene.excitation, "wave", ""))


def _read(path: Path) -> Record:
    motion = read_netcdf(path, "velocity", "angular_velocity")
    return Record(SceneSpec.model_validate_json(motion.attrs["scene"]), path.parent.name, motion)
