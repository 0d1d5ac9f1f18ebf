"""Writes models/library/ros/<package>.xmi from the interface definitions of an installed ROS 2.

Usage: build_ros_library.py SHARE_FOLDER [PACKAGE ...] [--output FOLDER]

SHARE_FOLDER is the folder that holds one folder for each ROS package, for example
/opt/ros/jazzy/share. Only facts are taken over (names, types, sizes, defaults, constants), no
comments. Packages that few installations have stand in tools/ros_definitions; units, axes, ranges
and markers in tools/ros_semantics.ini. The output is the same for the same definitions, whatever
the machine.
"""

from __future__ import annotations

import argparse
import configparser
import hashlib
import re
import sys
from pathlib import Path
from typing import Any

from jausml.language.attributes.expressions import ExpressionError, parse_expression
from jausml.language.attributes.units import parse_unit
from jausml.language.importers.ros import ImportResult, import_packages, package_sources, placed
from jausml.language.metamodel import Metamodels
from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import assign, new_object
from jausml.language.model.xmi.writer import write_model

HERE = Path(__file__).resolve().parent
OWN_DEFINITIONS = HERE / "ros_definitions"
SEMANTICS = HERE / "ros_semantics.ini"
DEFAULT_OUTPUT = HERE.parent / "models" / "library" / "ros"
DEFAULT_PACKAGES = (
    "builtin_interfaces",
    "std_msgs",
    "geometry_msgs",
    "nav_msgs",
    "sensor_msgs",
    "diagnostic_msgs",
    "std_srvs",
    "unique_identifier_msgs",
    "ackermann_msgs",
    "geographic_msgs",
    "nav2_msgs",
    "shape_msgs",
    "stereo_msgs",
    "trajectory_msgs",
    "visualization_msgs",
    "control_msgs",
    "lifecycle_msgs",
    "rcl_interfaces",
)
FRAMES = ("forwardLeftUp", "eastNorthUp", "localUp", "geodetic")
PACKAGES = "packages"
"""The section with the versions that were read; the others are message types."""
_RANGE = re.compile(r"(?P<minimum>-?[0-9.]+?)\.\.(?P<maximum>-?[0-9.]+)")
_MARKER = re.compile(
    r"(?P<meaning>unknown|none|unlimited): (?P<condition>.+?)"
    r"(?: -> (?P<value>\S+))?(?: by (?P<stated>.+))?"
)


class LibraryError(ValueError):
    """What the library is made of does not fit together."""


def read_packages(share: Path, names: tuple[str, ...], *, comments: bool = False) -> ImportResult:
    """Imports packages.

    Args:
        share: Folder of the installed packages.
        names: The packages.
        comments: Whether elements take over their comments, which the library does not.

    Raises:
        LibraryError: A package is not there, or a definition cannot be understood.
    """
    folders = []
    for name in names:
        own = OWN_DEFINITIONS / name
        folder = own if own.is_dir() else share / name
        if not folder.is_dir():
            raise LibraryError(f"no package {folder}")
        folders.append(str(folder))
    result = import_packages(package_sources(folders), library=False, comments=comments)
    if result.diagnostics:
        raise LibraryError("\n".join(map(str, result.diagnostics)))
    return result


def read_semantics(path: Path) -> dict[str, dict[str, dict[str, Any]]]:
    """Returns units, frame, minimum, maximum and markers by message type and field.

    Raises:
        LibraryError: A statement is none of them.
    """
    parser = configparser.ConfigParser(delimiters=("=",), interpolation=None)
    parser.optionxform = str  # type: ignore[method-assign,assignment]
    parser.read_string(path.read_text(encoding="utf-8"))
    versions = parser[PACKAGES]
    semantics: dict[str, dict[str, dict[str, Any]]] = {}
    for section in parser.sections():
        if section == PACKAGES:
            continue
        package, _, name = section.partition("/")
        own = f"{name.partition('_')[0]} of {package} {versions.get(package, '').partition(':')[0]}"
        semantics[section] = {
            field.strip(): _statements(field.strip(), text, own)
            for fields, text in parser[section].items()
            for field in fields.split(",")
        }
    return semantics


