"""A miniature folder of results made from closed forms: a uniform rod twice as fast as the paper's.

Nothing is simulated, so the truth behind every figure is known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from dnawaves.comparison.steps import compare_step
from dnawaves.files import write_json, write_netcdf, write_text
from dnawaves.report.gather import Results, gather
from dnawaves.report.steps import report_step
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.modal import impulse_response
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import axial_standing_wave, axial_wavenumber
from dnawaves.scene.load import load_scenes
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.table import Constant, write_constants
from dnawaves.waves.estimators.spectrum import frequency_wavenumber
from dnawaves.waves.table import Estimate, spread, write_table

Array = NDArray[np.float64]

PAIRS = 10
SPACING_A = 3.3
LENGTH_A = SPACING_A * (PAIRS - 1)
PAPER_A_PER_PS = short_wave_speeds_A_per_ps(Rod.paper())["extension"]
SPEED_A_PER_PS = 2 * PAPER_A_PER_PS
FRICTION_PER_PS = 0.1
TIMES_PS = np.linspace(0, 5, 101)
LOAD_PN = 100.0
SYSTEM = "tiny-condensed"
TOO_SHORT = "only 3 frames before the difference holds more energy than was put in"

CONFIG = """
structures: duplexes.yaml
environments:
  condensed: {}
scenes:
  kick:
    duplex: tiny
    environment: condensed
    excitation: {kind: kick, wave: extension, velocity_A_per_ps: 0.2, scales: [1, 0.5]}
    observation: {helical: true}
  mode1:
    duplex: tiny
    environment: condensed
    ends: {first: held}
    excitation: {kind: standing_wave, wave: extension, mode: 1, velocity_A_per_ps: 0.2}
  mode1_exact:
    duplex: tiny
    environment: condensed
    ends: {first: held}
    excitation: {kind: standing_wave, wave: extension, mode: 1, velocity_A_per_ps: 0.2}
    method: harmonic
  bend_mode1:
    duplex: tiny
    environment: condensed
    ends: {first: held}
    excitation: {kind: standing_wave, wave: bend, mode: 1, angular_velocity_rad_per_ps: 0.02}
  drive:
    duplex: tiny
    environment: condensed
    ends: {first: held}
    excitation: {kind: periodic, wave: extension, force_pN: 20, frequencies_GHz: [150, 280]}
  load:
    duplex: tiny
    environment: condensed
    ends: {first: held, last: guided}
    excitation: {kind: static, wave: extension, force_pN: 100}
  nothing:
    duplex: tiny
    environment: condensed
    ends: {first: held}
    excitation: {kind: none}
  spoilt:
    duplex: tiny
    environment: condensed
    excitation: {kind: kick, wave: twist, angular_velocity_rad_per_ps: 0.02}
"""

SEGMENTS = """\
steps,length_A,segments,extension_pN,twist_pN_nm2,coupling_pN_nm,bend_pN_nm2,extension_A_per_ps,twist_A_per_ps
1,3.3,9,3000,1200,100,400,11,8
4,13.2,6,6000,1210,90,410,15,8.1
"""


@dataclass(frozen=True)
class Truth:
    """What the miniature was made of."""

    pairs: int = PAIRS
    spacing_A: float = SPACING_A
    length_A: float = LENGTH_A
    speed_A_per_ps: float = SPEED_A_PER_PS
    paper_A_per_ps: float = PAPER_A_PER_PS
    friction_per_ps: float = FRICTION_PER_PS
    load_pN: float = LOAD_PN
    too_short: str = TOO_SHORT

    @property
    def mode_GHz(self) -> float:
        return ghz(mode_frequency_rad_per_ps(SPEED_A_PER_PS))

    @property
    def paper_mode_GHz(self) -> float:
        return ghz(mode_frequency_rad_per_ps(PAPER_A_PER_PS))


@pytest.fixture(scope="session")
def truth() -> Truth:
    return Truth()


@pytest.fixture(scope="session")
def config(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the configuration of the miniature; its results lie in `results` beside it."""
    return write_results(tmp_path_factory.mktemp("report"))


