"""What templates may ask about ROS 2 names, types and quality of service."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

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


def ros_type(element: Any) -> RosType:
    """Returns the type of a modelled MessageType, ServiceType or ActionType."""
    kind = {"MessageType": "msg", "ServiceType": "srv", "ActionType": "action"}[element.eClass.name]
    return RosType(element.eContainer().name, kind, element.name)


@dataclass(frozen=True)
class Qos:
    """A quality of service profile as Python text.

    Attributes:
        expression: Constructor call, e.g. `QoSProfile(depth=10)`.
        imports: Names that the expression needs, as (module, name).
    """

    expression: str
    imports: tuple[tuple[str, str], ...]


def qos(profile: Any) -> Qos:
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
            if seconds > 0:
                arguments.append(f"{argument}=Duration(seconds={seconds!r})")
                imports.append(("rclpy.duration", "Duration"))
    return Qos(f"QoSProfile({', '.join(arguments)})", tuple(imports))


def import_lines(names: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Returns sorted `from module import names` lines, as ruff's import sorter writes them."""
    modules: dict[str, set[str]] = {}
    for module, name in names:
        modules.setdefault(module, set()).add(name)
    return tuple(_import_line(module, sorted(modules[module])) for module in sorted(modules))


def _import_line(module: str, names: list[str]) -> str:
    # isort's default order: CONSTANTS, Classes, functions; ours are all classes.
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= 100:
        return line
    return "\n".join([f"from {module} import (", *(f"    {name}," for name in names), ")"])
