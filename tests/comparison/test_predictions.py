"""What a rod of known constants says, against rods and chains of the same constants."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from dnawaves.comparison.predictions import long_wave_routes, predict, straight_rod
from dnawaves.rod.chain import PlaneChain, ScalarChain
from dnawaves.rod.dispersion import bend_shear_branches
from dnawaves.rod.finite_rod import COORDINATE_SETS, FiniteRod
from dnawaves.rod.rod import Rod
from dnawaves.rod.standing import axial_wavenumber, bend_standing_wave, shear_standing_wave
from dnawaves.scene.models import Ends, SceneSpec
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.estimators.correlation import arrival_ps

MakeScene = Callable[..., SceneSpec]
PAIRS, SPACING_NM = 24, 0.34
PAPER_A_PER_PS = 8.19028
ROUTE = "hessian, segments of 16 steps"


@pytest.fixture
def constants(constants_table: Callable[..., pd.DataFrame]) -> pd.DataFrame:
    """The paper's own rod, as if it had been derived from a molecule."""
    rod = Rod.paper()
    stiffness = np.diag(rod.stiffness) / KJ_PER_MOL_PER_PN_NM
    inertia = 10 * np.diag(rod.inertia_Da_nm)
    return constants_table(
        {
            "topology": {
                "spacing_A": 10 * SPACING_NM,
                "density_Da_per_A": rod.density_Da_per_nm / 10,
                "inertia_axial_Da_A": inertia[2],
                "inertia_transverse_Da_A": inertia[0],
            },
            "hessian, segments of 1 steps": {"speed_extension_A_per_ps": 1.0},
            ROUTE: {
                "stretch_modulus_pN": stiffness[2],
                "twist_rigidity_pN_nm2": stiffness[5],
                "twist_stretch_coupling_pN_nm": 0.0,
                "bend_rigidity_pN_nm2": stiffness[3],
                "shear_stiffness_pN": stiffness[0],
                "speed_extension_A_per_ps": PAPER_A_PER_PS,
            },
        }
    )


def row(wave: str, estimator: str, **values: float) -> pd.Series:
    blank = {"wavenumber_rad_per_A": np.nan, "paper_A_per_ps": np.nan, "paper_arrival_ps": np.nan}
    given = {"speed_A_per_ps": 10.0, "wave": wave, "estimator": estimator, **blank, **values}
    return pd.Series(given, dtype=object)


def test_the_longest_segments_stand_for_the_rod(constants: pd.DataFrame) -> None:
    assert long_wave_routes(constants) == [ROUTE]


def test_all_routes_are_inside_the_interval(
    scene: MakeScene, constants_table: Callable[..., pd.DataFrame]
) -> None:
    speed = "speed_extension_A_per_ps"
    constants = constants_table(
        {
            "topology": {"spacing_A": 3.3},
            "static": {speed: (14.6, 14.4, 14.8)},
            "hessian, segments of 2 steps": {speed: 12.0},
            "hessian, segments of 16 steps": {speed: 15.5},
        }
    )
    found = predict(row("extension", "waveform"), scene("a", "kick"), constants)
    assert found.routes == ("hessian, segments of 16 steps", "static")
    assert found.lattice is not None
    assert (found.lattice.value, found.lattice.low, found.lattice.high) == (15.5, 14.4, 15.5)


def test_the_table_holds_the_rod_that_was_put_in(constants: pd.DataFrame) -> None:
    rod, paper = straight_rod(constants, ROUTE), Rod.paper()
    assert rod is not None
    assert rod.stiffness == pytest.approx(paper.stiffness)
    assert rod.inertia_Da_nm == pytest.approx(paper.inertia_Da_nm)
    assert rod.density_Da_per_nm == pytest.approx(paper.density_Da_per_nm)


def test_a_route_that_lacks_a_constant_makes_no_rod(constants: pd.DataFrame) -> None:
    assert straight_rod(constants[constants["quantity"] != "shear_stiffness_pN"], ROUTE) is None


