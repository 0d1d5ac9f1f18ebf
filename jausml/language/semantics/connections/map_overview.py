"""Attribute maps at a glance: what they relate, in which directions, with which numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.paths.ros_paths import ros_name

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge

TO_ROS, TO_JAUS = "JAUS->ROS", "ROS->JAUS"


@dataclass(frozen=True)
class MapOverview:
    """An attribute map at a glance."""

    name: str
    documentation: str
    message: str
    code: str
    service: str
    type: str
    directions: tuple[str, ...]
    quantities: tuple[tuple[str, float, str], ...]
    joins: tuple[tuple[str, str, float, str], ...]
    report_joins: tuple[tuple[str, str, float, str], ...]
    vectors: int

    @property
    def types(self) -> list[str]:
        """The ROS type and those of joined topics."""
        return [self.type, *(kind for _, kind, _, _ in self.joins)]

    def to_json(self) -> dict[str, Any]:
        """Returns what is known as objects and lists."""
        return {
            "map": self.name,
            "message": self.message,
            "code": self.code,
            "service": self.service,
            "type": self.type,
            "directions": list(self.directions),
            "quantities": [
                {"name": name, "value": value, "units": units}
                for name, value, units in self.quantities
            ],
            "joins": [
                {"name": name, "type": kind, "freshness": freshness, "whenStale": stale}
                for name, kind, freshness, stale in self.joins
            ],
            "reportJoins": [
                {"name": name, "message": message, "freshness": freshness, "whenStale": stale}
                for name, message, freshness, stale in self.report_joins
            ],
            "vectors": self.vectors,
            "documentation": self.documentation,
        }


def overview(attribute_map: bridge.AttributeMap) -> MapOverview:
    """Returns a map at a glance."""
    message = attribute_map.message
    owner = message.eContainer()
    ways = ((TO_ROS, attribute_map.toRos), (TO_JAUS, attribute_map.toJaus))
    return MapOverview(
        name=str(attribute_map.name),
        documentation=str(attribute_map.documentation or ""),
        message=str(message.name),
        code=str(message.code),
        service=str(owner.name) if owner is not None else "",
        type=ros_name(attribute_map.type),
        directions=tuple(way for way, assignments in ways if assignments),
        quantities=tuple(
            (str(each.name), float(each.value), str(each.units or ""))
            for each in attribute_map.quantities
        ),
        joins=tuple(
            (str(each.name), ros_name(each.type), float(each.freshness), str(each.whenStale))
            for each in attribute_map.joins
        ),
        report_joins=tuple(
            (str(each.name), str(each.message.name), float(each.freshness), str(each.whenStale))
            for each in attribute_map.reportJoins
        ),
        vectors=len(attribute_map.vectors),
    )
