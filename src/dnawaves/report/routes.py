"""Do the routes to one number agree: speeds with each other, constants with each other?"""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from dnawaves.comparison.agreement import Agreement, agreement
from dnawaves.comparison.compare import ONE
from dnawaves.comparison.predictions import constant, long_wave_routes
from dnawaves.report.answers import CONSTANTS, HOW, WAVES, implied_constant, joint_constant, lead
from dnawaves.report.gather import Results, SystemResults
from dnawaves.report.numbers import BLANK, band, between, counted, digits
from dnawaves.report.tables import Table
from dnawaves.rod.rod import EXTENSION, TWIST, Rod
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.record import AXIAL_WAVES

# A system with fewer estimates of a wave has nothing that could agree.
FEWEST_ROUTES = 3
COUPLING = ("twist-stretch coupling, pN nm", "twist_stretch_coupling_pN_nm")


@dataclass(frozen=True)
class WaveRoutes:
    """What one wave does in one system, in words, and whether its routes agree."""

    wave: str
    system: str
    sentence: str
    agreement: Agreement | None


def wave_routes(results: Results) -> list[WaveRoutes]:
    """Return one entry for each wave and system with routes enough to compare."""
    single = results.table[results.table["scope"] == ONE]
    found = []
    for wave in WAVES:
        for (system, _), rows in single[single["wave"] == wave].groupby(
            ["system", "wave"], sort=False
        ):
            row = lead(rows)
            if row is None or rows["speed_A_per_ps"].notna().sum() < FEWEST_ROUTES:
                continue
            segments = results.systems[str(system)].segments
            # Where the speed depends on the wavelength, different ones need not agree.
            agreed = agreement(rows, wave, segments) if wave in AXIAL_WAVES else None
            found.append(WaveRoutes(wave, str(system), _sentence(row), agreed))
    return found


def _sentence(row: pd.Series) -> str:
    if row["wave"] not in AXIAL_WAVES and row["estimator"] == "standing wave":
        return (
            f"Its lowest standing wave here ({row['scene']}) oscillates at "
            f"{digits(row['frequency_GHz'])} GHz, the paper's rod in the same shape at "
            f"{digits(row['paper_frequency_GHz'])} GHz. Its speed depends on the wavelength: see "
            "the dispersion."
        )
    interval = between(row["low_A_per_ps"], row["high_A_per_ps"])
    over = f" over {counted(row['variations'], 'fit')}" if row["variations"] > 1 else ""
    spread = f" ({interval}{over})" if interval != BLANK else ""
    how = next(words for name, words in HOW.items() if str(row["estimator"]).startswith(name))
    return (
        f"{digits(row['speed_A_per_ps'])} Å/ps{spread}, {how} ({row['scene']}), "
        f"{digits(row['ratio_to_paper'], 2)} times the paper's {digits(row['paper_A_per_ps'])}."
    )


def constants_table(results: Results, system: SystemResults) -> Table | None:
    """Return the rod's constants: the paper's, by every route without a wave, from the waves.

    Those from the waves are a fit to all scenes together, or what the lowest wave implies.
    """
    constants = system.constants
    if constants.empty:
        return None
    routes = long_wave_routes(constants)
    implied = _implied(results, system)
    stiffness = Rod.paper().stiffness / KJ_PER_MOL_PER_PN_NM
    rows = []
    for label, name, index, wave in _entries(routes, constants):
        found = [constant(constants, route, name) for route in routes]
        together = joint_constant(system.joint, name)
        waves = implied.get(wave, BLANK) if together is None else band(together[1])
        paper = float(stiffness[index])
        shown = [BLANK if one is None else band(one) for one in found]
        rows.append([label, digits(paper), *shown, waves])
    return Table(["constant", "paper", *routes, "waves"], rows)


Entry = tuple[str, str, tuple[int, int], str]


def _entries(routes: list[str], constants: pd.DataFrame) -> list[Entry]:
    """Return label, quantity, place in the stiffness and wave of each line of the table.

    Static loads know the modulus at fixed twist or fixed length, other routes also the one with
    the other free to follow. Long waves of extension meet nearly the first, of twist the second.
    """
    entries: list[Entry] = [
        (label, name, (index, index), wave) for wave, (label, name, index) in CONSTANTS.items()
    ]
    fixed: list[Entry] = [
        (
            "stretch modulus with twist free, pN",
            "stretch_modulus_relaxed_pN",
            (EXTENSION, EXTENSION),
            "",
        ),
        ("twist rigidity at fixed length, pN nm²", "twist_rigidity_pN_nm2", (TWIST, TWIST), ""),
        (*COUPLING, (EXTENSION, TWIST), ""),
    ]
    known = [
        entry
        for entry in fixed
        if any(constant(constants, route, entry[1]) is not None for route in routes)
    ]
    return entries + known


def _implied(results: Results, system: SystemResults) -> dict[str, str]:
    """Return the constants that the waves give, each from the wave that speaks for it."""
    rows = results.single(system.spec.name)
    found = {}
    for wave in AXIAL_WAVES:
        row = lead(rows[rows["wave"] == wave])
        implied = None if row is None else implied_constant(system, row)
        if implied is not None:
            found[wave] = band(implied)
    return found
