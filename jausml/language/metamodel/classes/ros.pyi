"""The classes of the ros language with their features.

Written by tools/build_model_types.py from ros.ecore: do not edit.
"""

from collections import abc
from typing import Literal

from jausml.language.metamodel.classes import bridge, system
from jausml.language.metamodel.classes.ecore import EEnumLiteral, EObject

class PrimitiveType(EEnumLiteral):
    """Primitive types of ROS 2 interfaces."""

    name: Literal[
        "bool",
        "byte",
        "char",
        "float32",
        "float64",
        "int8",
        "uint8",
        "int16",
        "uint16",
        "int32",
        "uint32",
        "int64",
        "uint64",
        "string",
        "wstring",
    ]

class ArrayKind(EEnumLiteral):
    """Whether a field is a single value or an array."""

    name: Literal[
        "single",
        "fixedArray",
        "boundedSequence",
        "unboundedSequence",
    ]

class Frame(EEnumLiteral):
    """Axes to which a coordinate, a rate or an angle belongs.

    Names of members tell which axis it is: x, roll; y, pitch; z, yaw, heading.
    """

    name: Literal[
        "unstated",
        "forwardLeftUp",
        "forwardRightDown",
        "eastNorthUp",
        "northEastDown",
        "localUp",
        "localDown",
        "geodetic",
    ]

class Reliability(EEnumLiteral):
    """ROS 2 reliability policy."""

    name: Literal[
        "reliable",
        "best_effort",
        "system_default",
        "automatic",
    ]

class Durability(EEnumLiteral):
    """ROS 2 durability policy."""

    name: Literal[
        "volatile",
        "transient_local",
        "system_default",
    ]

class History(EEnumLiteral):
    """ROS 2 history policy."""

    name: Literal[
        "keep_last",
        "keep_all",
        "system_default",
    ]

class Liveliness(EEnumLiteral):
    """ROS 2 liveliness policy."""

    name: Literal[
        "automatic",
        "manual_by_topic",
        "system_default",
    ]

class ParameterType(EEnumLiteral):
    """Type of a node parameter."""

    name: Literal[
        "bool",
        "integer",
        "double",
        "string",
    ]

class MarkerMeaning(EEnumLiteral):
    """What a field says by a marker instead of a value."""

    name: Literal[
        "unknown",
        "none",
        "unlimited",
    ]

class NamedElement(EObject):
    """Something with a name and documentation."""

    name: str
    """Name of the element, unique among its siblings.

    Generated code derives identifiers from it.
    """

    documentation: str | None
    """What the element is for, in plain text.

    It is carried into generated documentation; XML comments would be lost when Eclipse saves the
    model.
    """

class InterfacePackage(NamedElement):
    """A ROS package that defines interfaces, for example geometry_msgs."""

    messages: abc.Sequence[MessageType]
    """Message types."""

    services: abc.Sequence[ServiceType]
    """Service types."""

    actions: abc.Sequence[ActionType]
    """Action types."""

    def eContainer(self) -> system.System | None:
        """Returns the element that owns this one, None for a root."""

class MessageType(NamedElement):
    """A message type."""

    fields: abc.Sequence[Field]
    """Fields in the order of the definition."""

    constants: abc.Sequence[Constant]
    """Constants."""

    def eContainer(self) -> InterfacePackage | ServiceType | ActionType | None:
        """Returns the element that owns this one, None for a root."""

class ServiceType(NamedElement):
    """A service type."""

    request: MessageType
    """The request."""

    response: MessageType
    """The response."""

    def eContainer(self) -> InterfacePackage | None:
        """Returns the element that owns this one, None for a root."""

class ActionType(NamedElement):
    """An action type."""

    goal: MessageType
    """The goal."""

    result: MessageType
    """The result."""

    feedback: MessageType
    """The feedback."""

    def eContainer(self) -> InterfacePackage | None:
        """Returns the element that owns this one, None for a root."""

class Marker(EObject):
    """What the definition of a message type says about values of a field that are none: a field
    without a presence vector says so by a number, which translations take for an absent value."""

    meaning: MarkerMeaning
    """What the marker says."""

    condition: str
    """True where the field says nothing, in the language of the conversion expression: value is the
    field, or each element of an array; other names are paths of numbers from the message type that
    has the field, such as value != value, status.status < 0, orientation_covariance[0] == -1.

    Where it does not name value, a marker of an array is one of the whole array.
    """

    value: str | None
    """What is written into the field, or into each element of an array, to say so, such as NaN,
    -2 or 0; empty where the default says it, or where the field alone cannot."""

    stated: str | None
    """Where that is stated: a definition with the version of its package, or a REP."""

    def eContainer(self) -> Field | None:
        """Returns the element that owns this one, None for a root."""

