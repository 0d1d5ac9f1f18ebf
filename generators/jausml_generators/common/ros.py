"""ROS 2 types and their classes, quality of service, parameters and imports, for templates."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from jausml.language.metamodel.classes import ros
from jausml.language.semantics.ros_types import kind_of, package_of
from jausml_generators.python.names import Scope, class_name

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
OWN_PARAMETERS = frozenset({"start_type_description_service", "use_sim_time"})
"""Parameters that every rclpy node declares itself."""

LONGEST_DURATION = 9e9
"""Seconds; ROS counts nanoseconds in 64 bits, and a longer time is no limit to anything."""


@dataclass(frozen=True, order=True)
class RosType:
    """A ROS 2 interface type.

    Attributes:
        kind: Module of the package: `msg`, `srv` or `action`.
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

    @property
    def class_name(self) -> str:
        """Name of its class: its own, or `SetBoolRequest` for a part of a service."""
        return self.name if self.kind == "msg" else self.name.replace("_", "")


def ros_type(element: ros.MessageType | ros.ServiceType | ros.ActionType) -> RosType:
    """Returns the type of a modelled type, which belongs to a package."""
    return RosType(package_of(element), kind_of(element), element.name)


def local_names(types: Iterable[RosType], taken: Iterable[str]) -> dict[RosType, str]:
    """Returns the name that each type has in a module.

    It is the type's own, e.g. `Pose`, unless two types share it, the module has it already or it
    hides a builtin; then it is that of package and type, e.g. `TurtlesimPose`.
    """
    unique, reserved = sorted(set(types)), frozenset(taken)
    uses = Counter(kind.class_name for kind in unique)
    scope = Scope(reserved)
    names = {}
    for kind in unique:
        plain = kind.class_name
        is_builtin = class_name(plain).endswith("_")
        is_clear = uses[plain] == 1 and plain not in reserved and not is_builtin
        package = kind.package.title().replace("_", "")
        names[kind] = scope.claim(plain if is_clear else f"{package}{plain}")
    return names


@dataclass(frozen=True)
class Qos:
    """A quality of service profile as Python text."""

    arguments: tuple[str, ...]


def qos(profile: ros.QoSProfile | None) -> Qos:
    """Returns the Python text of a modelled QoSProfile, or of the default (depth 10) for None.

    Policies that equal rclpy's defaults are left out.
    """
    arguments = [f"depth={profile.depth if profile is not None else 10}"]
    if profile is not None:
        for feature, (policy, default) in _POLICIES.items():
            value = getattr(profile, feature).name
            if value not in (default, "automatic"):
                arguments.append(f"{feature}={policy}.{value.upper()}")
        for feature, argument in _DURATIONS.items():
            seconds = getattr(profile, feature)
            if 0 < seconds <= LONGEST_DURATION:
                arguments.append(f"{argument}=Duration(seconds={seconds!r})")
    return Qos(tuple(arguments))


def parameter_value(parameter: ros.Parameter) -> bool | int | float | str:
    """Returns the default value of a valid modelled Parameter."""
    text = str(parameter.value)
    kind = parameter.type.name
    if kind == "bool":
        return text == "true"
    if kind == "integer":
        return int(text)
    return float(text) if kind == "double" else text


class RosClasses:
    """Gives each ROS type a name, in the order in which they are asked for.

    A class that shares its name with another, as messages that mirror JAUS do, is imported under a
    name with its package.
    """

    def __init__(self, taken: Iterable[str]) -> None:
        """Starts without names."""
        self.names: dict[RosType, str] = {}
        self._taken = set(taken)

    def name_of(self, element: ros.MessageType) -> str:
        """Returns the name of the class of a type."""
        kind = ros_type(element)
        if kind not in self.names:
            package = "".join(word.capitalize() for word in kind.package.split("_"))
            name = kind.class_name
            if name in self._taken:
                name = f"{package}{name}"
            self.names[kind] = name
            self._taken.add(name)
        return self.names[kind]

    def copy(self) -> RosClasses:
        """Returns the same names, to which others may be added without a trace here."""
        other = RosClasses(self._taken)
        other.names = dict(self.names)
        return other