@pytest.mark.parametrize("mode", [1, 3, 8])
def test_a_continuum_s_standing_wave_is_read_by_the_lattice_s_relation(
    scene: MakeScene, constants: pd.DataFrame, mode: int
) -> None:
    k = axial_wavenumber(PAIRS, mode, "held", SPACING_NM) / 10
    found = predict(
        row("extension", "standing wave", wavenumber_rad_per_A=k), scene("a"), constants
    )
    assert found.rod is not None and found.lattice is not None
    rod = FiniteRod(
        Rod.paper(), (PAIRS - 1) * SPACING_NM, ("held", "held"), COORDINATE_SETS["extension"]
    )
    frequency = rod.frequencies_rad_per_ps(mode)[-1]
    spacing_A = 10 * SPACING_NM
    read = frequency * spacing_A / 2 / np.sin(k * spacing_A / 2)
    # Both are exact; the paper's speed is given with six digits.
    assert found.rod.value == pytest.approx(read, rel=1e-5)
    assert found.lattice.value == pytest.approx(PAPER_A_PER_PS)


def test_a_standing_bend_is_that_of_the_continuous_rod(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    k = 2 * np.pi / ((PAIRS - 1) * SPACING_NM) / 10
    found = predict(
        row("bend", "standing wave", wavenumber_rad_per_A=k), scene("a", "bend"), constants
    )
    assert found.rod is not None and found.lattice is not None
    rod = FiniteRod(
        Rod.paper(), (PAIRS - 1) * SPACING_NM, ("held", "held"), COORDINATE_SETS["bend"]
    )
    frequency = rod.frequencies_rad_per_ps(2)[-1]
    # Of the chain that stands for the continuum (ka/8)²/24 is left, below 1e-4.
    assert found.rod.value == pytest.approx(frequency / k, rel=1e-4)
    assert found.lattice.value != pytest.approx(frequency / k, rel=1e-4)


def test_a_shear_without_a_standing_wave_is_a_front_of_the_chain(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    """The lattice is asked exactly what the paper's rod is asked, so that the answers are equal."""
    rod = straight_rod(constants, ROUTE)
    assert rod is not None
    chain = PlaneChain(rod, PAIRS, [PAIRS - 1])
    times = np.linspace(0, 40, 4001)
    kick = np.zeros((PAIRS, 2))
    kick[:3, 0] = 1.0
    motion = chain.kick_response(times, kick)[1][:, 20, 0]
    arrived, distance_A = arrival_ps(times, motion), 19 * 10 * SPACING_NM
    assert arrived is not None
    asked = row("shear", "arrival", paper_A_per_ps=distance_A / arrived, paper_arrival_ps=arrived)
    found = predict(asked, scene("a", "shear kick"), constants)
    assert found.lattice is not None
    # The two are sampled at different times, interpolated linearly.
    assert found.lattice.value == pytest.approx(distance_A / arrived, rel=2e-3)


def test_the_front_of_a_continuum_is_the_edge_of_the_kick(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    """A chain of ever finer pieces, kicked over the same length, tends to the closed form."""
    pieces, distance_A = 24, 19 * 10 * SPACING_NM
    chain = ScalarChain.from_speed(PAIRS * pieces, PAPER_A_PER_PS, SPACING_NM / pieces)
    place = (np.arange(PAIRS * pieces) + 0.5) / pieces
    times = np.linspace(0, 9, 4001)
    motion = chain.kick_response(times, (place < 3).astype(float))[1]
    arrived = arrival_ps(times, motion[:, int(np.argmin(np.abs(place - 20.5)))])
    assert arrived is not None
    asked = row("extension", "arrival", paper_A_per_ps=8.4, paper_arrival_ps=distance_A / 8.4)
    found = predict(asked, scene("a", "kick"), constants)
    assert found.rod is not None and found.lattice is not None
    # The edge is still spread over some seven pieces, 1 Å of 64.
    assert found.rod.value == pytest.approx(distance_A / arrived, rel=0.015)
    # The lattice's front is late by as much as the paper's, whose constants it has here.
    assert found.lattice.value == pytest.approx(8.4, rel=1e-5)


def test_a_lag_has_the_bias_of_the_papers_rod_and_no_edge(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    asked = row("extension", "correlation", paper_A_per_ps=6.4, paper_arrival_ps=9.0)
    found = predict(asked, scene("a", "kick"), constants)
    assert found.rod is not None and found.lattice is not None
    # The constants are the paper's own.
    assert found.rod.value == pytest.approx(6.4, rel=1e-5)
    assert found.lattice.value == pytest.approx(6.4, rel=1e-5)


@pytest.mark.parametrize(("end", "lengths"), [("held", PAIRS - 1), ("free", PAIRS)])
@pytest.mark.parametrize("mode", [1, 2])
def test_a_thermal_bend_is_that_of_the_rod_between_the_scene_s_ends(
    scene: MakeScene, constants: pd.DataFrame, end: str, lengths: int, mode: int
) -> None:
    k = mode * np.pi / ((PAIRS - 1) * SPACING_NM) / 10
    asked = row("bend", f"thermal mode {mode}", wavenumber_rad_per_A=k)
    still = scene("a", "none")
    still = still.model_copy(update={"ends": Ends(first=end, last=end)})
    found = predict(asked, still, constants)
    assert found.rod is not None and found.lattice is not None
    rod = FiniteRod(Rod.paper(), lengths * SPACING_NM, (end, end), COORDINATE_SETS["bend"])
    frequency = rod.frequencies_rad_per_ps(mode)[-1]
    # Of the chain that stands for the continuum (ka/8)²/24 is left, below 1e-4.
    assert found.rod.value == pytest.approx(frequency / k, rel=2e-4)
    lattice = bend_standing_wave(Rod.paper(), PAIRS, mode, end).frequency_rad_per_ps
    assert found.lattice.value == pytest.approx(lattice / k, rel=1e-9)


def test_a_thermal_shear_is_a_standing_wave_of_the_upper_branch(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    k = 2 * np.pi / ((PAIRS - 1) * SPACING_NM) / 10
    found = predict(
        row("shear", "thermal mode 2", wavenumber_rad_per_A=k), scene("a", "none"), constants
    )
    assert found.rod is not None and found.lattice is not None
    lattice = shear_standing_wave(Rod.paper(), PAIRS, 2, "held").frequency_rad_per_ps
    assert found.lattice.value == pytest.approx(lattice / k, rel=1e-9)
    # Clamped ends matter less to the upper branch than to bends: within a few percent of it.
    branch = bend_shear_branches(Rod.paper(), [10 * k], lattice=False)[0, 1]
    assert found.rod.value == pytest.approx(branch / k, rel=0.03)


def test_a_fit_with_the_coupling_free_is_held_against_the_uncoupled_speed(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    found = predict(row("extension", "waveform, coupled"), scene("a", "kick"), constants)
    assert found.lattice is not None
    # The paper's rod has no coupling: sqrt(C3/rho) is its speed, here given with six digits.
    assert found.lattice.value == pytest.approx(PAPER_A_PER_PS, rel=1e-5)


def test_segments_that_are_much_shorter_than_the_wave_leave_a_doubt(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    for mode, sure in ((1, False), (2, True)):
        k = axial_wavenumber(48, mode, "held", SPACING_NM) / 10
        asked = row("extension", "standing wave", wavenumber_rad_per_A=k)
        # Half a wave has 47 or 24 steps, the longest segments have 16.
        assert (predict(asked, scene("a"), constants).doubt == "") == sure


def test_a_static_load_is_a_route_and_nothing_to_predict(
    scene: MakeScene, constants: pd.DataFrame
) -> None:
    found = predict(row("extension", "static"), scene("a", "static"), constants)
    assert (found.rod, found.lattice) == (None, None)
