"""Three questions: the miniature is a rod with four times the paper's stiffness, and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dnawaves.report.answers import CONSTANTS, answers, false_alarms, implied_constant, lead
from dnawaves.report.gather import Results
from dnawaves.report.routes import constants_table, wave_routes
from dnawaves.waves.constants.rod_mass import RodMass


def words(results: Results, number: int) -> dict[str, str]:
    return {line.wave: line.word for line in answers(results)[number].lines}


def test_the_papers_constants_are_wrong_and_the_rod_is_right(results: Results) -> None:
    paper, rod, implied = answers(results)
    assert words(results, 0) == {"extension": "disagree", "bend": "disagree"}
    assert paper.answer == "No: extension and bend."
    assert words(results, 1)["extension"] == "agree"
    assert paper.lines[0].number == "2.00 (1.96–2.06) × the paper's"
    # A continuous rod's mode is 0.5 % above the chain's, which the speeds are read by.
    assert rod.lines[0].number == "0.99 (0.97–1.03) × its rod's"
    assert len(implied.lines) == 1


def test_the_waves_give_back_the_stiffness_that_made_them(results: Results, truth) -> None:
    (system,) = results.systems.values()
    row = lead(results.table[results.table["wave"] == "extension"])
    assert row is not None
    found = implied_constant(system, row)
    assert found is not None
    # C3 = 2160 pN, four times; the table of speeds holds six digits.
    assert found.value == pytest.approx(4 * 2160, rel=1e-4)
    assert found.low == pytest.approx(0.98**2 * found.value, rel=1e-4)


def test_all_waves_together_have_the_say_about_the_constants(results: Results) -> None:
    (system,) = results.systems.values()
    joint = pd.DataFrame(
        {
            "quantity": ["bend_rigidity_pN_nm2"],
            "value": [810.0],
            "low": [790.0],
            "high": [840.0],
            "source": ["a, b, c"],
            "misfit": [0.25],
            "model_class": ["fits roughly: leaves 6% of the motion"],
        }
    )
    systems = {system.spec.name: replace(system, joint=joint)}
    changed = replace(results, systems=systems)
    bend = next(line for line in answers(changed)[2].lines if line.wave == "bend")
    assert bend.number == "810 (790–840) pN nm²"
    assert "3 scenes together, misfit 25\u00a0%, fits roughly" in bend.more
    # D = 270 pN nm².
    assert "3.0 (bend)" in answers(changed)[2].answer
    table = constants_table(changed, systems[system.spec.name])
    assert table is not None
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["bend rigidity, pN nm²"][-1] == "810 (790–840)"


def test_words_that_differ_are_told_wave_by_wave(results: Results) -> None:
    table = results.table.copy()
    table.loc[table["wave"] == "bend", "verdict_paper"] = "undecided"
    paper = answers(replace(results, table=table))[0]
    assert paper.answer == "No for extension. Undecided for bend."


def test_several_structures_have_the_say_where_they_decide(results: Results) -> None:
    lead_row = lead(results.table[results.table["wave"] == "extension"])
    assert lead_row is not None
    for word, expected in (("agree", "agree"), ("undecided", "disagree")):
        group = lead_row.copy()
        group["scope"], group["verdict_paper"] = "over 5 inherent structures", word
        table = pd.concat([results.table, group.to_frame().T], ignore_index=True)
        (line, *_) = answers(replace(results, table=table))[0].lines
        assert (line.wave, line.word) == ("extension", expected)
        assert "over 5 inherent structures" in line.more


@pytest.mark.parametrize(("word", "said"), [("agree", "bend"), ("disagree", "the lowest bend")])
def test_a_shorter_wave_that_was_judged_otherwise_is_told(
    results: Results, word: str, said: str
) -> None:
    table = results.table
    lowest = lead(table[table["wave"] == "bend"])
    assert lowest is not None
    shorter = lowest.copy()
    shorter["frequency_GHz"] *= 2
    lowest["verdict_paper"], shorter["verdict_paper"] = "agree", word
    shorter[["ratio_to_paper", "ratio_to_paper_low", "ratio_to_paper_high"]] = 1.2, 1.1, 1.3
    rest = table[table["wave"] != "bend"]
    table = pd.concat([rest, lowest.to_frame().T, shorter.to_frame().T], ignore_index=True)
    paper = answers(replace(results, table=table))[0]
    assert f"Yes for {said}." in paper.answer
    line = next(line for line in paper.lines if line.wave == "bend")
    assert line.more.endswith(f"shorter waves: 1.20 (1.10–1.30), {word}")


def test_false_alarms_are_counted_and_bounded(results: Results) -> None:
    # One search in one null: a rate below 95 % is all that one clean trial shows.
    assert "0 of 1 searches saw a wave" in false_alarms(results.table)
    assert "above 95\u00a0%" in false_alarms(results.table)
    loud = results.table.replace({"verdict": {"no wave": "false alarm"}})
    assert "1 of 1 searches saw a wave" in false_alarms(loud)
    without = results.table[results.table["scene"] != "nothing"]
    assert false_alarms(without).startswith("No null scene was run")


def test_a_simulated_scene_speaks_before_its_exact_twin(results: Results) -> None:
    row = lead(results.table[results.table["wave"] == "extension"])
    assert row is not None and row["scene"] == "mode1"


def test_what_speaks_falls_back_on_what_there_is(results: Results) -> None:
    row = lead(results.table[results.table["scene"].isin(["kick", "load"])])
    assert row is not None and row["estimator"] == "waveform"
    assert lead(results.table[results.table["scene"] == "nothing"]) is None


def test_coupled_waves_stand_beside_the_constant_that_they_are_nearest_to(
    results: Results,
) -> None:
    # Of a relaxed duplex of 24 base pairs, by its segments of 16 steps.
    stretch, twist, coupling = 7582.0, 1084.0, 503.0
    relaxed = 1 - coupling**2 / (stretch * twist)
    given = {
        "stretch_modulus_pN": stretch,
        "stretch_modulus_relaxed_pN": stretch * relaxed,
        "twist_rigidity_pN_nm2": twist,
        "twist_rigidity_relaxed_pN_nm2": twist * relaxed,
        "twist_stretch_coupling_pN_nm": coupling,
    }
    mass = RodMass(198.1, 8358.5, 5558.4)
    speeds = mass.speeds(given)
    (system,) = results.systems.values()
    constants = system.constants.set_index("quantity")
    constants.loc["density_Da_per_A", "value"] = mass.density_Da_per_A
    constants.loc["inertia_axial_Da_A", "value"] = mass.inertia_axial_Da_A
    own = replace(system, constants=constants.reset_index())
    for wave, both in (("extension", "stretch_modulus"), ("twist", "twist_rigidity")):
        row = pd.Series(
            {
                "wave": wave,
                "interval": "none",
                "speed_A_per_ps": speeds[f"speed_{wave}_A_per_ps"],
                "low_A_per_ps": np.nan,
                "high_A_per_ps": np.nan,
            }
        )
        found = implied_constant(own, row)
        assert found is not None
        candidates = [name for name in given if name.startswith(both)]
        nearest = min(candidates, key=lambda name, value=found.value: abs(given[name] - value))
        assert nearest == CONSTANTS[wave][1]


def test_the_routes_of_a_wave_are_held_against_its_lowest_mode(results: Results, truth) -> None:
    (extension,) = wave_routes(results)
    assert f"{truth.speed_A_per_ps:.1f} Å/ps" in extension.sentence
    assert extension.agreement is not None
    assert {route.word for route in extension.agreement.routes} == {"agree"}


def test_the_papers_constants_stand_beside_every_route_and_the_waves(results: Results) -> None:
    (system,) = results.systems.values()
    table = constants_table(results, system)
    assert table is not None
    assert list(table.header)[2:] == ["hessian, segments of 5 steps", "waves"]
    rows = {row[0]: row[1:] for row in table.rows}
    # Bishop and Zhmudsky: C3 = 2160 pN, D = 270 pN nm².
    assert rows["stretch modulus at fixed twist, pN"] == [
        "2160",
        "8640 (8470–8810)",
        "8640 (8300–9170)",
    ]
    assert rows["bend rigidity, pN nm²"][0] == "270"
    assert rows["twist rigidity, pN nm²"][-1] == "–"
