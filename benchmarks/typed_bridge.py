"""A generated bridge whose translations run on the message classes of ROS.

Usage: typed_bridge.py PACKAGE [options of the bridge]

Each translation is overridden by its own text, in which the names of light classes mean those of
ROS: overrides may ask for them.
"""

from __future__ import annotations

import importlib
import sys
from types import FunctionType
from typing import Any

from ends import message_class


def typed(base: type[Any], mark: Any) -> type[Any]:
    """Returns a bridge class whose translations use the classes of ROS.

    Args:
        base: The bridge as generated.
        mark: The decorator that asks for them.
    """
    names = [name for name in dir(base) if name.startswith("translate_")]
    overrides = {name: mark(_rebound(getattr(base, name))) for name in names}
    return type(f"Typed{base.__name__}", (base,), overrides)


def _rebound(method: Any) -> FunctionType:
    known = method.__globals__
    replaced = {
        name: message_class(value.TYPE)
        for name, value in known.items()
        if isinstance(value, type) and isinstance(getattr(value, "TYPE", None), str)
    }
    return FunctionType(method.__code__, {**known, **replaced}, method.__name__)


def bridge_class(package: str) -> type[Any]:
    """Returns the class of a generated bridge."""
    name = "".join(part.title() for part in package.split("_"))
    found: type[Any] = getattr(importlib.import_module(f"{package}.{package}"), name)
    return found


def main() -> int:
    """Runs the bridge."""
    package, *arguments = sys.argv[1:]
    base = bridge_class(package)
    mark = importlib.import_module("jausml_runtime.bridge.connections.translations").ros_classes
    run: Any = importlib.import_module("jausml_runtime").run_bridge
    return int(run(typed(base, mark)(), arguments))


if __name__ == "__main__":
    sys.exit(main())
