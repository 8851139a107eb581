"""Excitations put in the momentum, torque and force that a scene declares."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dnawaves.scene.excitations import Kick, Periodic, Pulse, StandingWave
from dnawaves.scene.models import Ends, SceneSpec
from dnawaves.scene.pairs import excited_pairs, fixed_pairs, held_pairs, span
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.pattern import (
    directions,
    forces_at_full_strength,
    kick_pattern,
)
from dnawaves.units import PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]
WAVES = ("extension", "twist", "bend", "shear")
PAIRS = 6
FREE, HELD = Ends(first="free", last="free"), Ends(first="held", last="held")
ROUND_OFF = 1e-12


def strong(wave: str) -> dict[str, float]:
    linear = wave in ("extension", "shear")
    return {"velocity_A_per_ps" if linear else "angular_velocity_rad_per_ps": 0.5}


def loaded(wave: str, amount: float) -> dict[str, float]:
    return {"force_pN" if wave in ("extension", "shear") else "torque_pN_nm": amount}


@pytest.fixture(scope="module")
def duplex(as_built: Callable[..., SimulatedDuplex]) -> SimulatedDuplex:
    return as_built("CGATCG")


def kicked(duplex: SimulatedDuplex, wave: str, ends: Ends = FREE) -> Array:
    kick = Kick(kind="kick", wave=wave, pairs=2, **strong(wave))
    return kick_pattern(kick, ends, duplex.pair_count).velocities(duplex)


def test_held_and_excited_pairs() -> None:
    assert held_pairs(FREE, 8) == []
    assert held_pairs(Ends(first="held", last="held", pairs=2), 8) == [0, 1, 6, 7]
    assert held_pairs(Ends(first="free", last="held"), 8) == [7]
    # A guided end is pushed, not held.
    assert held_pairs(Ends(first="held", last="guided"), 8) == [0]
    kick = Kick(kind="kick", wave="extension", velocity_A_per_ps=1, pairs=3)
    assert excited_pairs(kick, Ends(first="free", last="held", pairs=2)) == [0, 1, 2]
    assert excited_pairs(kick, Ends(first="held", last="held", pairs=2)) == [2, 3, 4]
    # Next to springs, not on them; and where it is chosen, counted from 1.
    springs = Ends(first="restrained", last="restrained", pairs=2, stiffness_pN_per_nm=100)
    assert excited_pairs(kick, springs) == [2, 3, 4]
    chosen = Kick(kind="kick", wave="extension", velocity_A_per_ps=1, pairs=2, first_pair=5)
    assert excited_pairs(chosen, FREE) == excited_pairs(chosen, HELD) == [4, 5]


def test_what_a_wave_reaches_ends_at_what_is_held_or_restrained() -> None:
    springs = Ends(first="restrained", last="free", pairs=2, stiffness_pN_per_nm=100)
    assert held_pairs(springs, 8) == []
    assert fixed_pairs(springs, 8) == [0, 1]
    assert span(springs, 8) == (1, 7)
    assert fixed_pairs(HELD, 8) == held_pairs(HELD, 8) == [0, 7]
    assert span(HELD, 8) == span(FREE, 8) == (0, 7)


@pytest.mark.parametrize("wave", WAVES)
def test_a_chosen_place_gets_what_the_first_end_would_get(
    duplex: SimulatedDuplex, wave: str
) -> None:
    kick = Kick(kind="kick", wave=wave, pairs=2, first_pair=3, **strong(wave))
    velocities = kick_pattern(kick, HELD, PAIRS).velocities(duplex)
    chosen = np.isin(duplex.pairs, [2, 3])
    assert not velocities[~chosen].any()
    linear, angular = duplex.bodies.velocity(duplex.positions_nm, velocities)
    along, about = directions(duplex, wave)
    if wave in ("extension", "shear"):
        np.testing.assert_allclose(linear[2:4], [0.05 * along] * 2, atol=ROUND_OFF)
    else:
        np.testing.assert_allclose(angular[2:4], [0.5 * about] * 2, atol=ROUND_OFF)
    pulse = Pulse(kind="pulse", wave=wave, pairs=2, first_pair=3, **loaded(wave, 30.0))
    forces = forces_at_full_strength(pulse, HELD, duplex)
    assert not forces[~chosen].any()
    assert forces[chosen].any()


@pytest.mark.parametrize("wave", ["extension", "shear"])
@pytest.mark.parametrize(("ends", "pairs"), [(FREE, [0, 1]), (HELD, [1, 2])])
def test_momentum_of_a_linear_kick(
    duplex: SimulatedDuplex, wave: str, ends: Ends, pairs: list[int]
) -> None:
    momentum = duplex.masses_Da @ kicked(duplex, wave, ends)
    first, _, axis = duplex.frame.directions
    along = axis if wave == "extension" else first
    # 0.5 Å/ps = 0.05 nm/ps on the two excited pairs.
    mass = duplex.masses_Da[np.isin(duplex.pairs, pairs)].sum()
    np.testing.assert_allclose(momentum, mass * 0.05 * along, atol=ROUND_OFF * mass)


def test_angular_momentum_of_a_twist_kick(duplex: SimulatedDuplex) -> None:
    velocities = kicked(duplex, "twist")
    frame = duplex.frame
    arms = duplex.positions_nm - frame.origin_nm
    angular = np.cross(arms, duplex.masses_Da[:, None] * velocities).sum(axis=0)
    inertia = duplex.axial_inertia_Da_nm2[:2].sum()
    assert angular @ frame.axis == pytest.approx(0.5 * inertia, rel=ROUND_OFF)
    # Nothing moves along the axis.
    np.testing.assert_allclose(velocities @ frame.axis, 0, atol=ROUND_OFF)


def test_bend_turns_about_the_axis_at_the_pairs_own_height(duplex: SimulatedDuplex) -> None:
    velocities = kicked(duplex, "bend")
    second = duplex.frame.directions[1]
    for pair in (0, 1):
        chosen = duplex.pairs == pair
        arms = duplex.positions_nm[chosen] - duplex.pivots_nm[pair]
        np.testing.assert_allclose(velocities[chosen], np.cross(0.5 * second, arms), atol=ROUND_OFF)
    assert not velocities[duplex.pairs > 1].any()
    # The pivots lie on the axis (no displacement across it) one rise apart.
    np.testing.assert_allclose(np.diff(duplex.pivots_nm, axis=0), [[0, 0, 0.3375]] * 5, atol=1e-7)


@pytest.mark.parametrize("wave", WAVES)
def test_kicked_pairs_move_as_rigid_bodies(duplex: SimulatedDuplex, wave: str) -> None:
    velocities = kicked(duplex, wave)
    linear, angular = duplex.bodies.velocity(duplex.positions_nm, velocities)
    arms = duplex.positions_nm - duplex.bodies.centres_nm[duplex.pairs]
    rigid = linear[duplex.pairs] + np.cross(angular[duplex.pairs], arms)
    np.testing.assert_allclose(velocities, rigid, atol=ROUND_OFF)
    along, about = directions(duplex, wave)
    expected = np.zeros((PAIRS, 3))
    if wave in ("twist", "bend"):
        expected[:2] = 0.5 * about
    np.testing.assert_allclose(angular, expected, atol=ROUND_OFF)
    if wave in ("extension", "shear"):
        expected[:2] = 0.05 * along
        np.testing.assert_allclose(linear, expected, atol=ROUND_OFF)


def test_directions_form_a_right_handed_frame(duplex: SimulatedDuplex) -> None:
    displacement, rotation = directions(duplex, "bend")
    # A bend turns the tangent into the displacement: about second, axis goes to first.
    np.testing.assert_allclose(np.cross(rotation, duplex.frame.axis), displacement, atol=1e-12)


@pytest.mark.parametrize("wave", WAVES)
@pytest.mark.parametrize("mode", [1, 2])
@pytest.mark.parametrize("held", [1, 2])
def test_standing_waves_vanish_at_held_pairs(wave: str, mode: int, held: int) -> None:
    pairs = 14
    ends = Ends(first="held", last="held", pairs=held)
    kick = StandingWave(kind="standing_wave", wave=wave, mode=mode, **strong(wave))
    pattern = kick_pattern(kick, ends, pairs)
    stays = held_pairs(ends, pairs)
    assert not pattern.linear[stays].any()
    assert not pattern.angular[stays].any()
    # The declared amplitude is the largest: 0.5 rad/ps, or 0.5 Å/ps of the base pair or, where it
    # turns faster than it shifts, of atoms 10 Å off the axis.
    angular = np.abs(pattern.angular).max()
    linear = np.abs(pattern.linear).max() * 10
    largest = max(linear, 10 * angular) if wave in ("extension", "shear") else angular
    assert largest == pytest.approx(0.5, rel=1e-12)
    # Even or odd about the middle, as the rod is; a bend's or shear's rotation, the slope of its
    # displacement, has the opposite symmetry. Bends and axial waves start with the even one.
    parity = np.sign(pattern.linear @ pattern.linear[::-1]) or 1
    np.testing.assert_allclose(pattern.linear, parity * pattern.linear[::-1], atol=1e-9)
    turn = -parity if wave in ("bend", "shear") else (1 if mode % 2 else -1)
    np.testing.assert_allclose(pattern.angular, turn * pattern.angular[::-1], atol=1e-9)
    if wave in ("bend", "extension"):
        assert parity == (1 if mode % 2 else -1)


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_axial_standing_waves_are_sines(wave: str) -> None:
    kick = StandingWave(kind="standing_wave", wave=wave, mode=3, **strong(wave))
    pattern = kick_pattern(kick, HELD, 13)
    found = pattern.linear * 10 if wave == "extension" else pattern.angular
    # Mode 3 has its crests on base pairs 2, 6 and 10 of 0 to 12.
    np.testing.assert_allclose(found, 0.5 * np.sin(np.pi * np.arange(13) / 4), atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "wave"),
    [(kind, wave) for kind in ("pulse", "periodic") for wave in WAVES],
)
def test_forces_add_up_to_what_is_declared(duplex: SimulatedDuplex, kind: str, wave: str) -> None:
    amount = 30.0
    excitation: Pulse | Periodic = (
        Pulse(kind="pulse", wave=wave, pairs=2, **loaded(wave, amount))
        if kind == "pulse"
        else Periodic(
            kind="periodic", wave=wave, pairs=2, frequencies_GHz=(100,), **loaded(wave, amount)
        )
    )
    ends = FREE if kind == "pulse" else HELD
    forces = forces_at_full_strength(excitation, ends, duplex)
    pushed = [0, 1] if kind == "pulse" else [1, 2]
    assert not forces[~np.isin(duplex.pairs, pushed)].any()
    along, about = directions(duplex, wave)
    forces_pN = forces * PN_PER_KJ_PER_MOL_NM
    if wave in ("extension", "shear"):
        np.testing.assert_allclose(forces_pN.sum(axis=0), amount * along, atol=1e-9)
    else:
        arms = duplex.positions_nm - duplex.pivots_nm[duplex.pairs]
        torque = np.cross(arms, forces_pN).sum(axis=0) @ about
        assert torque == pytest.approx(amount, rel=1e-12)
    # They accelerate each pushed pair as a rigid body: nothing is left beside its rigid motion.
    accelerations = forces / duplex.masses_Da[:, None]
    bodies = duplex.bodies
    linear, angular = bodies.velocity(duplex.positions_nm, accelerations)
    arms = duplex.positions_nm - bodies.centres_nm[duplex.pairs]
    rigid = linear[duplex.pairs] + np.cross(angular[duplex.pairs], arms)
    np.testing.assert_allclose(accelerations, rigid, rtol=1e-9, atol=1e-12)


def test_one_pn_accelerates_one_pair_as_newton_says(duplex: SimulatedDuplex) -> None:
    pulse = Pulse(kind="pulse", wave="extension", pairs=1, force_pN=1.0)
    forces = forces_at_full_strength(pulse, FREE, duplex)
    acceleration = (forces[0] / duplex.masses_Da[0]) @ duplex.frame.axis
    mass_kg = duplex.bodies.masses_Da[0] * 1.66053906660e-27
    # m/s² = 1e9 nm/s² = 1e9/1e24 nm/ps².
    assert acceleration == pytest.approx(1e-12 / mass_kg * 1e-15, rel=1e-9)


def test_energy_of_a_kick_is_the_first_that_is_recorded(
    relaxed: Any, make_scene: Callable[..., SceneSpec], make_kick: Callable[..., dict[str, Any]]
) -> None:
    from dnawaves.trajectory.plan import Plan
    from dnawaves.trajectory.run import run_member

    duplex = relaxed.duplex
    for wave in WAVES:
        scene = make_scene(duplex, make_kick(wave))
        velocities = kick_pattern(scene.excitation, scene.ends, PAIRS).velocities(duplex)
        energy = 0.5 * float(np.sum(duplex.masses_Da[:, None] * velocities**2))
        motion = run_member(duplex, scene, Plan(0.002, 1, 1), "x1", {}).dataset()
        assert motion["difference_kinetic_energy"].values[0] == pytest.approx(energy, rel=1e-12)
        # And the total energy is that of the minimum and the kick. The CPU platform's potential
        # energy is in single precision: 1e-6 of 5,468 kJ/mol.
        rest = motion["total_energy"].values[:, 0] - relaxed.record.energy_kJ_per_mol
        np.testing.assert_allclose(rest, energy, atol=0.02)
