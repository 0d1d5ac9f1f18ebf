"""Names: their words, what generated code makes of them, and those that a file implies."""

from __future__ import annotations

import keyword
import re
import sys
from functools import lru_cache
from pathlib import Path

LONGEST = 60
"""Characters to which names of generated code are cut."""

_WORD_START = re.compile("(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")
_QOS = re.compile(r"^[Qq]o ?S\b")
_NOT_NAME = re.compile("[^A-Za-z0-9]+")


def parts(name: str) -> list[str]:
    """Returns the words between characters that no name can have."""
    return [part for part in _NOT_NAME.split(name) if part]


def joined(name: str) -> str:
    """Returns a name without characters that no name can have."""
    return _NOT_NAME.sub("", name)


def words(name: str) -> list[str]:
    """Returns the words of a name: at capitals, digits stay with the word before them."""
    return [word for part in parts(name) for word in _WORD_START.split(part) if word]


@lru_cache(maxsize=1 << 16)
def snake_case(name: str) -> str:
    """Returns the words in small letters, joined by underscores; empty without any word."""
    return "_".join(words(name)).lower()[:LONGEST].rstrip("_")


def in_words(name: str) -> str:
    """Returns a name of the metamodels as words: `silenceTimeout` becomes `silence timeout`."""
    said = " ".join(word if word.isupper() else word.lower() for word in words(name))
    return _QOS.sub("QoS", said)


_IDENTIFIER = re.compile("[A-Za-z][A-Za-z0-9_]*")
_URN = re.compile(r"urn:[A-Za-z0-9][A-Za-z0-9-]{1,31}:[A-Za-z0-9().,:=@;$_!*'%/+&~-]+")
_LONGEST_URN = 255
DEVICES = frozenset(
    {
        "con",
        "prn",
        "aux",
        "nul",
        *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)),
    }
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
    """Returns the part of a package name by which two packages must differ.

    Generated packages whose name is taken get the ending _jaus.
    """
    return snake_case(name).removesuffix("_jaus")


def taken(name: str) -> str:
    """Returns the present holder of a package name, or an empty string."""
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
    """Returns why a text cannot be the URN of a service (RFC 8141; AS5710), empty if it can."""
    if len(urn) > _LONGEST_URN:
        return f"is longer than {_LONGEST_URN} characters"
    return "" if _URN.fullmatch(urn) else "is no URN"


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
    file_name = snake_case(name) or _NO_FILE
    return file_name if file_name[0].isalpha() else f"{_NO_FILE}_{file_name}"