@pytest.fixture(scope="session")
def results(config: Path) -> Results:
    return gather(config, config.parent / "results")


@pytest.fixture(scope="session")
def page(config: Path) -> Path:
    """Return the miniature's report."""
    output = config.parent / "report.html"
    report_step(config, config.parent / "results", output)
    return output


def mode_frequency_rad_per_ps(speed_A_per_ps: float) -> float:
    """Return 2V/a sin(ka/2) of the lowest mode between held ends."""
    wavenumber = axial_wavenumber(PAIRS, 1, "held", SPACING_A / 10) / 10
    return 2 * speed_A_per_ps / SPACING_A * np.sin(wavenumber * SPACING_A / 2)


def ghz(frequency_rad_per_ps: float) -> float:
    return 1e3 * frequency_rad_per_ps / (2 * np.pi)


def kicked(speed_A_per_ps: float) -> Array:
    """Return the velocity field (time, pair) of a chain kicked at its free first end."""
    chain = ScalarChain.from_speed(PAIRS, speed_A_per_ps, SPACING_A / 10, (-1,))
    return chain.kick_response(TIMES_PS, np.where(np.arange(PAIRS) < 3, 0.2, 0.0))[1]


def standing(speed_A_per_ps: float, friction_per_ps: float) -> tuple[Array, Array]:
    """Return the share (time,) of a standing wave and its velocity field (time, pair)."""
    frequency = mode_frequency_rad_per_ps(speed_A_per_ps)
    share = impulse_response(TIMES_PS, [frequency], friction_per_ps)[1][:, 0]
    return share, 0.2 * np.outer(share, axial_standing_wave(PAIRS, 1, "held"))


def waves_of(
    velocities: dict[str, Array], held: list[int], usable: int = len(TIMES_PS)
) -> xr.Dataset:
    units = {"extension": "angstrom/ps", "twist": "rad/ps", "bend": "rad/ps"}
    dataset = xr.Dataset(
        coords={
            "time": ("time", TIMES_PS, {"units": "ps"}),
            # The first base pair does not lie at the origin of the axis.
            "height": ("pair", 1.5 + SPACING_A * np.arange(PAIRS), {"units": "angstrom"}),
        },
        attrs={"usable_frames": usable, "length_A": LENGTH_A},
    )
    for wave, field in velocities.items():
        dataset[f"{wave}_velocity"] = (("time", "pair"), field, {"units": units[wave]})
        dataset[f"{wave}_power"] = frequency_wavenumber(TIMES_PS, field, SPACING_A / 10, held)
    return dataset


def write_results(folder: Path) -> Path:
    """Write configuration and results below a folder; return the configuration."""
    config = folder / "tiny.yaml"
    write_text(config, CONFIG)
    write_text(folder / "duplexes.yaml", "tiny: CGATCAGTCG\n")
    results = folder / "results"
    scenes = _scenes()
    for name, (waves, estimates) in scenes.items():
        write_netcdf(results / "scenes" / name / "waves.nc", waves)
        rows = [replace(row, scene=name, system=SYSTEM) for row in estimates]
        write_table(results / "scenes" / name / "speeds.csv", rows)
    for sign, half in (("plus", 1), ("minus", -1)):
        write_netcdf(results / "scenes/kick/x1" / f"{sign}.helical.nc", helical(half))
    system = results / "systems" / SYSTEM
    write_netcdf(system / "structure.nc", structure())
    write_netcdf(system / "relaxed.nc", minimum())
    write_netcdf(system / "modes/0-0.nc", modes())
    write_text(system / "segments.csv", SEGMENTS)
    write_constants(system / "constants.csv", constants())
    for name, spec in load_scenes(config).items():
        write_json(results / "scenes" / name / "scene.json", spec.model_dump(mode="json"))
    compare_step(
        [results / "scenes" / name / "speeds.csv" for name in scenes],
        [results / "scenes" / name / "scene.json" for name in scenes],
        [system / "structure.nc"],
        [system / "constants.csv"],
        results / "comparison.csv",
    )
    return config


