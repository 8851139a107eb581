"""The rod's constants from thermal strains: of a rod that is known, and of the relaxed duplex."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import scipy.sparse
import xarray as xr
from numpy.typing import NDArray

from dnawaves.frames.strain import step_strains
from dnawaves.motion.pair_frames import frames_in_time
from dnawaves.rod.rod import BEND_1, EXTENSION, SHEAR_1, TWIST
from dnawaves.system.modes import NormalModes, normal_modes
from dnawaves.system.stiffness import axis_compliance, base_pair_frames, strain_compliance
from dnawaves.units import A_PER_NM, BOLTZMANN_KJ_PER_MOL_K, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.axis_strains import AxisStrains, mean_structure
from dnawaves.waves.constants.rod_mass import RodMass, rod_mass
from dnawaves.waves.constants.rod_stiffness import (
    segments_compliance,
    stiffness_of,
    wave_compliance,
)
from dnawaves.waves.constants.thermal_stiffness import thermal_constants, thermal_strains

Array = NDArray[np.float64]

PAIRS, SAMPLES = 12, 2000
# Small angles: then the strains are linear in the motion, as those of the theory are.
COLD_K = 0.03


@pytest.fixture(scope="module")
def benchmark() -> Iterator[ModuleType]:
    folder = str(Path(__file__).resolve().parents[2] / "benchmarks")
    sys.path.insert(0, folder)
    yield importlib.import_module("thermal")
    sys.path.remove(folder)


def test_a_known_rod_comes_back_from_its_thermal_motion_at_every_length(
    benchmark: ModuleType,
) -> None:
    rod = benchmark.twisted_rod()
    straight = rod.averaged_about_axis()
    frames = benchmark.thermal_frames(rod, PAIRS, SAMPLES, COLD_K, np.random.default_rng(1))
    mass = RodMass(190.0, 5000.0, 2500.0)
    found = thermal_constants(thermal_strains([frames], COLD_K), mass, "thermal")
    expected = {
        "stretch_modulus_pN": straight.stiffness[EXTENSION, EXTENSION],
        "twist_rigidity_pN_nm2": straight.stiffness[TWIST, TWIST],
        "twist_stretch_coupling_pN_nm": straight.stiffness[EXTENSION, TWIST],
        "bend_rigidity_pN_nm2": straight.stiffness[BEND_1, BEND_1],
        "shear_stiffness_pN": straight.stiffness[SHEAR_1, SHEAR_1],
    }
    inside = []
    for one in found:
        if one.quantity in expected:
            truth = expected[one.quantity] / KJ_PER_MOL_PER_PN_NM
            inside.append(one.low <= truth <= one.high)
            if one.quantity != "twist_stretch_coupling_pN_nm":
                # Five standard errors, sqrt(2/2000) of one independent sample per frame.
                assert one.value == pytest.approx(truth, rel=5 * np.sqrt(2 / SAMPLES)), one
    # 95 % of intervals that belong together; 20 standard errors of independent ones would be 0.8.
    assert np.mean(inside) > 0.8
    assert {one.interval for one in found} == {"95 %, jackknife over 20 blocks"}
    assert {one.route for one in found} >= {"thermal, segments of 4 steps", "thermal K(q->0)"}


@pytest.fixture(scope="module")
def free(relaxed: Any) -> NormalModes:
    duplex = relaxed.duplex
    everything = np.ones(len(duplex.masses_Da), dtype=bool)
    hessian = scipy.sparse.csr_array(relaxed.hessian)
    return normal_modes(hessian, duplex.masses_Da, duplex.bodies, everything)


def test_screws_of_steps_add_up_to_the_motion_of_the_ends(relaxed: Any, free: NormalModes) -> None:
    duplex = relaxed.duplex
    axis = AxisStrains.of_structure(base_pair_frames(duplex), duplex.frame)
    steps = axis.covariance(strain_compliance(free, duplex))
    ends = axis_compliance(free, duplex)
    for first, last in ((0, 1), (1, 4), (0, 5)):
        summed = steps[first:last, :, first:last].sum(axis=(0, 2))
        between = (
            ends[last, :, last]
            + ends[first, :, first]
            - ends[last, :, first]
            - ends[first, :, last]
        )
        # Extension, the two bends and twist: shear of the ends also holds the bends between.
        chosen = np.ix_([2, 3, 4, 5], [2, 3, 4, 5])
        scale = np.sqrt(np.outer(np.diag(between), np.diag(between)))[chosen]
        # Two exact ways to the same; differences of forces mix rigid motions in by some 1e-6.
        np.testing.assert_allclose(summed[chosen] / scale, between[chosen] / scale, atol=1e-4)


def test_the_harmonic_duplex_shows_the_compliance_of_its_hessian(
    relaxed: Any, free: NormalModes
) -> None:
    duplex = relaxed.duplex
    reference = base_pair_frames(duplex)
    moves, energy = free.vibrations, BOLTZMANN_KJ_PER_MOL_K * COLD_K
    sd = np.sqrt(energy / free.eigenvalues_per_ps2[moves])
    rng = np.random.default_rng(2)
    body = np.tensordot(rng.standard_normal((SAMPLES, len(sd))) * sd, free.shapes[moves], axes=1)
    motion = record_of(duplex, body)
    strains = thermal_strains([frames_in_time(motion, reference)], COLD_K)
    found = {
        (one.route, one.quantity): one
        for one in thermal_constants(strains, rod_mass(duplex), "thermal")
    }
    axis = AxisStrains.of_structure(reference)
    covariance = axis.covariance(strain_compliance(free, duplex))
    truths = {
        "thermal, segments of 2 steps": segments_compliance(covariance, axis.heights_A, 2).mean(0),
        "thermal, wave of 4 steps": wave_compliance(covariance, axis.heights_A, 4),
        "thermal K(q->0)": wave_compliance(covariance, axis.heights_A, np.inf),
    }
    for route, compliance in truths.items():
        for name, truth in stiffness_of(compliance).items():
            one = found[route, name]
            # Twice the half width of the 95 % interval, about four standard errors.
            assert abs(one.value - truth) < one.high - one.low, (route, name)
            if name != "twist_stretch_coupling_pN_nm":
                # 2000 independent samples know a variance to 3 %.
                assert (one.high - one.low) / truth < 0.25


def record_of(duplex: Any, body: Array) -> xr.Dataset:
    """Return a record (motion.nc) of displacements and rotations (time, pair, 6), nm and rad."""
    dims = ("sign", "time", "pair", "xyz")
    return xr.Dataset(
        {
            "displacement": (dims, A_PER_NM * body[np.newaxis, ..., :3]),
            "rotation": (dims, body[np.newaxis, ..., 3:]),
            "centre": (("pair", "xyz"), A_PER_NM * duplex.bodies.centres_nm),
        }
    )


def test_mean_structure_is_the_structure_of_its_steps(relaxed: Any) -> None:
    frames = base_pair_frames(relaxed.duplex)
    steps = step_strains(frames).values
    again = mean_structure(steps)
    # Round-off of a few products of matrices.
    np.testing.assert_allclose(step_strains(again).values, steps, atol=1e-12)
    heights = [AxisStrains.of_structure(one).heights_A for one in (frames, again)]
    # The axis is found by least squares to 1e-9 of a length of 20 Å.
    np.testing.assert_allclose(np.diff(heights[0]), np.diff(heights[1]), atol=1e-6)
