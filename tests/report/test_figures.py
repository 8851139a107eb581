"""Each figure puts the theory where the theory is, and the measurement where it was made."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from dnawaves.report.dispersion import branch_GHz, dispersion_figure, paper_branches_GHz
from dnawaves.report.gather import Results
from dnawaves.report.helical_odd import helical_figure, parameter_of
from dnawaves.report.kymograph import Front, Marks, kymograph, saturation
from dnawaves.report.legend import legend
from dnawaves.report.load_profile import load_figure
from dnawaves.report.resonance import driven_peak, resonance_figure
from dnawaves.report.scene_section import scene_section
from dnawaves.report.speeds import speeds_figure
from dnawaves.report.standing_wave import projection_figure
from dnawaves.report.structure import step_profile
from dnawaves.report.style import at_most
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps

# Figures hold their numbers in single precision.
SINGLE = 1e-6


def trace(figure: Any, start: str) -> Any:
    """Return the one trace whose name starts so."""
    (found,) = [one for one in figure.data if (one.name or "").startswith(start)]
    return found


def figure_of(results: Results, scene: str, title: str) -> Any:
    """Return the figure of a scene whose title starts so."""
    shown = scene_section(results.scenes[scene]).illustrations
    (found,) = [one.figure for one in shown if one.title.startswith(title)]
    return found


def test_a_front_starts_at_the_source_and_its_slope_is_the_papers_speed(results, truth):
    line = trace(figure_of(results, "kick", "Simulation"), "paper")
    slope = (line.y[1] - line.y[0]) / (line.x[1] - line.x[0])
    assert slope == pytest.approx(truth.paper_A_per_ps, rel=SINGLE)
    # Three base pairs from the free end on are kicked: their middle is the second.
    assert (line.x[0], line.y[0]) == (0, pytest.approx(truth.spacing_A))


def test_the_measured_front_runs_at_the_measured_speed(results, truth):
    line = trace(figure_of(results, "kick", "Simulation"), "waveform")
    slope = (line.y[1] - line.y[0]) / (line.x[1] - line.x[0])
    # Five digits or six are what the table of speeds holds.
    assert slope == pytest.approx(truth.speed_A_per_ps, rel=1e-5)


def test_a_front_lies_on_the_wave_of_a_rod_of_its_speed(results, truth):
    """Half way up, the paper's own kymograph first moves near the time of the paper's line."""
    field = results.scenes["kick"].waves["extension_paper"]
    pair = truth.pairs // 2
    speed = np.abs(field.values[:, pair])
    arrived = float(field["time"].values[np.argmax(speed > 0.663 * speed.max())])
    expected = (pair - 1) * truth.spacing_A / truth.paper_A_per_ps
    # A kick of three base pairs is two spacings wide: the front is as uncertain as half of that.
    assert arrived == pytest.approx(expected, abs=truth.spacing_A / truth.paper_A_per_ps)


def test_heights_start_at_zero_and_colours_are_symmetric(results, truth):
    heat = figure_of(results, "kick", "Simulation").data[0]
    assert heat.zmin == -heat.zmax
    assert heat.y[0] == 0
    assert heat.y[-1] == pytest.approx(truth.length_A, rel=SINGLE)
    assert np.asarray(heat.z).shape == (truth.pairs, len(heat.x))


def test_both_kymographs_of_a_scene_have_the_same_colours(results):
    simulated = figure_of(results, "kick", "Simulation").data[0]
    paper = figure_of(results, "kick", "The paper's rod").data[0]
    assert simulated.zmax == paper.zmax


def test_the_end_of_the_usable_window_is_marked_only_where_it_cuts(results):
    assert trace(figure_of(results, "spoilt", "Simulation"), "end of the usable").x[0] == (
        # Third of three usable frames, 0.05 ps apart.
        pytest.approx(0.10)
    )
    names = [one.name for one in figure_of(results, "kick", "Simulation").data]
    assert "end of the usable window" not in names


def test_a_standing_wave_is_marked_at_a_quarter_of_its_period(results, truth):
    figure = figure_of(results, "mode1", "Simulation")
    for name, frequency in (("fit", truth.mode_GHz), ("paper", truth.paper_mode_GHz)):
        line = trace(figure, f"a quarter period, {name}")
        # Six digits are what the table of speeds holds.
        assert line.x[0] == pytest.approx(1e3 / frequency / 4, rel=1e-5)


def test_the_spectrum_lies_under_the_papers_lattice_branch(results, truth):
    figure = figure_of(results, "kick", "Frequency against")
    line = trace(figure, "paper")
    a, v = truth.spacing_A, truth.paper_A_per_ps
    expected = 1e3 * v / (np.pi * a) * np.sin(np.asarray(line.x) * a / 2)
    assert line.y == pytest.approx(expected, rel=1e-9)


def test_the_spectrum_of_a_uniform_rod_has_its_ridge_on_its_own_branch(results):
    """Of each of the lowest modes, the strongest frequency is near the measured branch."""
    figure = figure_of(results, "kick", "Frequency against")
    heat, line = figure.data[0], trace(figure, "rod at")
    strongest = heat.y[np.argmax(np.asarray(heat.z), axis=0)]
    resolution = results.scenes["kick"].waves["extension_power"].attrs["resolution_GHz"]
    assert strongest[:4] == pytest.approx(line.y[:4], abs=resolution)


def test_long_waves_of_the_papers_branches_have_the_papers_speeds(truth):
    k = np.array([1e-4])
    branches = paper_branches_GHz(k, truth.spacing_A)
    speeds = short_wave_speeds_A_per_ps(Rod.paper())
    for wave in ("extension", "twist"):
        assert 2e-3 * np.pi * branches[wave][0] / k[0] == pytest.approx(speeds[wave], rel=1e-6)
    # The upper branch starts at the cut-off, sqrt(C/I) of the paper's constants, 0.2265 THz.
    assert branches["shear"][0] == pytest.approx(226.5, abs=0.1)


def test_the_solid_branch_passes_through_the_lowest_measured_mode(results, truth):
    figure = dispersion_figure(results.table, truth.spacing_A)
    row = results.scenes["mode1"].row("standing wave")
    line = trace(figure, "extension, rod at")
    at_mode = np.interp(row["wavenumber_rad_per_A"], line.x, line.y)
    # Straight pieces between 80 points of the branch.
    assert at_mode == pytest.approx(truth.mode_GHz, rel=1e-3)
    expected = branch_GHz(truth.speed_A_per_ps, line.x, truth.spacing_A)
    assert line.y == pytest.approx(expected, rel=1e-5)


def test_the_fitted_oscillation_passes_through_the_projection(results, truth):
    figure = figure_of(results, "mode1", "The standing wave")
    points, fit = trace(figure, "simulation"), trace(figure, "fit")
    # The projection is the model itself; frequency and friction come from a table of six digits.
    assert fit.y == pytest.approx(points.y, abs=1e-4)


def test_the_fit_is_drawn_over_its_window_only(results, truth):
    projection = results.scenes["mode1"].waves["projection"]
    figure = projection_figure(projection, 2.0, truth.mode_GHz, 0.1, truth.paper_mode_GHz)
    assert max(trace(figure, "fit").x) == pytest.approx(2.0)
    assert max(trace(figure, "paper's rod").x) == pytest.approx(5.0)


def test_the_resonance_curve_passes_through_the_oscillators_own_peaks(truth):
    times, drives = np.linspace(0, 10, 401), np.array([60.0, 100.0, 140.0, 180.0])
    response = 0.7 * driven_peak(times, truth.mode_GHz, 0.1, drives)
    figure = resonance_figure(
        drives, response, "angstrom/ps", times, (truth.mode_GHz, 0.1), truth.paper_mode_GHz
    )
    curve = trace(figure, "fitted mode")
    # Straight pieces between 80 points of a curve that has kinks where another peak leads.
    assert np.interp(drives, curve.x, curve.y) == pytest.approx(response, rel=0.01)
    assert trace(figure, "fitted f₁").x[0] == pytest.approx(truth.mode_GHz)
    assert trace(figure, "paper's f₁").x[0] == pytest.approx(truth.paper_mode_GHz)


def test_the_resonance_curve_knows_the_ramp_of_the_drives(truth):
    times, drives = np.linspace(0, 10, 401), np.array([60.0, 100.0, 140.0, 180.0])
    response = 0.7 * driven_peak(times, truth.mode_GHz, 0.1, drives, ramp_periods=1.0)
    figure = resonance_figure(
        drives, response, "rad/ps", times, (truth.mode_GHz, 0.1), truth.paper_mode_GHz, 1.0
    )
    curve = trace(figure, "fitted mode")
    # As above; the ramp itself changes the peaks by far more.
    assert np.interp(drives, curve.x, curve.y) == pytest.approx(response, rel=0.01)
    sudden = 0.7 * driven_peak(times, truth.mode_GHz, 0.1, drives)
    assert np.abs(sudden / response - 1).max() > 0.05


def test_the_papers_rod_yields_to_a_load_by_its_own_stiffness(results, truth):
    figure = figure_of(results, "load", "Displacement")
    paper = trace(figure, "paper's rod")
    # C3 = 2160 pN.
    assert paper.y[1] == pytest.approx(truth.load_pN / 2160 * truth.length_A, rel=1e-6)
    assert trace(figure, "uniform rod").y[1] == pytest.approx(0.4)


def test_the_papers_rod_turns_under_a_torque_by_its_own_stiffness(results, truth):
    displacement = results.scenes["load"].waves["extension_displacement"].isel(time=0)
    figure = load_figure(displacement.assign_attrs(units="rad"), "twist", 20.0)
    # D3 = 206 pN nm², over the length in nm.
    expected = 20.0 / 206 * truth.length_A / 10
    assert trace(figure, "paper's rod").y[1] == pytest.approx(expected, rel=1e-6)


def test_what_does_not_depend_on_the_excitation_cancels_in_the_helical_parameters(results):
    odd = results.scenes["kick"].odd_helical
    assert parameter_of(odd, "extension") == "rise"
    heat = helical_figure(odd, "rise").data[0]
    # The even 3.3 Å is gone, the wave of 0.02 Å left; single precision of 3.3.
    assert np.asarray(heat.z)[0] == pytest.approx(0.02 * np.sin(heat.x), abs=1e-6)


def test_frayed_ends_are_no_part_of_the_interior_mean(results):
    structure = results.systems["tiny-condensed"].structure
    figure = step_profile(structure, "rise")
    assert figure.data[1].y[0] == pytest.approx(3.3)
    band = figure.layout.shapes[0]
    assert (band.y0, band.y1) == (3.0, 3.6)


def test_standing_bends_have_no_place_among_the_speeds(results):
    figure = speeds_figure(results.table)
    assert {one.name for one in figure.data} == {"extension", "paper"}


def test_a_long_record_is_averaged_and_a_short_one_left_alone(results, truth):
    field = results.scenes["kick"].waves["extension_velocity"]
    assert at_most(field, "time", 1000) is field
    short = at_most(field, "time", 40)
    assert short.sizes["time"] <= 40
    assert short.values[0] == pytest.approx(field.values[:3].mean(axis=0))


def test_the_legend_names_every_line_once(results, truth):
    field = results.scenes["kick"].waves["extension_velocity"]
    marks = Marks([Front("slow", 8.0, "paper"), Front("fast", 16.0, "measured")])
    figure = kymograph(field, "angstrom/ps", saturation(field), marks)
    assert [(key.name, bool(key.dash)) for key in legend(figure)] == [
        ("slow", True),
        ("fast", False),
    ]