def constants() -> list[Constant]:
    """Return the constants of the rod that the miniature is made of."""
    rod = Rod.paper()
    density, inertia = rod.density_Da_per_nm / 10, 10 * np.diag(rod.inertia_Da_nm)
    topology = {
        "spacing_A": SPACING_A,
        "density_Da_per_A": density,
        "inertia_axial_Da_A": inertia[2],
        "inertia_transverse_Da_A": inertia[0],
    }
    route = "hessian, segments of 5 steps"
    stiffness = 4 * np.diag(rod.stiffness) / KJ_PER_MOL_PER_PN_NM
    own = {
        "stretch_modulus_pN": stiffness[2],
        "stretch_modulus_relaxed_pN": stiffness[2],
        "twist_rigidity_pN_nm2": stiffness[5],
        "twist_rigidity_relaxed_pN_nm2": stiffness[5],
        "twist_stretch_coupling_pN_nm": 0.0,
        "bend_rigidity_pN_nm2": stiffness[3],
        "shear_stiffness_pN": stiffness[0],
        "speed_extension_A_per_ps": SPEED_A_PER_PS,
    }
    steps = [
        Constant(f"hessian, steps {kind}", f"speed_{wave}_A_per_ps", speed)
        for kind, speed in (("CG", 12.0), ("GA", 10.0))
        for wave in ("extension", "twist")
    ]
    masses = [Constant("topology", name, float(value)) for name, value in topology.items()]
    return [*masses, *steps] + [
        Constant(route, name, float(value), 0.98 * float(value), 1.02 * float(value))
        for name, value in own.items()
    ]


def _scenes() -> dict[str, tuple[xr.Dataset, list[Estimate]]]:
    blank = Estimate("", "extension", "", misfit=0.01, window_ps=5.0, record_ps=5.0)
    interval = [SPEED_A_PER_PS, 0.98 * SPEED_A_PER_PS, 1.03 * SPEED_A_PER_PS]
    found = spread(blank, interval, PAPER_A_PER_PS)
    kick = waves_of({"extension": kicked(SPEED_A_PER_PS)}, [PAIRS - 1])
    kick["extension_paper"] = (("time", "pair"), kicked(PAPER_A_PER_PS))
    share, field = standing(SPEED_A_PER_PS, FRICTION_PER_PS)
    mode = waves_of({"extension": field}, [0, PAIRS - 1])
    mode["extension_paper"] = (("time", "pair"), standing(PAPER_A_PER_PS, 0.0)[1])
    mode["projection"] = ("time", share)
    resonant = replace(
        found,
        friction_per_ps=FRICTION_PER_PS,
        frequency_GHz=ghz(mode_frequency_rad_per_ps(SPEED_A_PER_PS)),
        paper_frequency_GHz=ghz(mode_frequency_rad_per_ps(PAPER_A_PER_PS)),
        wavenumber_rad_per_A=axial_wavenumber(PAIRS, 1, "held", SPACING_A / 10) / 10,
    )
    drive = waves_of({"extension": field}, [0, PAIRS - 1])
    drive["response"] = ("drive", [0.01, 0.03])
    drive = drive.assign_coords(drive=("drive", [150.0, 280.0], {"units": "GHz"}))
    still = waves_of({}, [0, PAIRS - 1], usable=0)
    load = still.isel(time=[0])
    load["extension_displacement"] = (
        ("time", "pair"),
        np.linspace(0, 0.4, PAIRS)[None],
        {"units": "angstrom"},
    )
    bend = waves_of({"bend": 0.1 * field}, [0, PAIRS - 1])
    spoilt = waves_of({"twist": 0.1 * kicked(SPEED_A_PER_PS)}, [PAIRS - 1], usable=3)
    return {
        "kick": (kick, [replace(found, estimator="waveform", half_kick_change=0.004)]),
        "mode1": (mode, [replace(resonant, estimator="standing wave")]),
        "mode1_exact": (
            # As if the simulation had come out 4 % too large.
            mode.assign(extension_velocity=mode["extension_velocity"] / 1.04),
            [replace(resonant, estimator="standing wave", method="harmonic")],
        ),
        "bend_mode1": (bend, [replace(resonant, wave="bend", estimator="standing wave")]),
        "drive": (drive, [replace(resonant, estimator="resonance")]),
        "load": (load, [replace(found, estimator="static", misfit=None)]),
        "nothing": (
            still,
            [Estimate("", "extension", "none", paper_A_per_ps=8.19, reason="no wave: still")],
        ),
        "spoilt": (
            spoilt,
            [Estimate("", "twist", "none", paper_A_per_ps=5.06, reason=TOO_SHORT)],
        ),
    }


