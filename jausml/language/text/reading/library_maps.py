"""Index of the ready maps of the shipped library, without reading them as models."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from jausml.language.model.uris import library_root
from jausml.language.text.reading.imports import library_files

_MAP = re.compile(
    r"^(\w+) \{\n(?:(?!\}).*\n)*?    JAUS (?:\w+\.)*(\w+).*\n(?:(?!\}).*\n)*?    ROS ([\w/]+)",
    re.MULTILINE,
)
_TEXT = ".ros2jaus"


@dataclass(frozen=True, slots=True)
class LibraryMap:
    """A map of the shipped library."""

    name: str
    module: str
    message: str
    type: str


@cache
def library_maps() -> tuple[LibraryMap, ...]:
    """Returns the maps of the library; its texts are looked through at the first call."""
    found = []
    for module, path in library_files().items():
        if path.endswith(_TEXT):
            text = (library_root() / path).read_text(encoding="utf-8")
            found += [LibraryMap(name, module, *ends) for name, *ends in _MAP.findall(text)]
    return tuple(found)
