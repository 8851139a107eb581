"""Reflection and transmission: closed forms, conservation of energy, conversion by a bend."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dnawaves.errors import InputError
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.rod import EXTENSION, Rod
from dnawaves.rod.scattering import Scattering, scatter
from dnawaves.rod.sequence import StepSequence, body_mass

PAPER = Rod.paper()
TWISTED = Rod.paper(twisted=True)
A = PAPER.spacing_nm
MASS, SPRING = PAPER.density_Da_per_nm * A, PAPER.stiffness[EXTENSION, EXTENSION] / A
SCALE = np.sqrt(np.diag(PAPER.stiffness))


def coupled_rod(random: np.random.Generator) -> Rod:
    root = random.normal(size=(6, 6))
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 0.1 * np.outer(SCALE, SCALE) * (root @ root.T),
        gamma0=np.array([0.0, 0.0, 1.0]) + 0.05 * random.normal(size=3),
        omega0_rad_per_nm=np.array([0.05, 0.1, 1.76]) + 0.1 * random.normal(size=3),
        centre_nm=0.1 * random.normal(size=3),
    )


def unitarity_error(found: Scattering) -> float:
    both = np.concatenate([found.reflection_amplitudes, found.transmission_amplitudes])
    return float(np.abs(both.conj().T @ both - np.eye(both.shape[1])).max())


@pytest.mark.parametrize("rod", [PAPER, TWISTED, coupled_rod(np.random.default_rng(0))])
@pytest.mark.parametrize("frequency", [0.1, 0.9, 2.0, 4.0])
def test_a_uniform_chain_lets_every_wave_through(rod: Rod, frequency: float) -> None:
    found = scatter(rod, StepSequence.uniform(rod, 4), rod, frequency)
    # round-off of the Bloch waves
    assert found.reflection == pytest.approx(0, abs=1e-18)
    assert found.transmission == pytest.approx(np.eye(len(found.transmission)), abs=1e-11)


@pytest.mark.parametrize("rod", [PAPER, TWISTED, coupled_rod(np.random.default_rng(1))])
@pytest.mark.parametrize("frequency", [0.3, 1.1, 2.5])
def test_channels_are_the_waves_of_the_dispersion_relation(rod: Rod, frequency: float) -> None:
    waves = scatter(rod, StepSequence.uniform(rod, 2), rod, frequency).incoming
    step = 1e-5
    k = waves.wavenumbers_rad_per_nm
    frequencies = dispersion(rod, np.concatenate([k, k - step, k + step]), lattice=True)
    here, before, after = np.split(frequencies, 3)
    for i, speed in enumerate(waves.group_speeds_A_per_ps):
        branch = int(np.argmin(np.abs(here[i] - frequency)))
        # round-off
        assert here[i, branch] == pytest.approx(frequency, rel=1e-10)
        slope = 10 * (after[i, branch] - before[i, branch]) / (2 * step)
        # the difference quotient: the step squared, and round-off over the step
        assert speed == pytest.approx(slope, rel=1e-5)
        assert waves.shares[i].sum() == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("frequency", [0.05, 1.0, 2.4, 4.5])
def test_one_heavier_mass_reflects_as_the_closed_form_says(frequency: float) -> None:
    k_a = 2 * np.arcsin(frequency / 2 * np.sqrt(MASS / SPRING))
    added = 2.5 * MASS
    heavy = StepSequence.uniform(PAPER, 3).with_bound(1, body_mass(added))
    reflected, transmitted = scatter(PAPER, heavy, PAPER, frequency).between(
        "extension", "extension"
    )
    ratio = added * frequency**2 / (2 * SPRING * np.sin(k_a))
    # closed form of the chain of masses and springs; round-off
    assert transmitted == pytest.approx(1 / (1 + ratio**2), rel=1e-10)
    assert reflected == pytest.approx(ratio**2 / (1 + ratio**2), rel=1e-10)


@pytest.mark.parametrize("frequency", [0.05, 1.0, 2.4, 4.5])
@pytest.mark.parametrize("factor", [0.2, 0.7, 5.0])
def test_one_softer_spring_reflects_as_the_closed_form_says(
    frequency: float, factor: float
) -> None:
    k_a = 2 * np.arcsin(frequency / 2 * np.sqrt(MASS / SPRING))
    soft = replace(PAPER, stiffness=PAPER.stiffness * factor)
    stretch = StepSequence.uniform(PAPER, 2).with_steps(slice(0, 1), soft)
    _, transmitted = scatter(PAPER, stretch, PAPER, frequency).between("extension", "extension")
    ratio = (1 / factor - 1) * np.tan(k_a / 2)
    # closed form of the chain of masses and springs; round-off
    assert transmitted == pytest.approx(1 / (1 + ratio**2), rel=1e-10)


def test_a_junction_of_two_rods_reflects_by_their_impedances() -> None:
    stiffer = replace(PAPER, stiffness=PAPER.stiffness * 4)
    stretch = StepSequence.uniform(PAPER, 2)
    reflected, _ = scatter(PAPER, stretch, stiffer, 0.01).between("extension", "extension")
    # long waves: ((Z1 - Z2)/(Z1 + Z2))^2 with Z = sqrt(C rho), up to (k a)^2 = 2e-5
    assert reflected == pytest.approx(1 / 9, rel=1e-4)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), frequency=st.floats(0.05, 4.5), steps=st.integers(1, 6))
def test_reflection_and_transmission_add_up_to_one(seed: int, frequency: float, steps: int) -> None:
    random = np.random.default_rng(seed)
    left, right, inside = (coupled_rod(random) for _ in range(3))
    body = body_mass(random.uniform(0, 3000), random.uniform(0, 200, 3), random.normal(size=3))
    stretch = StepSequence.uniform(left, steps + 2).with_steps(slice(1, steps + 1), inside)
    try:
        found = scatter(left, stretch.with_bound(1, body), right, frequency)
    except InputError as error:
        # above the last band of one chain, or at a band's edge, which is said
        assert "propagates" in str(error) or "edge" in str(error)
        assume(False)
    # close to a band's edge a wave nearly stands and its normalisation loses digits
    speeds = np.concatenate(
        [
            found.incoming.group_speeds_A_per_ps,
            found.transmitted.group_speeds_A_per_ps,
            [10.0],
        ]
    )
    # round-off, amplified by the slowest wave
    assert unitarity_error(found) < 1e-11 * 10 / speeds.min()
    total = found.reflection.sum(axis=0) + found.transmission.sum(axis=0)
    assert total == pytest.approx(1, abs=1e-11 * 10 / speeds.min())


def test_transmission_is_the_same_from_both_sides() -> None:
    """Reciprocity: the sum over channels, also of a rod that converts."""
    bent = replace(PAPER, omega0_rad_per_nm=np.array([0.0, 0.6, 0.0]))
    heavy = StepSequence.uniform(PAPER, 8).with_steps(slice(1, 4), bent)
    stiffer = replace(PAPER, stiffness=PAPER.stiffness * 2)
    there = scatter(PAPER, heavy, stiffer, 0.7)
    # seen from the other end: a half turn about axis 1 reverses axes 2 and 3
    turn = np.kron(np.eye(2), np.diag([1.0, -1.0, -1.0]))
    back = StepSequence(
        heavy.stiffness[::-1],
        heavy.gamma0[::-1] * [-1, 1, 1],
        heavy.omega0_rad_per_nm[::-1] * [-1, 1, 1],
        turn @ heavy.mass[::-1] @ turn,
        heavy.spacing_nm,
    )
    here = scatter(stiffer, back, PAPER, 0.7)
    # round-off
    assert here.transmission.sum() == pytest.approx(there.transmission.sum(), rel=1e-10)


def bent_segment(steps: int, degrees: float) -> StepSequence:
    """A segment bent by roll alone, total angle in degrees, in a straight untwisted chain."""
    roll = np.deg2rad(degrees) / (steps * A)
    bent = replace(PAPER, omega0_rad_per_nm=np.array([0.0, roll, 0.0]))
    return StepSequence.uniform(PAPER, steps + 1).with_steps(slice(0, steps), bent)


def test_a_bend_converts_extension_into_bending_and_a_straight_rod_does_not() -> None:
    frequency = 0.5
    for steps, degrees in ((1, 0.0), (6, 45.0), (6, 90.0)):
        found = scatter(PAPER, bent_segment(steps, degrees), PAPER, frequency)
        kept = sum(found.between("extension", "extension"))
        converted = sum(found.between("extension", "transverse"))
        twisted = sum(found.between("extension", "twist"))
        # energy; the bend lies in a plane of mirror symmetry, which twist does not
        assert kept + converted == pytest.approx(1, abs=1e-11)
        assert twisted == pytest.approx(0, abs=1e-20)
        if degrees == 0:
            assert converted == pytest.approx(0, abs=1e-20)
        else:
            assert converted > 0.1
        # what bending turns into extension: the same matrix read the other way (reciprocity)
        back = found.between("transverse", "extension")
        assert sum(back) * 2 == pytest.approx(converted, rel=1e-9)


STRETCH, WAVELENGTHS = 10, (48, 24, 12, 6)
SCATTERING_TABLE = """\
| stretch of 10 base-pair steps | flux | 48 bp | 24 bp | 12 bp | 6 bp |
| --- | --- | --- | --- | --- | --- |
"""


def scattering_table() -> str:
    """The table of docs/theory.md: extension of some wavelengths meets a soft or a bent stretch."""
    soft = replace(PAPER, stiffness=PAPER.stiffness / 2)
    softer = StepSequence.uniform(PAPER, STRETCH + 1).with_steps(slice(0, STRETCH), soft)
    bends = (18, 45, 90)
    stretches = {"half as stiff": softer}
    stretches |= {f"bent by {degrees}°": bent_segment(STRETCH, degrees) for degrees in bends}
    rows = []
    for name, stretch in stretches.items():
        found = []
        for pairs in WAVELENGTHS:
            # 2 V/a sin(ka/2) of a wave of so many base pairs
            frequency = 2 * np.sqrt(SPRING / MASS) * np.sin(np.pi / pairs)
            one = scatter(PAPER, stretch, PAPER, frequency)
            converted = sum(one.between("extension", "transverse"))
            found.append([*one.between("extension", "extension"), converted])
        for flux, values in zip(
            ("reflected", "transmitted", "into bend"), np.transpose(found), strict=True
        ):
            rows.append([name, flux, *(f"{value:.3f}" for value in values)])
    return SCATTERING_TABLE + "".join(f"| {' | '.join(row)} |\n" for row in rows)


def test_the_documentation_quotes_what_a_soft_and_a_bent_stretch_do() -> None:
    page = Path(__file__).parents[2] / "docs" / "theory.md"
    assert scattering_table() in page.read_text(encoding="utf-8")


def test_a_softer_stretch_reflects_a_ninth_of_a_long_wave_at_most() -> None:
    soft = replace(PAPER, stiffness=PAPER.stiffness / 2)
    quarter = 200
    stretch = StepSequence.uniform(PAPER, quarter + 1).with_steps(slice(0, quarter), soft)
    # a quarter of a wave on 200 base pairs of half the stiffness
    frequency = np.sqrt(SPRING / MASS / 2) * np.pi / 2 / quarter
    reflected, _ = scatter(PAPER, stretch, PAPER, frequency).between("extension", "extension")
    # ((1 - 1/2)/(1 + 1/2))^2 of the continuous rod; ends of the stretch are sharp to 1/400
    assert reflected == pytest.approx(1 / 9, rel=1e-3)


def test_a_slight_bend_converts_as_the_square_of_its_angle() -> None:
    converted = [
        sum(scatter(PAPER, bent_segment(4, degrees), PAPER, 0.4).between("extension", "transverse"))
        for degrees in (0.5, 1.0)
    ]
    # Born approximation: next order the angle squared, 3e-4
    assert converted[1] / converted[0] == pytest.approx(4, rel=3e-3)


def test_roll_that_turns_with_the_helix_converts_less_than_the_same_roll_in_line() -> None:
    """Along one turn equal rolls bend back and forth: the angles cancel, a small offset stays."""
    turn = replace(PAPER, omega0_rad_per_nm=np.array([0.0, 0.0, 2 * np.pi / (10 * A)]))
    roll = np.deg2rad(4.0) / A
    helical = replace(turn, omega0_rad_per_nm=turn.omega0_rad_per_nm + np.array([0, roll, 0]))
    stretch = StepSequence.uniform(turn, 11).with_steps(slice(0, 10), helical)
    long_wave = 0.05
    along_helix = sum(scatter(turn, stretch, turn, long_wave).between("extension", "transverse"))
    in_line = sum(
        scatter(PAPER, bent_segment(10, 40.0), PAPER, long_wave).between("extension", "transverse")
    )
    assert along_helix < 0.5 * in_line


def test_a_wave_packet_in_a_finite_chain_splits_its_energy_likewise() -> None:
    """Independent of Bloch waves: a packet sent from the left end meets a heavier mass."""
    frequency, pairs, middle, width, time = 1.0, 400, 200, 13.0, 215.0
    masses = np.full(pairs, MASS)
    masses[middle] += 2 * MASS
    chain = ScalarChain(masses, SPRING)
    pattern = np.zeros(pairs)
    pattern[0] = 1.0
    times = np.arange(0, time + 0.1, 0.2)
    course = np.sin(frequency * times) * np.exp(-(((times - 4 * width) / width) ** 2) / 2)
    # the packet has left the mass after some 190 ps and comes back from the ends after 250 ps
    position, velocity = (part[-1] for part in chain.sampled_response(course, 0.2, pattern))
    links = SPRING * np.diff(position) ** 2 / 2
    energy = masses * velocity**2 / 2 + np.append(links, 0)
    heavy = StepSequence.uniform(PAPER, 2).with_bound(0, body_mass(2 * MASS))
    inside = frequency + np.linspace(-3, 3, 25) / width
    weight = np.exp(-(((inside - frequency) * width) ** 2))
    transmitted = [
        scatter(PAPER, heavy, PAPER, w).between("extension", "extension") for w in inside
    ]
    expected = np.average(transmitted, axis=0, weights=weight)[1]
    # what enters the end grows a little with the frequency: part of (1/width)^2 = 6e-3
    assert energy[middle + 1 :].sum() / energy.sum() == pytest.approx(expected, abs=6e-3)


def test_impossible_requests_are_refused() -> None:
    stretch = StepSequence.uniform(PAPER, 2)
    with pytest.raises(InputError, match="positive"):
        scatter(PAPER, stretch, PAPER, 0.0)
    with pytest.raises(InputError, match="propagates in the left chain"):
        scatter(PAPER, stretch, PAPER, 50.0)
    with pytest.raises(InputError, match="spacing"):
        scatter(replace(PAPER, spacing_nm=0.3), stretch, PAPER, 1.0)
    with pytest.raises(InputError, match="no twist wave"):
        scatter(PAPER, stretch, PAPER, 4.0).between("twist", "extension")
    # the top of the last band: the wave stands
    with pytest.raises(InputError, match=r"edge|propagates"):
        scatter(PAPER, stretch, PAPER, 2 * np.sqrt(SPRING / MASS))
