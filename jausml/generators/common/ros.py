"""ROS 2 types, quality of service, parameters and imports, for templates."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH
from jausml.generators.python.names import Scope, class_name
from jausml.semantics.installed import kind_of, package_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.metamodel.classes import ros

_POLICIES = {
    "reliability": ("ReliabilityPolicy", "reliable"),
    "durability": ("DurabilityPolicy", "volatile"),
    "history": ("HistoryPolicy", "keep_last"),
    "liveliness": ("LivelinessPolicy", "automatic"),
}
_DURATIONS = {
    "deadline": "deadline",
    "lifespan": "lifespan",
    "leaseDuration": "liveliness_lease_duration",
}
LONGEST_DURATION = 9e9
"""Seconds; ROS counts nanoseconds in 64 bits, and a longer time is no limit to anything."""


@dataclass(frozen=True, order=True)
class RosType:
    """A ROS 2 interface type.

    Attributes:
        package: Package that defines it, e.g. `nav_msgs`.
        kind: Module of the package: `msg`, `srv` or `action`.
        name: Class name, e.g. `Odometry`.
    """

    package: str
    kind: str
    name: str

    @property
    def module(self) -> str:
        """Module to import the class from, e.g. `nav_msgs.msg`."""
        return f"{self.package}.{self.kind}"

    @property
    def full_name(self) -> str:
        """Name as ROS tools print it, e.g. `nav_msgs/msg/Odometry`."""
        return f"{self.package}/{self.kind}/{self.name}"


def ros_type(element: ros.MessageType | ros.ServiceType | ros.ActionType) -> RosType:
    """Returns the type of a modelled type, which belongs to a package."""
    return RosType(package_of(element), kind_of(element), element.name)


def local_names(types: Iterable[RosType], taken: Iterable[str]) -> dict[RosType, str]:
    """Returns the name that each type has in a module.

    It is the type's own, e.g. `Pose`, unless two types share it, the module has it already or it
    hides a builtin; then it is that of package and type, e.g. `TurtlesimPose`.

    Args:
        types: The types that the module imports.
        taken: Other names of the module.
    """
    unique, reserved = sorted(set(types)), frozenset(taken)
    uses = Counter(kind.name for kind in unique)
    scope = Scope(reserved)
    names = {}
    for kind in unique:
        is_builtin = class_name(kind.name).endswith("_")
        is_clear = uses[kind.name] == 1 and kind.name not in reserved and not is_builtin
        package = kind.package.title().replace("_", "")
        names[kind] = scope.claim(kind.name if is_clear else f"{package}{kind.name}")
    return names


@dataclass(frozen=True)
class Qos:
    """A quality of service profile as Python text.

    Attributes:
        arguments: Arguments of QoSProfile, e.g. `depth=10`.
        imports: Names that the profile needs, as (module, name).
    """

    arguments: tuple[str, ...]
    imports: tuple[tuple[str, str], ...]


def qos(profile: ros.QoSProfile | None) -> Qos:
    """Returns the Python text of a modelled QoSProfile, or of the default (depth 10) for None.

    Policies that equal rclpy's defaults are left out.
    """
    arguments = [f"depth={profile.depth if profile is not None else 10}"]
    imports = [("rclpy.qos", "QoSProfile")]
    if profile is not None:
        for feature, (policy, default) in _POLICIES.items():
            value = getattr(profile, feature).name
            if value != default:
                arguments.append(f"{feature}={policy}.{value.upper()}")
                imports.append(("rclpy.qos", policy))
        for feature, argument in _DURATIONS.items():
            seconds = getattr(profile, feature)
            if 0 < seconds <= LONGEST_DURATION:
                arguments.append(f"{argument}=Duration(seconds={seconds!r})")
                imports.append(("rclpy.duration", "Duration"))
    return Qos(tuple(arguments), tuple(imports))


def parameter_value(parameter: ros.Parameter) -> bool | int | float | str:
    """Returns the default value of a valid modelled Parameter."""
    text = str(parameter.value)
    kind = parameter.type.name
    if kind == "bool":
        return text == "true"
    if kind == "integer":
        return int(text)
    return float(text) if kind == "double" else text


def import_lines(names: Iterable[tuple[str, str]], column: int = 0) -> tuple[str, ...]:
    """Returns `from module import names` lines as ruff's import sorter writes them.

    Args:
        names: Pairs of module and name; the name may be `Pose as TurtlesimPose`.
        column: Column at which they will stand; the lines themselves begin at 0.
    """
    statements: dict[tuple[str, str], set[str]] = defaultdict(set)
    for module, name in names:
        statements[module, name if " as " in name else ""].add(name)
    ordered = sorted(
        (
            (module, sorted(members, key=_member_order))
            for (module, _), members in statements.items()
        ),
        key=lambda line: (_natural(line[0]), _member_order(line[1][0])),
    )
    return tuple(_import_line(module, members, column) for module, members in ordered)


def _member_order(name: str) -> tuple[int, str, str]:
    """Constants come before classes, classes before functions; numbers count as numbers."""
    group = 0 if len(name) > 1 and name.isupper() else 1 if name[0].isupper() else 2
    return group, _natural(name), name


def _natural(text: str) -> str:
    return re.sub(r"\d+", lambda number: number.group().zfill(20), text.lower())


def _import_line(module: str, names: list[str], column: int) -> str:
    line = f"from {module} import {', '.join(names)}"
    if len(line) + column <= LINE_WIDTH:
        return line
    return "\n".join([f"from {module} import (", *(f"    {name}," for name in names), ")"])
