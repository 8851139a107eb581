"""Duplexes by name: a sequence, or a user's own structure file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from dnawaves.errors import InputError
from dnawaves.scene.model import NAME
from dnawaves.scene.models import NamedDuplex
from dnawaves.scene.sequence import check_sequence
from dnawaves.scene.structure_file import digest_of_file, sequence_of_file
from dnawaves.scene.yaml_file import read_yaml


def load_duplexes(path: Path) -> dict[str, NamedDuplex]:
    """Return the duplexes of a structures file by name.

    An entry is a sequence, strand I from 5' to 3', or `{file: duplex.pdb}`, relative to this file.
    """
    raw = read_yaml(path)
    if not isinstance(raw, Mapping) or not raw:
        raise InputError(f"{path}: found {raw!r}; allowed: a mapping of names to sequences")
    return {str(name): _duplex(path, str(name), entry) for name, entry in raw.items()}


def _duplex(path: Path, name: str, entry: object) -> NamedDuplex:
    where = f"{path}: duplex '{name}'"
    if not re.fullmatch(NAME, name):
        raise InputError(
            f"{where}: found {name!r}; allowed: a letter first, then letters, digits and _"
        )
    if isinstance(entry, str):
        try:
            check_sequence(entry)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        return NamedDuplex(name=name, sequence=entry)
    if (
        not isinstance(entry, Mapping)
        or set(entry) != {"file"}
        or not isinstance(entry["file"], str)
    ):
        raise InputError(
            f"{where}: found {entry!r}; allowed: a sequence, such as CGCG, or a structure file of "
            "your own, {file: duplex.pdb}"
        )
    file = path.parent / entry["file"]
    if not file.is_file():
        raise InputError(
            f"{where}: file: found {entry['file']!r}; allowed: a PDB or mmCIF file, relative to "
            f"this one (there is none at {file})"
        )
    try:
        sequence = sequence_of_file(file)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return NamedDuplex(name=name, sequence=sequence, file=str(file), digest=digest_of_file(file))
