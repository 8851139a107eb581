"""What the rounding of coordinates by a file format costs."""

from __future__ import annotations

from MDAnalysis.coordinates.base import ProtoReader
from MDAnalysis.coordinates.chain import ChainReader
from MDAnalysis.lib.formats.libmdaxdr import XTCFile

# Decimal places that the formats prescribe, in Å. XTC chooses, 0.01 Å by default.
_LAST_PLACE_A = {
    "PDB": 0.001,
    "ENT": 0.001,
    "XPDB": 0.001,
    "PDBQT": 0.001,
    "MMCIF": 0.001,
    "TRJ": 0.001,
    "GRO": 0.01,
}
# Largest error of an angle for coordinates rounded to a last place, in fibre B-DNA of 2000
# orientations; the root of the mean square is a third of it.
_DEGREES_PER_A = 30.0


def coordinate_precision(trajectory: ProtoReader) -> dict[str, str]:
    """Return a note for the attributes of a result where coordinates were rounded, else nothing."""
    parts = trajectory.readers if isinstance(trajectory, ChainReader) else [trajectory]
    last_place_A = max(_last_place_A(part) for part in parts)
    if not last_place_A:
        return {}
    return {
        "coordinate_precision": f"coordinates are rounded to {last_place_A:g} Å in the file: angles"
        f" are off by up to {_DEGREES_PER_A * last_place_A:.1g} degrees"
    }


def _last_place_A(part: ProtoReader) -> float:
    formats = [part.format] if isinstance(part.format, str) else part.format
    if "XTC" in formats:
        with XTCFile(part.filename) as file:
            return float(10 / file.read().prec)
    return max(_LAST_PLACE_A.get(name.upper(), 0.0) for name in formats)
