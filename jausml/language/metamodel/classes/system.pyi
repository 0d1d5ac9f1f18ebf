"""The classes of the system language with their features.

Written by tools/build_model_types.py from system.ecore: do not edit.
"""

from collections import abc
from typing import Literal

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EEnumLiteral, EObject

class Transport(EEnumLiteral):
    """How JAUS messages travel to and from a host (AS5669A)."""

    name: Literal[
        "judp",
        "jtcp",
        "nodeManager",
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

class System(NamedElement):
    """A whole system.

    A workspace of packages is generated from it.
    """

    version: str
    """Version of the generated packages."""

    maintainer: str
    """Maintainer named in the generated packages."""

    maintainerEmail: str
    """Address of the maintainer."""

    license: str
    """License named in the generated packages, as an SPDX identifier."""

    rosDomain: int
    """ROS domain id, 0..101."""

    serviceSets: abc.Sequence[jaus.ServiceSet]
    """Service sets of the system itself."""

    interfaces: abc.Sequence[ros.InterfacePackage]
    """Interface packages of the system itself."""

    components: abc.Sequence[jaus.Component]
    """JAUS components."""

    nodes: abc.Sequence[ros.Node]
    """ROS 2 nodes."""

    bridges: abc.Sequence[bridge.Bridge]
    """Bridges."""

    hosts: abc.Sequence[Host]
    """Hosts."""

    placements: abc.Sequence[Placement]
    """What runs where.

    An element without a placement runs on the first host.
    """

class Host(NamedElement):
    """A computer of the system, with the network settings of its JAUS transport (AS5669A)."""

    interface: str
    """IPv4 address of the network interface that JAUS uses."""

    transport: Transport
    """How the messages of this host travel."""

    port: int
    """UDP or TCP port of JAUS."""

    multicastGroup: str
    """Multicast group of JAUS."""

    multicastTtl: int
    """Time to live of multicast datagrams, 0..255."""

    fragmentSize: int
    """Payload of one packet in bytes, 64..4079.

    A small one, such as 1400, spares lossy networks the loss of a whole message with one frame;
    messages of more than 40 such packets go in larger ones.
    """

    def eContainer(self) -> System | None:
        """Returns the element that owns this one, None for a root."""

class Placement(EObject):
    """States which elements run on a host."""

    host: Host
    """The host."""

    components: abc.Sequence[jaus.Component]
    """Components and bridges that run there."""

    nodes: abc.Sequence[ros.Node]
    """Nodes that run there."""

    def eContainer(self) -> System | None:
        """Returns the element that owns this one, None for a root."""
