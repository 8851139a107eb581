"""The harmonic reference in the report: constants, segments, twins."""

from __future__ import annotations

import numpy as np
import pytest

from dnawaves.report.gather import Results
from dnawaves.report.molecule import (
    segments_figure,
    structure_factor_figure,
    twins_table,
)


def test_a_simulated_scene_stands_beside_its_exact_twin(results: Results) -> None:
    table = twins_table(results)
    assert table is not None
    (row,) = table.rows
    assert row[:2] == ["mode1", "extension"]
    assert row[-1] == "4.0\u00a0%"  # the miniature's simulation is 4 % too large


def test_the_figure_holds_segments_and_standing_waves(results: Results) -> None:
    (system,) = results.systems.values()
    assert system.segments is not None
    figure = segments_figure(system.segments, results.table).figure
    traces = {trace.name: trace for trace in figure.data}
    assert list(traces["extension, segments"].y) == [11, 15]
    half_wave = traces["extension, standing waves"].x[0]
    # Mode 1 of a chain whose end pairs are held: half a wave is the distance between them.
    assert half_wave == pytest.approx(9 * 3.3, rel=1e-5)  # tables hold six digits


def test_the_structure_factor_peaks_where_the_chain_carries_its_waves(results: Results) -> None:
    (system,) = results.systems.values()
    assert system.structure_factor is not None
    figure = structure_factor_figure(system.structure_factor, "extension", 3.3).figure
    power, paper = np.asarray(figure.data[0].z), figure.data[1].y
    peaks = np.asarray(figure.data[0].y)[power.argmax(axis=0)]
    # The miniature is twice as fast as the paper's rod; frequencies are 10 GHz apart.
    inside = 2 * np.asarray(paper) < 1400
    np.testing.assert_allclose(peaks[inside], 2 * np.asarray(paper)[inside], atol=10)
