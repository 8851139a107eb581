"""What a drive puts in is what the duplex has: work as energy, impulse as momentum."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dnawaves.scene.models import SceneSpec
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member

MakeScene = Callable[..., SceneSpec]
MakeKick = Callable[..., dict[str, Any]]
WAVES = ("extension", "twist", "bend", "shear")
HELD = {"first": "held", "last": "held"}


@pytest.mark.parametrize("frequency_GHz", [150.0, 500.0])
def test_work_of_the_drive_is_the_energy_gained(
    relaxed: Any, make_scene: MakeScene, frequency_GHz: float
) -> None:
    excitation = {
        "kind": "periodic",
        "wave": "extension",
        "force_pN": 200,
        "pairs": 2,
        "frequencies_GHz": [frequency_GHz],
    }
    scene = make_scene(relaxed.duplex, excitation, HELD)
    plan = Plan(0.002, 25, 21, frequency_GHz=frequency_GHz)
    motion = run_member(relaxed.duplex, scene, plan, "f1", {}).dataset()
    work = motion["work"].values
    gained = motion["total_energy"].values - motion["total_energy"].values[:, :1]
    # 1 %: the work is of second order in the timestep; the energy, in single precision, has 3e-3
    # kJ/mol of 0.2 and more.
    np.testing.assert_allclose(gained, work, atol=0.01 * work.max() + 2e-3)
    assert work.max() > 0.15
    assert not work[:, 0].any()
    # The opposite sign is done the same work, to second order.
    assert np.linalg.norm(work[0] - work[1]) < 0.15 * np.linalg.norm(work[0])


def test_pulse_gives_its_impulse_to_a_free_duplex(relaxed: Any, make_scene: MakeScene) -> None:
    width_ps, force_pN = 0.04, 100.0
    excitation = {
        "kind": "pulse",
        "wave": "shear",
        "force_pN": force_pN,
        "pairs": 2,
        "width_fs": 1e3 * width_ps,
    }
    scene = make_scene(relaxed.duplex, excitation)
    plan = Plan(0.002, 200, 2, pulse_width_ps=width_ps)
    motion = run_member(relaxed.duplex, scene, plan, "run", {}).dataset()
    momentum = np.einsum("p,spx->sx", motion["mass"], motion["velocity"].isel(time=-1))
    # pN ps = 1e-24 kg m/s; a Da Å/ps is 1.66053907e-27 kg times 100 m/s.
    impulse = force_pN * width_ps * np.sqrt(2 * np.pi) * 1e-24 / 1.66053907e-25
    first = motion["direction"].sel(axis="first").values
    # Single-precision forces do not quite cancel: 1e-3 kJ/mol/nm in sum for 0.4 ps, of 60 Da Å/ps.
    np.testing.assert_allclose(momentum, [impulse * first, -impulse * first], atol=5e-3)
    assert impulse > 50


@pytest.mark.parametrize("kind", ["kick", "pulse", "periodic"])
@pytest.mark.parametrize("wave", WAVES)
def test_what_is_put_in_is_what_a_free_duplex_has(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick, kind: str, wave: str
) -> None:
    load = {"force_pN": 1e3} if wave in ("extension", "shear") else {"torque_pN_nm": 1e3}
    excitations = {
        "kick": make_kick(wave),
        "pulse": {"kind": "pulse", "wave": wave, "pairs": 2, "width_fs": 40.0, **load},
        # Some half of a period in the record, so that the impulse is not zero.
        "periodic": {
            "kind": "periodic",
            "wave": wave,
            "pairs": 2,
            "frequencies_GHz": [1500.0],
            # Longer than the pulse, so less of it: the pairs must not deform more.
            **{name: value / 2 for name, value in load.items()},
        },
    }
    scene = make_scene(relaxed.duplex, excitations[kind])
    plan = Plan(0.002, 20, 11, pulse_width_ps=0.04, frequency_GHz=1500.0)
    motion = run_member(relaxed.duplex, scene, plan, "x1", {}).dataset()
    centres = motion["centre"].values + motion["displacement"].values
    momenta = motion["mass"].values[:, None] * motion["velocity"].values
    turned = Rotation.from_rotvec(motion["rotation"].values.reshape(-1, 3)).as_matrix()
    turned = turned.reshape(*motion["rotation"].shape, 3)
    spins = np.einsum(
        "...ij,...jk,...lk,...l->...i",
        turned,
        motion["inertia"].values,
        turned,
        motion["angular_velocity"].values,
    )
    put_in = (motion["injected_momentum"].values, motion["injected_angular_momentum"].values)
    found = (momenta.sum(axis=2), (np.cross(centres, momenta) + spins).sum(axis=2))
    for whole, part in zip(put_in, found, strict=True):
        # Momentum: what single-precision forces leave, as of a pulse. Angular momentum: each pair
        # is taken as rigid with its inertia at rest, which deforms by some 1e-3.
        np.testing.assert_allclose(part, whole, atol=5e-3 * np.abs(whole).max() + 5e-3)
    assert np.abs(put_in[1]).max() > 100
    gained = motion["total_energy"].values - motion["total_energy"].values[:, :1]
    work = motion["work"].values
    # The energy, in single precision, as above; the work, of second order in the timestep.
    np.testing.assert_allclose(gained, work, atol=0.01 * work.max() + 5e-3)
    assert (work[:, -1] > 0.5).all() == (kind != "kick")


def test_ramped_drive_stays_below_one_that_is_switched_on(
    relaxed: Any, make_scene: MakeScene
) -> None:
    excitation = {
        "kind": "periodic",
        "wave": "extension",
        "force_pN": 100,
        "pairs": 2,
        "frequencies_GHz": [1000.0],
    }
    scene = make_scene(relaxed.duplex, excitation, HELD)
    plans = [Plan(0.002, 25, 21, frequency_GHz=1000.0, ramp_ps=ramp_ps) for ramp_ps in (0.0, 0.8)]
    motions = [run_member(relaxed.duplex, scene, plan, "f1", {}).dataset() for plan in plans]
    early = [motion.isel(time=slice(1, 5))["velocity"].values for motion in motions]
    # In the first fifth of the ramp the force is below a tenth of its height.
    assert np.abs(early[1]).max() < 0.1 * np.abs(early[0]).max()
    motion = motions[1]
    gained = motion["total_energy"].values - motion["total_energy"].values[:, :1]
    work = motion["work"].values
    # As for the drive without a ramp.
    np.testing.assert_allclose(gained, work, atol=0.01 * work.max() + 2e-3)
    assert work.max() > 0.05