def _statements(field: str, text: str, stated: str) -> dict[str, Any]:
    """What is said of a field; `stated` is where that is, unless a marker says otherwise."""
    first, *lines = text.split("\n")
    statements: dict[str, Any] = {}
    for word in first.split():
        limits = _RANGE.fullmatch(word)
        if limits:
            statements["minimum"], statements["maximum"] = map(float, limits.groups())
        elif word in FRAMES:
            statements["frame"] = word
        elif parse_unit(word):
            statements["units"] = word
    if lines:
        statements["markers"] = [_marker(field, line, stated) for line in lines]
    return statements


def _marker(field: str, line: str, stated: str) -> dict[str, str]:
    match = _MARKER.fullmatch(line)
    if match is None:
        raise LibraryError(f"{SEMANTICS.name}: {field} has no marker '{line}'")
    condition = _spelt_out(re.sub(r"\bit\b", field, match["condition"]))
    try:
        parse_expression(condition)
    except ExpressionError as fault:
        raise LibraryError(f"{SEMANTICS.name}: {field}: '{condition}': {fault}") from fault
    features = {
        "condition": condition,
        "value": match["value"],
        "stated": match["stated"] or stated,
    }
    return {
        "meaning": match["meaning"],
        **{name: value for name, value in features.items() if value},
    }


def _spelt_out(condition: str) -> str:
    """Returns `a == 0 and b == 0` of `{a,b} == 0`."""
    head, opened, rest = condition.partition("{")
    if not opened:
        return condition
    names, _, tail = rest.partition("}")
    return " and ".join(f"{head}{name}{tail}" for name in names.split(","))


def digest_of(folder: Path) -> str:
    """Returns a digest of the definitions of a package: of all words, comments included."""
    texts = (
        f"{path.name} {' '.join(path.read_text(encoding='utf-8').split())}"
        for suffix in ("msg", "srv", "action")
        for path in sorted(folder.glob(f"{suffix}/*.{suffix}"))
    )
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()[:16]


def add_semantics(result: ImportResult, facts: dict[str, dict[str, dict[str, Any]]]) -> None:
    """Writes units, axes, ranges and markers into the fields of imported packages.

    Args:
        result: The packages.
        facts: What `read_semantics` returns; types of other packages are passed over.

    Raises:
        LibraryError: A type or a field is not there.
    """
    types = {
        f"{package.name}/{message_type.name}": message_type
        for package in result.packages
        for message_type in messages_of(package)
    }
    imported = {package.name for package in result.packages}
    for type_name, fields in facts.items():
        if type_name.partition("/")[0] not in imported:
            continue
        message = types.get(type_name)
        if message is None:
            raise LibraryError(f"{SEMANTICS.name}: no type {type_name}")
        by_name = {field.name: field for field in message.fields}
        for name, statements in fields.items():
            if name not in by_name:
                raise LibraryError(f"{SEMANTICS.name}: {type_name} has no field {name}")
            _fill(by_name[name], statements, result.model.metamodels)


def _fill(element: EObject, features: dict[str, Any], classes: Metamodels) -> None:
    """Sets features of an element; what is a map itself stands for a marker."""
    tables = classes.class_of(element).features
    for name, value in features.items():
        if isinstance(value, list):
            for entry in value:
                marker = new_object(classes.classes["ros.Marker"])
                _fill(marker, entry, classes)
                assign(element, tables[name], marker)
        else:
            assign(element, tables[name], value)


def messages_of(package: ros.InterfacePackage) -> list[ros.MessageType]:
    """Returns the message types of a package, with those of its services and actions."""
    parts = [
        message_type
        for service in package.services
        for message_type in (service.request, service.response)
    ]
    parts += [
        message_type
        for action in package.actions
        for message_type in (action.goal, action.result, action.feedback)
    ]
    return [*package.messages, *parts]


def main(arguments: list[str] | None = None) -> int:
    """Writes the library; exit code 1 with a message when a definition is missing or unclear."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("share", type=Path, help="folder of the installed ROS packages")
    parser.add_argument("packages", nargs="*", help="packages (default: those of the library)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder to write to")
    options = parser.parse_args(arguments)
    try:
        result = read_packages(options.share, tuple(options.packages) or DEFAULT_PACKAGES)
        add_semantics(result, read_semantics(SEMANTICS))
    except LibraryError as fault:
        print(f"build_ros_library: {fault}", file=sys.stderr)
        return 1
    options.output.mkdir(parents=True, exist_ok=True)
    places = {options.output / f"{package.name}.xmi": [package] for package in result.packages}
    model = placed(result, places)
    for path, roots in places.items():
        write_model(roots, model, path)
        print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
