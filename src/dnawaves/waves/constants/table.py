"""The table of a system's rod constants on disk, and the rod that it says; see `constants`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import pandas as pd

from dnawaves.errors import InputError
from dnawaves.files import whole_file
from dnawaves.rod.rod import AXIAL, BEND_1, BEND_2, EXTENSION, SHEAR_1, SHEAR_2, TWIST, Rod
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.table import CSV_FORMAT

TOPOLOGY, PAPER = "topology", "paper"
# Constants that a rod cannot do without, and where in its stiffness they stand.
PLACES = {
    "stretch_modulus_pN": (EXTENSION,),
    "twist_rigidity_pN_nm2": (TWIST,),
    "bend_rigidity_pN_nm2": (BEND_1, BEND_2),
    "shear_stiffness_pN": (SHEAR_1, SHEAR_2),
}
COUPLING = "twist_stretch_coupling_pN_nm"
MASS = ("spacing_A", "density_Da_per_A", "inertia_axial_Da_A", "inertia_transverse_Da_A")


@dataclass(frozen=True)
class Constant:
    """A constant by one route, the ends of its interval and the interval's method in words."""

    route: str
    quantity: str
    value: float
    low: float | None = None
    high: float | None = None
    interval: str = ""
    source: str = ""


COLUMNS = tuple(field.name for field in fields(Constant))
NUMBERS = ("value", "low", "high")


def write_constants(path: Path, constants: Iterable[Constant]) -> None:
    """Write constants as CSV, whole or not at all."""
    frame = pd.DataFrame([asdict(one) for one in constants], columns=list(COLUMNS))
    with whole_file(path) as temporary:
        frame.to_csv(temporary, index=False, float_format=CSV_FORMAT)


def read_constants(path: Path) -> pd.DataFrame:
    """Read a table of constants; text columns are empty strings where nothing was written."""
    frame = pd.read_csv(path, dtype=str, keep_default_na=False)
    missing = [name for name in COLUMNS if name not in frame]
    if missing:
        raise InputError(f"{path}: found no {', '.join(missing)}; allowed: a table of constants")
    frame[list(NUMBERS)] = frame[list(NUMBERS)].apply(pd.to_numeric)
    return frame


def rod_of(constants: pd.DataFrame, route: str, otherwise: str | None = None) -> Rod:
    """Return the straight, untwisted rod with the stiffness that one route found.

    What the route does not know is taken from the route `otherwise`, a coupling that neither knows
    is zero; density, inertia and spacing are those of the topology, or the paper's own. Raises
    `InputError` for a constant that is missing.
    """
    where = PAPER if route == PAPER else TOPOLOGY
    routes = [route] if otherwise is None else [route, otherwise]
    spacing, density, axial, transverse = (_value(constants, [where], name) for name in MASS)
    diagonal = np.zeros(6)
    for name, places in PLACES.items():
        diagonal[list(places)] = _value(constants, routes, name)
    stiffness = np.diag(diagonal)
    coupling = _value(constants, routes, COUPLING, 0.0)
    stiffness[AXIAL, AXIAL[::-1]] = coupling
    return Rod(
        density_Da_per_nm=A_PER_NM * density,
        inertia_Da_nm=np.diag([transverse, transverse, axial]) / A_PER_NM,
        stiffness=KJ_PER_MOL_PER_PN_NM * stiffness,
        spacing_nm=spacing / A_PER_NM,
    )


def _value(
    constants: pd.DataFrame, routes: list[str], quantity: str, default: float | None = None
) -> float:
    for route in routes:
        chosen = (constants["route"] == route) & (constants["quantity"] == quantity)
        values = constants.loc[chosen, "value"].dropna()
        if len(values):
            return float(values.iloc[0])
    if default is None:
        raise InputError(
            f"constants: found no {quantity} by the route {' or '.join(map(repr, routes))}; "
            f"routes: {', '.join(map(repr, constants['route'].unique()))}"
        )
    return default