class Field(NamedElement):
    """A field of a message type."""

    arrayKind: ArrayKind
    """Whether the field is an array."""

    arraySize: int
    """Size of a fixed array or bound of a bounded sequence."""

    units: str | None
    """Unit of the values, for example m/s or rad; members without an own unit take that of the
    field around them.

    Empty means that nothing is known, 1 a pure number.
    """

    frame: Frame
    """Axes to which the values belong; members without an own statement take that of the field
    around them."""

    markers: abc.Sequence[Marker]
    """Values of the field, or of others beside it, by which it says that it has none."""

    def eContainer(self) -> MessageType | None:
        """Returns the element that owns this one, None for a root."""

class PrimitiveField(Field):
    """A field of a primitive type."""

    type: PrimitiveType
    """The type."""

    stringBound: int
    """Largest number of characters of a bounded string; 0 means unbounded."""

    defaultValue: str | None
    """Default value: a number in decimal digits, true or false, a text without quotes; the
    elements of an array as JSON."""

    minimum: float
    """Least value of a number by the definition of the field; meant when smaller than maximum."""

    maximum: float
    """Greatest value of a number by the definition of the field; meant when larger than minimum."""

class MessageField(Field):
    """A field that is a message of another type."""

    messageType: MessageType
    """The type."""

class Constant(NamedElement):
    """A constant of a message type."""

    type: PrimitiveType
    """The type."""

    value: str
    """The value: a number in decimal digits, true or false, a text without quotes."""

    def eContainer(self) -> MessageType | None:
        """Returns the element that owns this one, None for a root."""

class QoSProfile(EObject):
    """Quality of service of a publisher or subscription, in ROS 2 terms."""

    reliability: Reliability
    """Reliability policy."""

    durability: Durability
    """Durability policy."""

    history: History
    """History policy."""

    depth: int
    """Number of messages kept with keep_last."""

    deadline: float
    """Longest expected time between messages in seconds; 0 means none."""

    lifespan: float
    """Seconds after which a message is stale; 0 means never."""

    liveliness: Liveliness
    """Liveliness policy."""

    leaseDuration: float
    """Seconds within which liveliness must be shown; 0 means none."""

    def eContainer(self) -> TopicEndpoint | bridge.Topic | None:
        """Returns the element that owns this one, None for a root."""

class Node(NamedElement):
    """A ROS 2 node of the system.

    A node package with a skeleton is generated from it.
    """

    namespace: str
    """Namespace of the node; empty means the root."""

    frequency: float
    """Calls each second of the skeleton method on_timer; 0 means no timer."""

    publishers: abc.Sequence[Publisher]
    """Publishers."""

    subscriptions: abc.Sequence[Subscription]
    """Subscriptions."""

    serviceServers: abc.Sequence[ServiceServer]
    """Service servers."""

    serviceClients: abc.Sequence[ServiceClient]
    """Service clients."""

    parameters: abc.Sequence[Parameter]
    """Parameters."""

    dependencies: abc.Sequence[str]
    """Packages or rosdep keys that the user's code in the skeleton needs at run time; they join
    those of the generated code in package.xml."""

    def eContainer(self) -> system.System | None:
        """Returns the element that owns this one, None for a root."""

class TopicEndpoint(NamedElement):
    """A publisher or subscription."""

    topic: str
    """Topic name; relative names are resolved in the namespace of the node."""

    type: MessageType
    """Type of the messages."""

    qos: QoSProfile | None
    """Quality of service; the default is reliable, volatile, keep last 10."""

class Publisher(TopicEndpoint):
    """Publishes messages on a topic."""

    def eContainer(self) -> Node | None:
        """Returns the element that owns this one, None for a root."""

class Subscription(TopicEndpoint):
    """Receives messages of a topic in the skeleton method on_<name>."""

    def eContainer(self) -> Node | None:
        """Returns the element that owns this one, None for a root."""

class ServiceEndpoint(NamedElement):
    """A service server or client."""

    service: str
    """Service name."""

    type: ServiceType
    """Type of the service."""

class ServiceServer(ServiceEndpoint):
    """Answers requests of a service."""

    def eContainer(self) -> Node | None:
        """Returns the element that owns this one, None for a root."""

class ServiceClient(ServiceEndpoint):
    """Sends requests to a service."""

    def eContainer(self) -> Node | None:
        """Returns the element that owns this one, None for a root."""

class Parameter(NamedElement):
    """A declared parameter of a node; its documentation becomes the description."""

    type: ParameterType
    """The type."""

    value: str
    """Default value."""

    minimum: float
    """Smallest value of a number; meant when smaller than maximum."""

    maximum: float
    """Largest value of a number; meant when larger than minimum."""

    readOnly: bool
    """True when the parameter cannot change after the start."""

    def eContainer(self) -> Node | None:
        """Returns the element that owns this one, None for a root."""
