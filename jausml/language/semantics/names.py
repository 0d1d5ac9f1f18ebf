"""Names in generated code: identifiers, package names, and what is taken already."""

from __future__ import annotations

import keyword
import re
import sys

from jausml.language.model.words import snake_case

_IDENTIFIER = re.compile("[A-Za-z][A-Za-z0-9_]*")
_URN = re.compile(r"urn:[A-Za-z0-9][A-Za-z0-9-]{1,31}:[A-Za-z0-9().,:=@;$_!*'%/+&~-]+")
_LONGEST_URN = 255
DEVICES = frozenset(
    {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}
)
# Interface packages of ROS are not among them: a model of one has its name.
_TOOLING = frozenset(
    {
        *("ament_index_python", "builtins", "build", "install", "jausml", "jausml_runtime"),
        *("launch", "launch_ros", "log", "rclpy", "resource", "rosidl_runtime_py", "rpyutils"),
        *("setup", "setuptools", "site", "src", "test", "tests", "diagnostic_updater", "tf2_ros"),
    }
)


def is_identifier(name: str) -> bool:
    """Tells whether a name is of letters, digits and underscores and starts with a letter."""
    return _IDENTIFIER.fullmatch(name) is not None


def package_key(name: str) -> str:
    """Returns what the names of two packages must not have in common.

    Generated packages whose name is taken get the ending _jaus.
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
    if name in DEVICES:
        return "is a device name on Windows"
    return ""


def urn_fault(urn: str) -> str:
    """Says why a text cannot be the URN of a service (RFC 8141; AS5710), empty if it can."""
    if len(urn) > _LONGEST_URN:
        return f"is longer than {_LONGEST_URN} characters"
    return "" if _URN.fullmatch(urn) else "is no URN"
