"""What a rod with constants of the same molecule says to the same question as an estimate's.

As a continuum, and as a lattice of rigid base pairs. The constants come without any wave: from the
Hessian, from static loads, from thermal fluctuations. Those of the longest segments stand for the
rod, which is a theory of long waves; the interval holds all routes with their own intervals.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from dnawaves.comparison.judge import Band
from dnawaves.errors import InputError
from dnawaves.rod.chain import PlaneChain
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import bend_standing_wave, shear_standing_wave
from dnawaves.scene.excitations import Kick, StandingWave
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import excited_pairs, held_pairs, span
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.table import PLACES, rod_of
from dnawaves.waves.estimators.correlation import arrival_ps
from dnawaves.waves.record import AXIAL_WAVES, chain_ends

# Pieces of a base-pair step that make a chain a continuum: the lattice's dispersion, (ka)²/24,
# is 64 times smaller.
FINE = 8
SEGMENTS = re.compile(r"^(hessian|thermal|thermal bases), segments of (\d+) steps$")
KINDS = ("thermal", "thermal bases", "hessian")
THERMAL_MODE = re.compile(r"^thermal mode (\d+)$")
PAPER_A_PER_PS = short_wave_speeds_A_per_ps(Rod.paper())
# Frames of a kicked chain per time in which its wave crosses one base-pair step.
FRAMES_PER_STEP = 20


@dataclass(frozen=True)
class Prediction:
    """A rod's answer, None where it has none, and the routes that its constants come from.

    `doubt` says why the constants are not those of so long a wave.
    """

    rod: Band | None
    lattice: Band | None
    routes: tuple[str, ...] = ()
    doubt: str = ""


NOTHING = Prediction(None, None)


def long_wave_routes(constants: pd.DataFrame) -> list[str]:
    """Return the routes to the constants of long waves.

    Those of thermal motion first, then of the Hessian: the longest segments, the limit of long
    waves; and static loads.
    """
    known = [str(route) for route in constants["route"].unique()]
    routes = []
    for kind in KINDS:
        segments = [route for route in known if _segment(route, kind)]
        routes += sorted(segments, key=lambda route: -_segment(route, kind))[:1]
        routes += [route for route in known if route == f"{kind} K(q->0)"]
    return routes + [route for route in known if route == "static"]


def _segment(route: str, kind: str) -> int:
    """Return the number of steps of a route by segments of a kind; 0 for other routes."""
    found = SEGMENTS.match(route)
    return int(found[2]) if found and found[1] == kind else 0


def longest_segment(constants: pd.DataFrame) -> int:
    """Return the number of steps of the longest segments that constants were taken from."""
    return max(
        (_segment(str(route), kind) for route in constants["route"].unique() for kind in KINDS),
        default=0,
    )


def constant(constants: pd.DataFrame, route: str, quantity: str) -> Band | None:
    """Return a constant by one route, or None."""
    rows = constants[(constants["route"] == route) & (constants["quantity"] == quantity)]
    if rows.empty or pd.isna(rows["value"].iloc[0]):
        return None
    return Band.of(*(float(rows[name].iloc[0]) for name in ("value", "low", "high")))


def predict(row: pd.Series, scene: SceneSpec, constants: pd.DataFrame) -> Prediction:
    """Return what the rods say to an estimate: a row of the table of speeds.

    Static estimates are a route to the constants, and nothing to predict.
    """
    estimator = str(row["estimator"])
    if pd.isna(row["speed_A_per_ps"]) or estimator.startswith("static"):
        return NOTHING
    axial = row["wave"] in AXIAL_WAVES
    answers: list[tuple[str, Band, Band]] = []
    for route in long_wave_routes(constants):
        found = (
            _axial(row, scene, constants, route) if axial else _plane(row, scene, constants, route)
        )
        if found is not None:
            answers.append((route, *found))
    if not answers:
        return NOTHING
    routes, rods, lattices = zip(*answers, strict=True)
    return Prediction(_all(rods), _all(lattices), routes, _too_short(row, constants))


def _too_short(row: pd.Series, constants: pd.DataFrame) -> str:
    """Return a doubt where the segments are less than half as long as half the wave.

    Stiffness grows with the length of the segment: that of much shorter ones is another's.
    """
    if pd.isna(row["wavenumber_rad_per_A"]):
        return ""
    half_wave = np.pi / float(row["wavenumber_rad_per_A"]) / spacing_A(constants)
    steps = longest_segment(constants)
    if steps >= half_wave / 2:
        return ""
    return f"constants from segments of {steps} steps, half a wave has {half_wave:.0f}"


def _all(bands: Sequence[Band]) -> Band:
    return Band(bands[0].value, min(band.low for band in bands), max(band.high for band in bands))


def _axial(
    row: pd.Series, scene: SceneSpec, constants: pd.DataFrame, route: str
) -> tuple[Band, Band] | None:
    """Return the answers of continuum and lattice, whose long waves have the same speed.

    A speed from a frequency was found by the lattice's relation, so a continuum's is larger by
    (ka/2)/sin(ka/2). What is read off a front or a lag is biased as the paper's lattice is. Only
    the front of a continuum is as sharp as the kick: ahead of its centre by half its width.
    """
    wave = str(row["wave"])
    coupled = "coupled" in str(row["estimator"])
    speed = (
        _uncoupled(constants, route, wave)
        if coupled
        else constant(constants, route, f"speed_{wave}_A_per_ps")
    )
    if speed is None:
        return None
    spacing = spacing_A(constants)
    continuum = lattice = 1.0
    if pd.notna(row["wavenumber_rad_per_A"]):
        half_phase = float(row["wavenumber_rad_per_A"]) * spacing / 2
        continuum = half_phase / np.sin(half_phase)
    elif pd.notna(row["paper_arrival_ps"]):
        continuum = lattice = float(row["paper_A_per_ps"]) / PAPER_A_PER_PS[wave]
        if row["estimator"] == "arrival" and isinstance(scene.excitation, Kick):
            distance_A = float(row["paper_A_per_ps"] * row["paper_arrival_ps"])
            continuum = distance_A / (distance_A - scene.excitation.pairs * spacing / 2)
    return _times(speed, continuum), _times(speed, lattice)


def _uncoupled(constants: pd.DataFrame, route: str, wave: str) -> Band | None:
    """Return the root of stiffness over density, which a fit with the coupling free finds."""
    stiffness, inertia, power = {
        "extension": ("stretch_modulus_pN", "density_Da_per_A", 1),
        "twist": ("twist_rigidity_pN_nm2", "inertia_axial_Da_A", 3),
    }[wave]
    modulus, mass = constant(constants, route, stiffness), constant(constants, "topology", inertia)
    if modulus is None or mass is None:
        return None
    # Da Å/ps² is 0.1 Da nm/ps², of a torsion 0.001 Da nm³/ps².
    scale = KJ_PER_MOL_PER_PN_NM * A_PER_NM**power / mass.value
    return Band(
        *(
            float(np.sqrt(scale * max(part, 0.0)))
            for part in (modulus.value, modulus.low, modulus.high)
        )
    )


def _plane(
    row: pd.Series, scene: SceneSpec, constants: pd.DataFrame, route: str
) -> tuple[Band, Band] | None:
    if str(row["estimator"]).startswith("waveform"):
        # A fit of the lattice finds the speed of short waves, by which both rods are named.
        speed = constant(constants, route, f"speed_{row['wave']}_A_per_ps")
        return None if speed is None else (speed, speed)
    rod, ask = straight_rod(constants, route), _plane_question(row, scene)
    if rod is None or ask is None:
        return None
    width = _relative_width(constants, route, str(row["wave"]))
    continuum, lattice = ask(rod, FINE), ask(rod, 1)
    return _times(width, continuum), _times(width, lattice)


def _plane_question(row: pd.Series, scene: SceneSpec) -> Callable[[Rod, int], float] | None:
    """Return the same experiment on a chain whose steps are cut into so many pieces."""
    excitation, pairs = scene.excitation, len(scene.system.duplex.sequence)
    wave = str(row["wave"])
    mode = _standing_mode(row, scene)
    if mode is not None and pd.notna(row["wavenumber_rad_per_A"]):
        wavenumber = float(row["wavenumber_rad_per_A"])
        first, last = span(scene.ends, pairs)
        standing = bend_standing_wave if wave == "bend" else shear_standing_wave
        ends = chain_ends(scene)
        # A free end is half a spacing longer than a held one.
        shorter = {"free": 0.0, "one_held": 0.5, "held": 1.0}[ends]

        def speed(rod: Rod, pieces: int) -> float:
            fine = replace(rod, spacing_nm=rod.spacing_nm / pieces)
            count = round((last - first + 1 - shorter) * pieces + shorter)
            return standing(fine, count, mode, ends).frequency_rad_per_ps / wavenumber

        return speed
    if isinstance(excitation, Kick) and row["estimator"] == "arrival":
        distance_A = float(row["paper_A_per_ps"] * row["paper_arrival_ps"])
        excited, held = excited_pairs(excitation, scene.ends), held_pairs(scene.ends, pairs)

        def front(rod: Rod, pieces: int) -> float:
            return _front_A_per_ps(rod, pieces, pairs, excited, held, wave, distance_A)

        return front
    return None


def _standing_mode(row: pd.Series, scene: SceneSpec) -> int | None:
    """Return the number of the standing wave that an estimate is of."""
    if isinstance(scene.excitation, StandingWave):
        return scene.excitation.mode
    found = THERMAL_MODE.match(str(row["estimator"]))
    return int(found[1]) if found else None


def straight_rod(constants: pd.DataFrame, route: str) -> Rod | None:
    """Return the straight, untwisted rod with the constants of one route; None if some lack."""
    known = all(constant(constants, route, name) is not None for name in PLACES)
    return rod_of(constants, route) if known else None


def _front_A_per_ps(
    rod: Rod,
    pieces: int,
    pairs: int,
    excited: Sequence[int],
    held: Sequence[int],
    wave: str,
    distance_A: float,
) -> float:
    """Return the speed at which a front arrives after a kick, of a chain of rigid pieces."""
    fine = replace(rod, spacing_nm=rod.spacing_nm / pieces)
    count = (pairs - 1) * pieces + 1
    place = np.arange(count) / pieces
    chain = PlaneChain(fine, count, [i for i in range(count) if place[i] in held])
    source = np.zeros((count, 2))
    # A base pair is half a step wide on either side.
    kicked = (place > excited[0] - 0.5) & (place < excited[-1] + 0.5)
    column = 0 if wave == "shear" else 1
    source[kicked, column] = 1.0
    source *= chain.free
    observer = round(pieces * (np.mean(excited) + distance_A / A_PER_NM / rod.spacing_nm))
    slowest = float(np.sqrt(np.diag(rod.stiffness)[0] / rod.density_Da_per_nm))
    step_ps = rod.spacing_nm / slowest / FRAMES_PER_STEP
    for crossings in (3, 9):
        times = step_ps * np.arange(crossings * pairs * FRAMES_PER_STEP, dtype=np.float64)
        velocity = chain.kick_response(times, source)[1]
        arrived = arrival_ps(times, velocity[:, observer, column])
        if arrived:
            return distance_A / arrived
    raise InputError(f"no front of {wave} arrives on the rod of these constants")


def _relative_width(constants: pd.DataFrame, route: str, wave: str) -> Band:
    """Return the interval of a short-wave speed over the speed itself.

    Of mixed waves no constant alone has the say; that of the wave's own has the larger part.
    """
    speed = constant(constants, route, f"speed_{wave}_A_per_ps")
    if speed is None:
        return Band(1.0, 1.0, 1.0)
    return Band(1.0, speed.low / speed.value, speed.high / speed.value)


def _times(band: Band, factor: float) -> Band:
    return Band(*(factor * part for part in (band.value, band.low, band.high)))


def spacing_A(constants: pd.DataFrame) -> float:
    """Return the mean distance of base pairs; raises `InputError` where it is not there."""
    spacing = constant(constants, "topology", "spacing_A")
    if spacing is None:
        raise InputError("constants: found no spacing_A by the route 'topology'")
    return spacing.value
