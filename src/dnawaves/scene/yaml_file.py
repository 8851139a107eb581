"""YAML files that a user writes: no key twice, and anchors with merge keys to keep them short."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from dnawaves.errors import InputError

MERGE = "tag:yaml.org,2002:merge"


class _UniqueKeys(yaml.SafeLoader):
    """A safe loader that refuses a key given twice instead of dropping the first."""


def _unique_mapping(loader: _UniqueKeys, node: yaml.MappingNode) -> dict[Any, Any]:
    # Before the merge: a key that replaces a merged one is given once.
    own = [key for key, _ in node.value if key.tag != MERGE]
    names = [loader.construct_object(key) for key in own]
    for key_node, name in zip(own, names, strict=True):
        if names.count(name) > 1:
            raise yaml.constructor.ConstructorError(
                None, None, f"key {name!r} is given twice", key_node.start_mark
            )
    mapping: dict[Any, Any] = loader.construct_mapping(node, deep=True)
    return mapping


_UniqueKeys.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _unique_mapping)


def read_yaml(path: Path) -> Any:
    """Return what a YAML file holds; raises `InputError` that names the file and the place."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not a text file in UTF-8: {error}") from None
    try:
        return yaml.load(text, Loader=_UniqueKeys)
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not valid YAML: {error}") from None
