"""The page holds every scene, opens without a network, and never shows a number that is none."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from dnawaves.errors import InputError
from dnawaves.report.gather import Results, gather, read_jobs
from dnawaves.report.page import render
from dnawaves.report.steps import report_step
from dnawaves.report.tables import Held, verdicts
from dnawaves.report.words import scene_sentence


class Reader(HTMLParser):
    """What a browser would load, link to and show."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.text = ""
        self._hidden = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.ids.append(value)
            if name in ("src", "srcset", "data", "href") and value:
                (self.links if tag == "a" else self.loaded).append(value)
        if tag in ("script", "style"):
            self._hidden = tag

    def handle_endtag(self, tag: str) -> None:
        if tag == self._hidden:
            self._hidden = ""

    def handle_data(self, data: str) -> None:
        if not self._hidden:
            self.text += data


@pytest.fixture(scope="module")
def reader(page: Path) -> Reader:
    return Reader(page.read_text(encoding="utf-8"))


def test_every_scene_has_a_section_and_a_link_in_the_configurations_order(reader, results):
    sections = [name.removeprefix("scene-") for name in reader.ids if name.startswith("scene-")]
    assert sections == list(results.scenes)
    assert {f"#scene-{name}" for name in results.scenes} <= set(reader.links)


def test_links_lead_to_places_on_the_page(reader):
    assert {link.removeprefix("#") for link in reader.links} <= set(reader.ids)
    assert len(set(reader.ids)) == len(reader.ids)


def test_nothing_is_loaded_from_elsewhere(reader, page):
    assert reader.loaded == []
    style = re.search(r"<style>(.*?)</style>", page.read_text(encoding="utf-8"), re.DOTALL)
    assert style is not None
    assert "url(" not in style[1]
    assert "@import" not in style[1]


def test_the_page_is_small_enough_to_mail(page):
    # Plotly's script alone is 4.8 MB.
    assert 4.5e6 < page.stat().st_size < 12e6


def test_a_number_that_is_none_is_a_dash_and_its_reason_is_told(reader, truth):
    assert not re.search(r"\b(nan|None|inf)\b", reader.text)
    assert truth.too_short in reader.text
    assert "no wave: still" in reader.text


def test_a_row_of_the_verdicts_says_what_the_table_says(results):
    row = next(row for row in verdicts(results.table) if row.scene == "kick")
    assert (row.speed, row.interval) == ("16.4", "16.1–16.9")
    assert row.paper == Held("8.19", "2.00 (1.96–2.06)", "disagree")
    # The interval of the rod's own constants is 2 %, which adds to 2 and 3 % in quadrature.
    assert row.rod == Held("16.4", "1.00 (0.97–1.04)", "agree")
    assert row.kind == "model spread, 3 fits"
    assert row.half_kick_change == "0.40\u00a0%"
    nothing = next(row for row in verdicts(results.table) if row.scene == "nothing")
    assert (nothing.speed, nothing.interval, nothing.paper.word) == ("–", "–", "")


def test_a_scene_is_told_from_its_specification(results):
    sentence = scene_sentence(results.scenes["kick"].spec)
    assert "A kick of extension, 0.2 Å/ps along the axis" in sentence
    assert "at 1 and 0.5 times this" in sentence
    assert "10 base pairs" in sentence
    assert "first end free, last end held" in sentence


def test_a_duplex_that_is_not_b_dna_is_told_at_the_top(results):
    system = results.systems["tiny-condensed"]
    left = system.structure.assign_attrs(verdict="not B-DNA: interior rise 4.00 Å outside 3-3.6 Å")
    changed = Results(
        results.config,
        {"tiny-condensed": replace(system, structure=left)},
        results.scenes,
        results.table,
        results.jobs,
        results.folder,
    )
    assert "Its speeds are those of this structure" in Reader(render(changed)).text


def test_versions_and_the_configuration_are_on_the_page(reader):
    assert "openmm 9.9" in reader.text
    assert "mdtraj 1.2.3" in reader.text
    assert "velocity_A_per_ps: 0.2" in reader.text


def test_costs_that_were_not_recorded_are_said_to_be_so(reader):
    assert "time and memory of the jobs were not recorded" in reader.text


def test_costs_are_read_as_snakemake_writes_them(tmp_path):
    header = "s\th:m:s\tmax_rss\tmax_vms\tmax_uss\tmax_pss\tio_in\tio_out\tmean_load\tcpu_time\n"
    for path, line in {
        "simulate/kick.x0.5.tsv": "12.5\t0:00:12\t301.2\t1\t1\t1\t0\t0\t99\t12.1\n",
        "simulate/stale.x1.tsv": "99\t0:01:39\t1\t1\t1\t1\t0\t0\t99\t99\n",
        "analyse/kick.tsv": "0.2\t0:00:00\t-\t-\t-\t-\t-\t-\t-\tNA\n",
        "compare.tsv": "2\t0:00:02\t50\t1\t1\t1\t0\t0\t99\t1.5\n",
        "report.tsv": "9\t0:00:09\t50\t1\t1\t1\t0\t0\t99\t9\n",
    }.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(header + line)
    found = [
        (job.rule, job.target, job.run, job.wall_s, job.cpu_s, job.memory_MB)
        for job in read_jobs(tmp_path, ["kick"])
    ]
    # What another configuration left behind is not this one's cost, nor is an earlier report.
    assert found == [
        ("analyse", "kick", "", 0.2, None, None),
        ("simulate", "kick", "x0.5", 12.5, 12.1, 301.2),
        ("compare", "", "", 2.0, 1.5, 50.0),
    ]


def test_costs_are_summed_by_rule_and_shown(config, results, tmp_path):
    (tmp_path / "simulate").mkdir()
    for run, seconds in (("x1", 100.0), ("x0.5", 20.0)):
        (tmp_path / f"simulate/kick.{run}.tsv").write_text(
            f"s\tmax_rss\tcpu_time\n{seconds}\t300\t{seconds}\n"
        )
    jobs = read_jobs(tmp_path, list(results.scenes))
    text = Reader(render(replace(results, jobs=jobs))).text
    assert "2 jobs took 2.00 minutes" in text


def test_a_study_s_job_is_none_of_the_scene_of_the_same_name(tmp_path):
    for rule in ("simulate", "accuracy/truth"):
        (tmp_path / rule).mkdir(parents=True)
        (tmp_path / rule / "kick.tsv").write_text("s\tmax_rss\tcpu_time\n1\t300\t1\n")
    assert [job.rule for job in read_jobs(tmp_path, ["kick"])] == ["simulate"]


def test_missing_results_are_refused_by_name(config, tmp_path):
    with pytest.raises(InputError, match=r"comparison\.csv: not found"):
        gather(config, tmp_path)
    with pytest.raises(InputError, match="run the workflow first"):
        report_step(config, tmp_path, tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_a_scene_without_rows_is_refused_by_name(config, tmp_path):
    more = config.with_name("more.yaml")
    more.write_text(
        config.read_text() + "  extra: {duplex: tiny, environment: condensed, "
        "excitation: {kind: none}}\n"
    )
    with pytest.raises(InputError, match="found no rows of extra"):
        gather(more, config.parent / "results")
