"""The relaxed duplex: profiles of its step parameters and the checks that it is B-DNA."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
import xarray as xr

from dnawaves.motion.interior import interior
from dnawaves.motion.structure import RISE_RANGE_A, TWIST_RANGE_DEG
from dnawaves.report.gather import SystemResults
from dnawaves.report.numbers import BLANK, digits
from dnawaves.report.style import (
    BAND,
    INK,
    MEASURED_COLOUR,
    MEASURED_LINE,
    blank_figure,
    readable_unit,
)
from dnawaves.report.tables import Table

STEP_PARAMETERS = ("shift", "slide", "rise", "tilt", "roll", "twist")
B_FORM: Mapping[str, tuple[float, float]] = {"rise": RISE_RANGE_A, "twist": TWIST_RANGE_DEG}


def step_profile(structure: xr.Dataset, name: str) -> go.Figure:
    """Return one step parameter (step,) along the duplex, with the mean of its interior.

    Rise and twist lie over the band that their interior mean must be in.
    """
    values = structure[name].values
    steps = np.arange(1, len(values) + 1)
    unit = readable_unit(str(structure[name].attrs["units"]))
    figure = blank_figure("step", f"{name} ({unit})", 260)
    if name in B_FORM:
        low, high = B_FORM[name]
        figure.add_hrect(y0=low, y1=high, fillcolor=BAND, line_width=0, layer="below")
    figure.add_scatter(
        x=steps,
        y=values,
        mode="lines+markers",
        line={"color": INK, "width": 1},
        marker={"color": INK, "size": 5},
        text=structure["step_sequence"].values,
        hovertemplate="step %{x}, %{text}: %{y:.2f}<extra></extra>",
    )
    inside = interior(len(values))
    mean = float(np.nanmean(values[inside]))
    figure.add_scatter(
        x=steps[inside][[0, -1]], y=[mean, mean], mode="lines", line=MEASURED_LINE, hoverinfo="skip"
    )
    figure.add_annotation(
        x=0,
        y=1,
        xref="paper",
        yref="paper",
        xanchor="left",
        yanchor="bottom",
        showarrow=False,
        text=f"interior mean {mean:.2f} {unit}",
        font={"color": MEASURED_COLOUR, "size": 12},
    )
    return figure


def structure_table(systems: Sequence[SystemResults]) -> Table:
    """Return what was found of each relaxed duplex, one column for each."""
    columns = [_findings(system) for system in systems]
    names = dict.fromkeys(name for column in columns for name in column)
    return Table(
        ["", *(system.spec.name for system in systems)],
        [[name, *(column.get(name, BLANK) for column in columns)] for name in names],
    )


def _range(structure: xr.Dataset, name: str) -> str:
    """Return the smallest and the largest step: a kink hides in a mean."""
    values = structure[name].values[interior(structure.sizes["step"])]
    return f"{digits(np.nanmin(values))} to {digits(np.nanmax(values))}"


def _findings(system: SystemResults) -> dict[str, str]:
    found = system.structure.attrs
    rise, twist = ("{:g} to {:g} is B-DNA".format(*B_FORM[name]) for name in ("rise", "twist"))
    return {
        "Verdict": str(found["verdict"]),
        f"Interior rise, Å ({rise})": digits(found["interior_rise_A"]),
        f"Interior twist, ° ({twist})": digits(found["interior_twist_deg"]),
        "Interior roll, °": digits(found["interior_roll_deg"]),
        **{
            f"{name.capitalize()} of single interior steps, {unit}": _range(system.structure, name)
            for name, unit in (("rise", "Å"), ("twist", "°"), ("roll", "°"))
        },
        "RMSD to the built duplex, heavy atoms, Å": digits(found["rmsd_to_built_A"]),
        "Watson-Crick hydrogen bonds": str(int(system.structure["hydrogen_bonds"].sum())),
        "Base pairs that are lost": str(found["lost_pairs"]) or "none",
        **(_equilibration(system.start) if system.spec.thermal else _minimum(system.start)),
    }


def _minimum(start: Mapping[str, Any]) -> dict[str, str]:
    return {
        "Energy, kJ/mol": digits(start["energy_kJ_per_mol"], 6),
        "Root-mean-square force, kJ/mol/nm": digits(start["rms_force_kJ_per_mol_nm"]),
        "Negative modes of the Hessian": str(start["negative_modes"]),
        "First estimate of extension, Å/ps": digits(start["first_estimate_extension_A_per_ps"]),
        "First estimate of twist, Å/ps": digits(start["first_estimate_twist_A_per_ps"]),
    }


CHECKS = {
    "Temperature": "temperature_K_verdict",
    "Potential energy": "potential_energy_kJ_per_mol_verdict",
    "End-to-end distance": "end_to_end_nm_verdict",
    "Warning": "warning",
}


def _equilibration(start: Mapping[str, Any]) -> dict[str, str]:
    """Return the checks of the equilibration."""
    mean, error = (start[f"temperature_K_mean{end}"] for end in ("", "_standard_error"))
    return {
        "Mean temperature, K": f"{digits(mean)} ± {digits(error, 2)}",
        **{name: str(start[key]) for name, key in CHECKS.items() if start.get(key)},
        "First estimate of extension, Å/ps": digits(start["first_estimate_extension_A_per_ps"]),
        "First estimate of twist, Å/ps": digits(start["first_estimate_twist_A_per_ps"]),
    }