def helical(sign: int) -> xr.Dataset:
    """Return rise in a wave of 0.02 Å on an even offset that must cancel."""
    wave = 0.02 * np.outer(np.sin(TIMES_PS), np.ones(PAIRS - 1))
    values = {"rise": (3.3 + sign * wave, "angstrom"), "roll": (0 * wave, "degree")}
    return xr.Dataset(
        {
            name: (("time", "step"), value, {"units": unit})
            for name, (value, unit) in values.items()
        },
        coords={"time": ("time", TIMES_PS, {"units": "ps"})},
    )


def structure() -> xr.Dataset:
    steps = PAIRS - 1
    angstrom, degree = {"units": "angstrom"}, {"units": "degree"}
    ends = np.r_[9.0, 9.0, np.zeros(steps - 4), 9.0, 9.0]
    parameters = {
        "shift": (0.1, angstrom),
        "slide": (0.2, angstrom),
        "rise": (3.3, angstrom),
        "tilt": (1.0, degree),
        "roll": (2.0, degree),
        "twist": (35.0, degree),
    }
    # The two steps at each end are frayed, and no part of the interior mean.
    dataset = xr.Dataset(
        {name: ("step", mean + ends, units) for name, (mean, units) in parameters.items()}
    )
    dataset["hydrogen_bonds"] = ("pair", np.full(PAIRS, 3))
    dataset = dataset.assign_coords(step_sequence=("step", ["CG/CG"] * steps))
    dataset.attrs = {
        "interior_rise_A": 3.3,
        "interior_twist_deg": 35.0,
        "interior_roll_deg": 2.0,
        "rmsd_to_built_A": 1.2,
        "lost_pairs": "",
        "verdict": "B-DNA",
        "system": SYSTEM,
        "version_mdtraj": "1.2.3",
    }
    return dataset


def modes() -> xr.Dataset:
    """Return S(q, f) of a uniform chain: one line for each wavenumber, at its frequency."""
    wavenumbers = np.linspace(0, np.pi / SPACING_A, PAIRS + 1)
    frequencies = np.linspace(0, 3000, 301)
    centres = ghz(2 * SPEED_A_PER_PS / SPACING_A * np.sin(wavenumbers * SPACING_A / 2))
    line = np.exp(-0.5 * ((frequencies - centres[:, None]) / 20) ** 2)
    return xr.Dataset(
        {
            "velocity_structure_factor": (
                ("coordinate", "wavenumber", "frequency"),
                np.array([line, line]),
            ),
        },
        coords={
            "coordinate": ["extension", "twist"],
            "wavenumber": ("wavenumber", wavenumbers, {"units": "rad/angstrom"}),
            "frequency": ("frequency", frequencies, {"units": "GHz"}),
        },
    )


def minimum() -> xr.Dataset:
    return xr.Dataset(
        attrs={
            "energy_kJ_per_mol": -7000.5,
            "rms_force_kJ_per_mol_nm": 2.3e-5,
            "negative_modes": 0,
            "first_estimate_extension_A_per_ps": 15.0,
            "first_estimate_twist_A_per_ps": 9.0,
            "version_openmm": "9.9",
        }
    )
