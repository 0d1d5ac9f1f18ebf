"""Whom a change may break: peers on the network, or code that users wrote.

Names of JAUS elements do not travel (AS5684: positions and codes do), but generated classes and
methods bear them; names of ROS fields do both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.differences.change import Breaks, Kind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel import ClassTable

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


_GROWING = {"provides", "inherits"}
"""Features to which values may be added without harm to anybody."""


def marked(marks: Iterable[Breaks]) -> str:
    """Returns whom a change breaks, in words; empty for nobody."""
    words = " and ".join(each.value for each in marks)
    return f"breaks {words}" if words else ""
