"""Some of the fast cases come out as declared, and would not if the physics were wrong."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.stability import drives, nve, orientation, rods, starts
from dnawaves.stability.case import cases
from dnawaves.stability.judge import judge
from dnawaves.stability.samples import built, warm
from dnawaves.system.forces import nonbonded_force

FAST = [name for name, case in cases().items() if case.seconds <= 0.3]


@pytest.mark.parametrize("name", FAST)
def test_fast_case(name: str) -> None:
    row = judge(name, cases()[name])
    assert row.verdict == "pass", row


def test_the_evanescent_decay_knows_its_frequency() -> None:
    # Nearer the edge a pair moves more of what the one before does.
    decays = [drives.evanescent(share, 30).remark.split()[2] for share in (1.1, 1.5, 3.0)]
    assert sorted(decays, reverse=True) == decays


def test_a_mode_driven_beside_itself_is_not_that_driven_at_itself() -> None:
    # A part in a thousand off, over 100 periods: the phase slips by 0.6 rad, the largest motion by
    # 1 - sin(x)/x = 1.6 % with x = 0.31.
    amplitude = [float(rods.at_a_mode(off, 100).remark.split()[1]) for off in (0.0, 1e-3)]
    assert amplitude[1] / amplitude[0] == pytest.approx(0.984, abs=2e-3)


def test_an_error_in_a_step_would_show() -> None:
    assert orientation.step(10, -20, 36).value < 1e-9
    # The same step with its twist counted the other way round is 72° off.
    given, mirrored = (orientation.step(10, -20, twist).remark for twist in (36, -36))
    assert given != mirrored
    twists = [float(remark.rpartition(", ")[2]) for remark in (given, mirrored)]
    # As exact as it is printed.
    assert twists[0] - twists[1] == pytest.approx(72, abs=1e-3)


def test_two_atoms_in_one_place_are_named() -> None:
    found = starts.coincident()
    assert found.outcome == "explodes"
    assert "A:1 H5 and B:1 O2, 0.0000 nm apart" in found.remark


def test_the_shadow_energy_fluctuates_less_and_a_wrong_force_shows() -> None:
    duplex = built("CGCG")
    start = warm(duplex.system, duplex.positions_nm, 100.0, steps=200)
    run = nve.energies(duplex, start, "leapfrog", 0.0005, 0.2)
    # Bonds to hydrogen at 0.5 fs: (omega dt)²/8 = 1.5 % of their energy, in the shadow its square.
    assert run.fluctuation(run.shadow) < 0.1 * run.fluctuation(run.total)
    assert run.temperature_K == pytest.approx(100, abs=25)
    nonbonded = nonbonded_force(duplex.system)
    nonbonded.setUseSwitchingFunction(False)
    nonbonded.setReactionFieldDielectric(1.0)
    jumps = nve.energies(duplex, start, "leapfrog", 0.0005, 0.2)
    assert jumps.fluctuation(jumps.shadow) > 3 * run.fluctuation(run.shadow)


def test_drift_is_the_slope_of_a_line() -> None:
    times = np.linspace(0, 10, 1000)
    # 3000 freedoms at 120.27 K hold kT = 1 kJ/mol each: 3 kJ/mol in 10 ps are 0.1 kT/ns/dof.
    energy = 0.3 * times + 0.01 * np.sin(40 * times)
    run = nve.Energies(times, energy, energy, 120.2724, 3000)
    slope, error = run.drift(energy)
    assert slope == pytest.approx(0.1, rel=1e-3)
    assert 0 < error < 1e-3
