"""Writes models/library/ros/<package>.xmi from the interface definitions of an installed ROS 2.

Usage: build_ros_library.py SHARE_FOLDER [PACKAGE ...] [--output FOLDER]

SHARE_FOLDER is the folder that holds one folder for each ROS package, for example
/opt/ros/jazzy/share. Only facts are taken over (names, types, sizes, defaults, constants), no
comments. Packages that few installations have stand in tools/ros_definitions; units, axes and
ranges in tools/ros_semantics.ini. The output is the same for the same definitions, whatever the
machine.
"""

from __future__ import annotations

import argparse
import configparser
import re
import sys
from pathlib import Path
from typing import Any

from jausml.language.attributes.units import parse_unit
from jausml.language.importers.ros import ImportResult, import_packages, package_sources, placed
from jausml.language.metamodel.filling import set_value
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
_RANGE = re.compile(r"(?P<minimum>-?[0-9.]+?)\.\.(?P<maximum>-?[0-9.]+)")


class LibraryError(ValueError):
    """What the library is made of does not fit together."""


def read_packages(share: Path, names: tuple[str, ...]) -> ImportResult:
    """Imports packages, without their comments.

    Args:
        share: Folder of the installed packages.
        names: The packages.

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
    result = import_packages(package_sources(folders), library=False, comments=False)
    if result.diagnostics:
        raise LibraryError("\n".join(map(str, result.diagnostics)))
    return result


def read_semantics(path: Path) -> dict[str, dict[str, dict[str, Any]]]:
    """Returns units, frame, minimum and maximum by message type and field.

    Raises:
        LibraryError: A statement is none of them.
    """
    parser = configparser.ConfigParser(delimiters=("=",), interpolation=None)
    parser.optionxform = str  # type: ignore[method-assign,assignment]
    parser.read_string(path.read_text(encoding="utf-8"))
    return {
        section: {name: _statements(text) for name, text in parser[section].items()}
        for section in parser.sections()
    }


def _statements(text: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for word in text.split():
        limits = _RANGE.fullmatch(word)
        if limits:
            found["minimum"], found["maximum"] = map(float, limits.groups())
        elif word in FRAMES:
            found["frame"] = word
        elif parse_unit(word):
            found["units"] = word
    return found


def add_semantics(result: ImportResult, facts: dict[str, dict[str, dict[str, Any]]]) -> None:
    """Writes units, axes and ranges into the fields of imported packages.

    Args:
        result: The packages.
        facts: What `read_semantics` returns; types of other packages are passed over.

    Raises:
        LibraryError: A type or a field is not there.
    """
    types = {f"{p.name}/{m.name}": m for p in result.packages for m in _messages(p)}
    imported = {package.name for package in result.packages}
    classes = result.model.metamodels
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
            for feature_name, value in statements.items():
                feature = classes.class_of(by_name[name]).features[feature_name]
                data_type = feature.data_type
                literals = data_type.literals if data_type is not None else {}
                set_value(by_name[name], feature, literals.get(value, value))


def _messages(package: Any) -> list[Any]:
    parts = [each for s in package.services for each in (s.request, s.response)]
    parts += [each for a in package.actions for each in (a.goal, a.result, a.feedback)]
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
    places = {options.output / f"{each.name}.xmi": [each] for each in result.packages}
    model = placed(result, places)
    for path, roots in places.items():
        write_model(roots, model, path)
        print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
