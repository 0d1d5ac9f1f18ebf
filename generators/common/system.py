"""The system that a model describes, as targets need it."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

from jausml.model.model import Model


def system_of(model: Model) -> Any:
    """Returns the `system.System` of a valid model."""
    return model.instances("system.System")[0]


def source_of(model: Model) -> str:
    """Returns the name of the file that holds the system: no path, so output is the same anywhere."""
    return PurePath(model.location(system_of(model)).path).name


def component_kind(element: Any) -> str:
    """Returns `bridge` for a bridge, which is a component too, and else `component`."""
    return "bridge" if element.eClass.name == "Bridge" else "component"
