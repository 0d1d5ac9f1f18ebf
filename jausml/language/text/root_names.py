"""Default root names, derived from the file name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.language.model.words import snake_case, words

if TYPE_CHECKING:
    from pathlib import Path

_NO_FILE = "model"


def system_name(path: Path) -> str:
    """Returns the name of the implicit system, map library or service set of a file."""
    name = path.stem
    return name if re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name) else _valid(name)


def service_name(path: Path) -> str:
    """Returns the name of the service of the messages that a file declares: `DemoBridge`."""
    return "".join(word.capitalize() for word in words(system_name(path)))


def package_name(path: Path) -> str:
    """Returns the name of the package of the ROS types that a file declares."""
    return f"{system_name(path)}_interfaces"


def _valid(name: str) -> str:
    found = snake_case(name) or _NO_FILE
    return found if found[0].isalpha() else f"{_NO_FILE}_{found}"
