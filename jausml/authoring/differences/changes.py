"""Changes from one state of a model to another, and whom they break."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel import ClassTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.diagnostics import Location

_PEERS = {
    "jaus.Component": {"address", "provides", "coreServices"},
    "jaus.Service": {"urn", "version", "inherits"},
    "jaus.MessageDef": {"code"},
    "ros.InterfacePackage": {"name"},
    "ros.MessageType": {"name"},
    "ros.ServiceType": {"name"},
    "ros.ActionType": {"name"},
    "ros.Field": {"name", "type", "messageType", "arrayKind", "arraySize", "stringBound"},
    "ros.Node": {"namespace"},
    "ros.Publisher": {"topic", "type"},
    "ros.Subscription": {"topic", "type"},
    "ros.ServiceServer": {"service", "type"},
    "ros.ServiceClient": {"service", "type"},
    "ros.QoSProfile": {"reliability", "durability"},
    "bridge.Topic": {"name"},
    "bridge.Connection": {"direction"},
    "bridge.RosServiceConnection": {"direction", "service", "type", "message", "answer"},
    "bridge.RosActionConnection": {"direction", "action", "type", "driver"},
    "bridge.Bridge": {"namespace", "allowedHosts"},
    "system.System": {"rosDomain"},
    "system.Host": {"transport", "port", "multicastGroup"},
}
"""Features that others see on the network, by the class that has them."""

_ON_THE_WIRE = (
    "jaus.Field",
    "jaus.ScaleRange",
    "jaus.ValueSet",
    "jaus.Value",
    "jaus.Alternative",
    "jaus.SubField",
    "jaus.Format",
    "jaus.ValueRange",
    "jaus.EnumeratedValue",
)

_OFF_THE_WIRE = {"name", "documentation"}
"""All that a field says counts on the wire, but for these."""

_SEEN = (
    "jaus.Component",
    "jaus.Service",
    "jaus.MessageDef",
    "ros.MessageType",
    "ros.ServiceType",
    "ros.ActionType",
    "ros.Publisher",
    "ros.Subscription",
    "ros.ServiceServer",
    "ros.ServiceClient",
    "bridge.Connection",
    "bridge.RosServiceConnection",
    "bridge.RosActionConnection",
)
"""Elements whose end others on the network notice."""

_LAYOUTS = (*_ON_THE_WIRE, "ros.Field")
"""Elements that change the layout of a message by coming or going."""

_NAMED_IN_CODE = (
    "jaus.Component",
    "jaus.ServiceConnection",
    "jaus.Service",
    "jaus.MessageDef",
    "jaus.Field",
    "jaus.SubField",
    "jaus.EnumeratedValue",
    "jaus.State",
    "jaus.Action",
    "jaus.StateMachine",
    "jaus.InternalEvent",
    "ros.Node",
    "ros.Publisher",
    "ros.Subscription",
    "ros.ServiceServer",
    "ros.ServiceClient",
    "ros.Parameter",
    "ros.MessageType",
    "ros.ServiceType",
    "ros.ActionType",
    "ros.Field",
    "ros.Constant",
    "bridge.AttributeMap",
    "bridge.Connection",
    "bridge.RosServiceConnection",
    "bridge.RosActionConnection",
    "bridge.Quantity",
    "system.System",
)
"""Elements whose names are those of generated modules, classes, methods or parameters."""

_GROWING = {"provides", "inherits"}
"""Features to which values may be added without harm to anybody."""


class Kind(Enum):
    """What became of an element."""

    ADDED = "added"
    REMOVED = "removed"
    RENAMED = "renamed"
    CHANGED = "changed"
    ORDERED = "ordered"
    """Its parts stand in another order, where the order means something."""


class Breaks(Enum):
    """Whom a change may break."""

    PEERS = "peers"
    """Programs on the network that were built for the former state, of JAUS or of ROS."""
    CODE = "code"
    """Code of users that names or extends what was generated."""


@dataclass(frozen=True)
class Change:
    """One change.

    Attributes:
        element: The class of the element in words, such as `bridge connection`.
        path: Where it stands, by the names of the new state, of the old one if it was removed.
        feature: The feature that changed; empty for the whole element.
        old_place: Where the old state says it, None where it does not.
        new_place: Where the new state says it, None where it does not.
    """

    kind: Kind
    element: str
    path: str
    feature: str = ""
    old: str = ""
    new: str = ""
    text: str = ""
    breaks: tuple[Breaks, ...] = ()
    old_place: Location | None = None
    new_place: Location | None = None
    old_element: EObject | None = None
    new_element: EObject | None = None


def breaks(kind: Kind, table: ClassTable, feature: str, *, is_lost: bool) -> tuple[Breaks, ...]:
    """Returns whom a change may break."""
    classes = {each.qualified_name for each in table.supertypes}
    found = []
    if _breaks_peers(kind, classes, feature, is_lost=is_lost):
        found.append(Breaks.PEERS)
    if kind in (Kind.REMOVED, Kind.RENAMED) and classes & set(_NAMED_IN_CODE):
        found.append(Breaks.CODE)
    if feature == "method" and is_lost:
        found.append(Breaks.CODE)
    return tuple(found)


def _breaks_peers(kind: Kind, classes: set[str], feature: str, *, is_lost: bool) -> bool:
    match kind:
        case Kind.ADDED:
            return bool(classes & set(_LAYOUTS))
        case Kind.REMOVED:
            return bool(classes & {*_SEEN, *_LAYOUTS})
        case Kind.ORDERED:
            return True
    if classes & set(_ON_THE_WIRE) and feature not in _OFF_THE_WIRE:
        return True
    is_seen = any(feature in _PEERS.get(each, ()) for each in classes)
    return is_seen and (is_lost or feature not in _GROWING)


def marked(marks: Iterable[Breaks]) -> str:
    """Returns whom a change breaks, in words; empty for nobody."""
    words = " and ".join(each.value for each in marks)
    return f"breaks {words}" if words else ""
