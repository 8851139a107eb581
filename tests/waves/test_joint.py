"""One rod from several scenes, from files to a table; time of flight over several lengths."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from dnawaves.errors import InputError
from dnawaves.files import write_netcdf
from dnawaves.rod.chain import PlaneChain
from dnawaves.rod.rod import Rod
from dnawaves.scene.excitations import Kick, StandingWave
from dnawaves.scene.models import SceneSpec
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.estimators.lattice_fit import LatticeFit, Value
from dnawaves.waves.estimators.lattices import AxialLattice
from dnawaves.waves.estimators.model_class import ModelClass
from dnawaves.waves.estimators.sources import kick
from dnawaves.waves.flights import flight_row
from dnawaves.waves.joint import joint_step, profiled

PAIRS, SPACING_NM = 24, 0.34
MASS_DA, BEND_INERTIA, TWIST_INERTIA = 600.0, 180.0, 300.0
TIMES_PS = np.arange(0, 6, 0.1)
EXTENSION, TWIST, COUPLING, SHEAR, BEND = 14.0, 8.0, 0.2, 6.0, 9.0


def local() -> np.ndarray:
    pattern = np.zeros(PAIRS)
    pattern[:3] = 0.01
    return pattern


def axial(wave: str, pattern: np.ndarray, held: list[int]) -> dict[str, np.ndarray]:
    both = np.zeros((PAIRS, 2))
    both[:, int(wave == "twist")] = pattern
    masses = (MASS_DA, TWIST_INERTIA)
    lattice = AxialLattice(PAIRS, SPACING_NM, held, kick(TIMES_PS), both, masses)
    values = dict(zip(lattice.names, (EXTENSION, TWIST, COUPLING, 0.1), strict=True))
    field = np.zeros((len(TIMES_PS), PAIRS, 2))
    field[:, lattice.moving] = lattice.velocity(values)
    return {"extension": field[..., 0], "twist": field[..., 1]}


def plane(wave: str) -> dict[str, np.ndarray]:
    density, tilt = MASS_DA / SPACING_NM, BEND_INERTIA / SPACING_NM
    stiffness = [density * (SHEAR / 10) ** 2] * 3 + [tilt * (BEND / 10) ** 2] * 3
    rod = Rod(density, tilt * np.eye(3), np.diag(stiffness), SPACING_NM)
    both = np.zeros((PAIRS, 2))
    both[:, int(wave == "bend")] = local()
    velocity = PlaneChain(rod, PAIRS, [PAIRS - 1]).kick_response(TIMES_PS, both)[1]
    return {"shear": velocity[..., 0], "bend": velocity[..., 1]}


@pytest.fixture(scope="module")
def table(
    tmp_path_factory: pytest.TempPathFactory,
    make_scene: Callable[..., SceneSpec],
    make_motion: Callable[..., xr.Dataset],
) -> pd.DataFrame:
    shape = np.sin(np.pi * np.arange(PAIRS) / (PAIRS - 1))
    shape[[0, -1]] = 0.0
    standing = StandingWave(
        kind="standing_wave", wave="twist", mode=1, angular_velocity_rad_per_ps=0.01
    )
    last = [PAIRS - 1]
    scenes = [
        (
            make_scene(Kick(kind="kick", wave="extension", velocity_A_per_ps=0.1), name="along"),
            axial("extension", local(), last),
        ),
        (
            make_scene(standing, "held", "held", name="turned"),
            axial("twist", 0.01 * shape, [0, *last]),
        ),
        (
            make_scene(Kick(kind="kick", wave="bend", angular_velocity_rad_per_ps=0.01), name="b"),
            plane("bend"),
        ),
        (
            make_scene(Kick(kind="kick", wave="shear", velocity_A_per_ps=0.1), name="s"),
            plane("shear"),
        ),
    ]
    folder = tmp_path_factory.mktemp("joint")
    paths = []
    for spec, fields in scenes:
        path = folder / spec.name / "x1" / "motion.nc"
        path.parent.mkdir(parents=True)
        write_netcdf(path, make_motion(spec, fields))
        paths.append(path)
    joint_step(paths, folder / "joint.csv")
    return pd.read_csv(folder / "joint.csv").set_index("quantity")


def test_joint_fit_gives_the_constants_of_the_rod(table: pd.DataFrame) -> None:
    unit = KJ_PER_MOL_PER_PN_NM * SPACING_NM
    stretch = MASS_DA * (EXTENSION / 10) ** 2 / unit
    twist = TWIST_INERTIA * (TWIST / 10) ** 2 / unit
    expected = {
        "stretch_modulus_pN": stretch,
        "twist_rigidity_pN_nm2": twist,
        "twist_stretch_coupling_pN_nm": COUPLING * np.sqrt(stretch * twist),
        "stretch_modulus_relaxed_pN": stretch * (1 - COUPLING**2),
        "bend_rigidity_pN_nm2": BEND_INERTIA * (BEND / 10) ** 2 / unit,
        "shear_stiffness_pN": MASS_DA * (SHEAR / 10) ** 2 / unit,
        "speed_bend_A_per_ps": BEND,
        "speed_shear_A_per_ps": SHEAR,
    }
    for quantity, value in expected.items():
        # Noise-free data of the model class: the optimiser's tolerance, doubled by the square.
        assert table.loc[quantity, "value"] == pytest.approx(value, rel=2e-3)
        assert table.loc[quantity, "low"] <= table.loc[quantity, "value"]
        assert table.loc[quantity, "high"] >= table.loc[quantity, "value"]
    assert (table["model_class"] == "fits").all()
    assert set(table.loc["stretch_modulus_pN", "source"].split(", ")) == {"along", "turned"}
    # Coupled, the faster of two waves is faster than it is alone.
    assert table.loc["speed_extension_A_per_ps", "value"] > EXTENSION


def limits(coupling: Value) -> dict[str, tuple[float, float]]:
    """Return the ends of three constants, of speeds known to 1 %, a = b = 1 and this coupling."""
    one = Value(1.0, 0.99, 1.01)
    fit = LatticeFit(
        {"extension_A_per_ps": one, "twist_A_per_ps": one, "coupling_extension_twist": coupling},
        (1.0,),
        ModelClass(0.0, None, 1.0, 1.0, False),
    )

    def constants(at: LatticeFit) -> dict[str, float]:
        a, b = (at[f"{wave}_A_per_ps"].value ** 2 for wave in ("extension", "twist"))
        c = at["coupling_extension_twist"].value
        return {
            "stretch_modulus_pN": a,
            "stretch_modulus_relaxed_pN": a * (1 - c**2),
            "twist_stretch_coupling_pN_nm": c * np.sqrt(a * b) if np.isfinite(c) else np.nan,
        }

    return profiled(fit, list(fit.values), constants)


def test_a_relaxed_modulus_is_known_no_better_than_the_coupling() -> None:
    found = limits(Value(0.3, 0.1, 0.4))
    assert found["stretch_modulus_pN"] == pytest.approx((0.9801, 1.0201), rel=1e-9)
    # 0.91 (1 ± 0.02) by the speed; to 0.84 and 0.99 by the coupling; in quadrature.
    low, high = found["stretch_modulus_relaxed_pN"]
    assert low == pytest.approx(0.91 - np.hypot(0.07, 0.91 * 0.0199), rel=1e-9)
    assert high == pytest.approx(0.91 + np.hypot(0.08, 0.91 * 0.0201), rel=1e-9)
    # 0.3 (1 ± 0.01) by either speed, to 0.1 and 0.4 by the coupling.
    low, high = found["twist_stretch_coupling_pN_nm"]
    assert low == pytest.approx(0.3 - np.sqrt(0.2**2 + 2 * 0.003**2), rel=1e-9)
    assert high == pytest.approx(0.3 + np.sqrt(0.1**2 + 2 * 0.003**2), rel=1e-9)


def test_a_value_without_a_limit_leaves_its_constants_without_one() -> None:
    found = limits(Value(0.3, -np.inf, 0.4))
    assert found["stretch_modulus_pN"] == pytest.approx((0.9801, 1.0201), rel=1e-9)
    assert found["stretch_modulus_relaxed_pN"] == (0.0, np.inf)
    assert found["twist_stretch_coupling_pN_nm"] == (-np.inf, np.inf)


def test_joint_fit_is_of_one_system(
    tmp_path: Path,
    make_scene: Callable[..., SceneSpec],
    make_motion: Callable[..., xr.Dataset],
) -> None:
    one = make_scene(Kick(kind="kick", wave="extension", velocity_A_per_ps=0.1))
    other = one.model_copy(
        update={"system": one.system.model_copy(update={"environment_name": "other"})}
    )
    paths = [tmp_path / f"{name}.nc" for name in ("one", "other")]
    for path, spec in zip(paths, (one, other), strict=True):
        write_netcdf(path, make_motion(spec, axial("extension", local(), [PAIRS - 1])))
    with pytest.raises(InputError, match="d-e, d-other; allowed: one system"):
        joint_step(paths, tmp_path / "joint.csv")


def arrivals(times_ps: list[float], lengths_A: list[float]) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "scene": [f"s{index}" for index in range(len(times_ps))],
            "wave": "extension",
            "estimator": "arrival",
            "speed_A_per_ps": np.array(lengths_A) / times_ps,
            "arrival_ps": times_ps,
            "paper_arrival_ps": np.array(lengths_A) / 8.0 + 0.2,
        }
    )


def test_flight_over_lengths_has_no_part_of_the_delay() -> None:
    lengths = [40.0, 80.0, 160.0]
    row = flight_row(arrivals([0.5 + length / 16 for length in lengths], lengths))
    assert row.speed_A_per_ps == pytest.approx(16.0, rel=1e-9)
    assert row.ratio_to_paper == pytest.approx(2.0, rel=1e-9)
    assert "delay 0.5 ps" in row.reason


def test_two_lengths_are_no_line() -> None:
    row = flight_row(arrivals([3.0, 5.0, 5.0], [40.0, 80.0, 80.0]))
    assert row.speed_A_per_ps is None
    assert row.reason.endswith("2 lengths with an arrival; 3 are needed")


def test_times_that_do_not_grow_are_no_flight() -> None:
    row = flight_row(arrivals([5.0, 4.0, 3.0], [40.0, 80.0, 160.0]))
    assert row.speed_A_per_ps is None
    assert "no wave has travelled" in row.reason
