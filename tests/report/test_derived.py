"""What follows from the miniature: a uniform rod twice as fast as the paper's, friction 0.1 /ps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dnawaves.report.derived import attenuation, coupling, diffusion
from dnawaves.report.gather import Results, SystemResults
from dnawaves.report.trends import by_sequence, by_temperature, lag_distance


def test_a_wave_dies_out_over_twice_its_speed_over_its_friction(results: Results, truth) -> None:
    (system,) = results.systems.values()
    illustration, line = attenuation(results, system)
    assert illustration is not None
    extension = next(one for one in illustration.figure.data if one.name == "extension")
    expected = 2 * truth.speed_A_per_ps / truth.friction_per_ps
    # Tables hold six digits.
    assert list(extension.y) == pytest.approx([expected] * len(extension.y), rel=1e-5)
    # 2 times 16.4 over 0.1, with two digits; 3.3 Å a base pair.
    assert "extension 330 Å (99 bp)" in line


def test_propagation_ends_at_half_the_friction(results: Results, truth) -> None:
    (system,) = results.systems.values()
    illustration, line = diffusion(results, system)
    assert illustration is not None
    turn = next(one for one in illustration.figure.data if "GHz" in (one.name or ""))
    assert turn.x[0] == pytest.approx(1e3 * truth.friction_per_ps / 2 / (2 * np.pi))
    # V²/g is 16.4² over 0.1, with two digits.
    assert "with 2700 Å²/ps" in line


def test_the_coupling_that_there_is_not_is_zero(results: Results) -> None:
    (system,) = results.systems.values()
    illustration, line = coupling(system)
    assert illustration is not None
    assert list(illustration.figure.data[0].y) == [0.0]
    assert "over 5 steps" in line


def test_kinds_of_steps_are_ranked_by_what_they_are_worth(results: Results) -> None:
    illustration, line = by_sequence(results)
    assert illustration is not None
    extension = illustration.figure.data[0]
    assert (list(extension.x), list(extension.y)) == (["GA", "CG"], [10.0, 12.0])
    assert "extension from 10.0 (GA) to 12.0 Å/ps (CG)" in line


def test_what_has_no_data_is_a_line_that_says_what_to_run(results: Results) -> None:
    figure, line = by_temperature(results)
    assert figure is None and "temperature_K: 300" in line
    # The miniature's kick of twist has two frames.
    figure, line = lag_distance(results)
    assert figure is None and line.startswith("Lag: ")
    without = replace(results, table=results.table[results.table["friction_per_ps"].isna()])
    (system,) = results.systems.values()
    for made in (attenuation, diffusion):
        figure, line = made(without, system)
        assert figure is None and "no fit found a friction" in line


def test_another_duplex_is_no_other_temperature(results: Results) -> None:
    (system,) = results.systems.values()

    def at(name: str, kelvin: float, sequence: str) -> SystemResults:
        duplex = system.spec.duplex.model_copy(update={"sequence": sequence})
        environment = system.spec.environment.model_copy(update={"temperature_K": kelvin})
        changed = {"duplex": duplex, "environment": environment, "environment_name": name}
        return replace(system, spec=system.spec.model_copy(update=changed))

    rows = results.table[results.table["estimator"] == "standing wave"]
    table = pd.concat([rows.assign(system=name) for name in ("cold", "warm")])
    own = system.spec.duplex.sequence
    for sequence, said in ((own, "Å/ps per 100 K"), (own[1:], "no duplex has speeds")):
        systems = {"cold": at("cold", 0.0, own), "warm": at("warm", 300.0, sequence)}
        _, line = by_temperature(replace(results, table=table, systems=systems))
        assert said in line


def test_a_coupling_of_unknown_sign_says_so(results: Results) -> None:
    (system,) = results.systems.values()
    rows = system.constants["route"].str.contains("segments") & (
        system.constants["quantity"] == "twist_stretch_coupling_pN_nm"
    )
    unsure = system.constants.copy()
    unsure.loc[rows, ["value", "low", "high"]] = -50.0, -150.0, 30.0
    _, line = coupling(replace(system, constants=unsure))
    assert "overwinds, which the interval does not settle" in line
