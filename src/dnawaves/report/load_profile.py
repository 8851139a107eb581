"""A static load: how far each base pair is displaced, against a uniform rod."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
import xarray as xr

from dnawaves.report.style import INK, MEASURED_LINE, PAPER_LINE, blank_figure, readable_unit
from dnawaves.rod.rod import EXTENSION, TWIST, Rod
from dnawaves.units import A_PER_NM, PN_PER_KJ_PER_MOL_NM


def paper_strain_per_A(wave: str, load: float) -> float:
    """Return the strain of the paper's rod under a load in pN (extension) or pN nm (twist).

    In Å/Å or rad/Å.
    """
    stiffness = Rod.paper().stiffness * PN_PER_KJ_PER_MOL_NM
    if wave == "extension":
        return load / float(stiffness[EXTENSION, EXTENSION])
    return load / float(stiffness[TWIST, TWIST]) / A_PER_NM


def load_figure(displacement: xr.DataArray, wave: str, load: float) -> go.Figure:
    """Return the displacement (pair,) against height, with the uniform rod of the same end.

    Beside them the paper's rod under the same load, in pN or pN nm.
    """
    height = displacement["height"].values - displacement["height"].values[0]
    length = float(height[-1])
    unit = readable_unit(str(displacement.attrs["units"]))
    figure = blank_figure("height along the helix (Å)", f"displacement ({unit})")
    figure.add_scatter(
        x=height,
        y=displacement.values,
        mode="markers",
        marker={"color": INK, "size": 7},
        name="simulation",
    )
    for name, end, line in (
        ("uniform rod, same end", float(displacement.values[-1]), MEASURED_LINE),
        ("paper's rod, same load", length * paper_strain_per_A(wave, load), PAPER_LINE),
    ):
        figure.add_scatter(x=np.array([0, length]), y=[0, end], mode="lines", line=line, name=name)
    return figure
