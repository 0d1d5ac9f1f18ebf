"""Rules of the ROS importer, as data for `jausml rules` and `jausml explain`."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Severity
from jausml.language.model.rules import RuleInfo

if TYPE_CHECKING:
    from collections.abc import Mapping

_RULES = {
    "JML641": RuleInfo(
        "illegal name of a package or an interface",
        "An interface is named by its file, in CamelCase (WheelSpeeds.msg), and its package by "
        "package.xml or the folder, in lower case with single underscores (winch_msgs).",
    ),
    "JML642": RuleInfo(
        "text that no model can hold",
        "A definition is UTF-8 text without control characters.",
    ),
    "JML643": RuleInfo(
        "neither field nor constant",
        "A line of a definition is a field, `float64 x` or `float64 x 1.5` with a default, or a "
        "constant, `uint8 OK=0`, and perhaps a comment behind #.",
    ),
    "JML644": RuleInfo(
        "no such type",
        "A field is of a primitive type (bool, byte, char, float32, float64, int8 to uint64, "
        "string, wstring), of a string with a bound (string<=10) or of a message type (Point, "
        "geometry_msgs/Point); as an array it ends with [N], [<=N] or []. A constant is of a "
        "primitive type without bounds.",
    ),
    "JML645": RuleInfo(
        "illegal name in a definition",
        "Fields are named in lower case with single underscores, constants in upper case.",
    ),
    "JML646": RuleInfo(
        "impossible value in a definition",
        "A default or a constant is a value of its type: in its range, not longer than its bound, "
        "with as many elements as the array has. Only primitive types have defaults.",
    ),
    "JML647": RuleInfo(
        "declared twice in ROS interfaces",
        "Fields and constants of a definition have names of their own, and a package has one "
        "message, service and action of a name.",
    ),
    "JML648": RuleInfo(
        "message type not found",
        "A field is of a message type that neither the packages to import, nor the shipped "
        "library, nor the installed packages have. Give the importer the package as well, or the "
        "share folder that it is installed in.",
    ),
    "JML649": RuleInfo(
        "wrong number of sections",
        "A message has one section, a service two (request, response), an action three (goal, "
        "result, feedback), separated by lines of three hyphens.",
    ),
    "JML650": RuleInfo(
        "message type contains itself",
        "A message that holds itself has no end; not even a sequence of itself is possible in "
        "ROS 2.",
    ),
    "JML651": RuleInfo("no interface", "The packages define no interfaces."),
    "JML660": RuleInfo(
        "Header without its package",
        "ROS 1 wrote `Header` for std_msgs/Header, which was used. ROS 2 requires the package.",
        Severity.WARNING,
    ),
    "JML661": RuleInfo(
        "IDL left out",
        "A package defines an interface only in IDL, which the importer does not read.",
        Severity.WARNING,
    ),
    "JML662": RuleInfo(
        "package imported along",
        "The type of a field belongs to a package that was not named and that the shipped library "
        "lacks; the installed package was imported too.",
        Severity.INFO,
    ),
}

ROS_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
"""The rules of the importer of ROS interfaces by id. Ids are never used again for others."""
