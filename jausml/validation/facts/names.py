"""Names in generated code: identifiers, package names, and what is taken already."""

from __future__ import annotations

import keyword
import re
import sys

_IDENTIFIER = re.compile("[A-Za-z][A-Za-z0-9_]*")
_WORD_START = re.compile("(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")
_NOT_NAME = re.compile("[^A-Za-z0-9]+")
_LONGEST = 60
_DEVICES = frozenset(
    {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}
)
_TOOLING = frozenset(
    {
        *("ament_index_python", "builtins", "build", "install", "jausml", "jausml_runtime"),
        *("launch", "launch_ros", "log", "rcl_interfaces", "rclpy", "resource", "rosgraph_msgs"),
        *("rosidl_runtime_py", "rpyutils", "setup", "setuptools", "site", "src", "test", "tests"),
        *(
            "action_msgs",
            "diagnostic_updater",
            "service_msgs",
            "tf2_ros",
            "type_description_interfaces",
        ),
    }
)


def is_identifier(name: str) -> bool:
    """Tells whether a name is of letters, digits and underscores and starts with a letter."""
    return _IDENTIFIER.fullmatch(name) is not None


def snake_case(name: str) -> str:
    """Returns a name as it becomes an attribute or a module, to find names that collide.

    Args:
        name: Any text, e.g. `Velocity_X`; the result is empty when it has no letter or digit.
    """
    parts = (part for part in _NOT_NAME.split(name) if part)
    words = (word.lower() for part in parts for word in _WORD_START.split(part))
    return "_".join(words)[:_LONGEST].rstrip("_")


def package_key(name: str) -> str:
    """Returns what the names of two packages must not have in common.

    Generated packages whose name is taken get the ending _jaus.

    Args:
        name: Name of a component, bridge or node.
    """
    return snake_case(name).removesuffix("_jaus")


def taken(name: str) -> str:
    """Says what a package name is taken by already, or returns an empty string."""
    if keyword.iskeyword(name) or name in keyword.softkwlist:
        return "is a Python keyword"
    if name in sys.stdlib_module_names:
        return "is a module of Python's standard library"
    if name in _TOOLING:
        return "is a package that generated code or its build needs"
    if name in _DEVICES:
        return "is a device name on Windows"
    return ""
