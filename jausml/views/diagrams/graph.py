"""Graphs: what a diagram shows of a model, as plain values without any drawing.

Ids are those of the model (`Model.fragment`), so that an editor or a live view can speak of
the same things; what stands for no element has the id of its owner with a mark behind `!`. Parts
have the reference to the element that they show (`language/model/refs.py`), and a key: the id in
names, which stays when elements are added before it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

LEFT, RIGHT = "left", "right"
"""Sides of ports."""

JAUS_COLUMN, BRIDGE_COLUMN, ROS_COLUMN = 0, 1, 2
"""Columns of nodes, from the left."""

Details = tuple[tuple[str, str], ...]
"""Names and texts that are shown on request."""

IDLE = "unconnected"
"""Mark of the row of a service of which no connection carries anything."""

ADDED, REMOVED, CHANGED = "added", "removed", "changed"
"""States of parts, where a diagram compares two states of a model."""


@dataclass(frozen=True)
class Finding:
    """A finding about an element.

    `severity`: `error`, `warning` or `info`.
    """

    severity: str
    rule: str
    message: str


@dataclass(frozen=True, kw_only=True)
class _Part:
    """A part of a diagram.

    Attributes:
        element: Reference to the element that it shows, empty for none.
        key: What names it when positions of elements change.
        state: What became of it since another state of the model, empty for nothing.
    """

    element: str = ""
    key: str = ""
    state: str = ""


@dataclass(frozen=True, kw_only=True)
class _Described(_Part):
    """A part of which more is told on request."""

    details: Details = ()
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True)
class Port(_Described):
    """A row of a node, at which edges end.

    `mark`: one word about it, such as `required` or `unmapped`; empty for none.
    """

    id: str
    label: str
    note: str = ""
    mark: str = ""
    depth: int = 0


@dataclass(frozen=True)
class Node(_Described):
    """A box.

    `kind`: `component`, `bridge`, `node`, `others`, `message`, `type`, `service`, `messages`,
    `state`. `group`: id of the group that it stands in, empty for none. `column`: from the left;
    where a graph goes downwards, 0 for the box that stands above the others of its group.
    `is_initial`: whether it is the state that its group is entered in.
    """

    id: str
    kind: str
    title: str
    subtitle: str = ""
    ports: tuple[Port, ...] = ()
    group: str = ""
    column: int = BRIDGE_COLUMN
    is_initial: bool = False


@dataclass(frozen=True)
class Group(_Part):
    """A frame around nodes.

    `kind`: `host`, `bridge`, `service`, `state`, or `subject` for the service that a graph is
    about. `parent`: id of the group around it, empty for
    none.
    """

    id: str
    kind: str
    title: str
    parent: str = ""


@dataclass(frozen=True)
class End:
    """Where an edge ends.

    `port`: id of a port of it, empty for the node as a whole.
    """

    node: str
    port: str = ""


@dataclass(frozen=True)
class Edge(_Described):
    """A line from a source to a target.

    `kind`: `message`, `topic`, `call`, `control`, `to_ros`, `to_jaus`, `inherits`, `answers` or
    `transition`.
    """

    id: str
    source: End
    target: End
    kind: str
    title: str = ""
    labels: tuple[str, ...] = ()
    count: int = 1


@dataclass(frozen=True)
class Graph:
    """A diagram.

    Attributes:
        view: Name of the view, such as `system` or `map:odometry`.
        groups: The frames, outer ones first.
        element: Reference to the element that it shows, empty for the whole model.
    """

    view: str
    title: str
    nodes: tuple[Node, ...] = ()
    groups: tuple[Group, ...] = ()
    edges: tuple[Edge, ...] = ()
    downwards: bool = False
    findings: tuple[Finding, ...] = field(default=())
    element: str = ""
    is_crowded: bool = False

    @property
    def compares(self) -> bool:
        """Whether it shows changes of its parts."""
        states = [node.state for node in self.nodes]
        states += [port.state for node in self.nodes for port in node.ports]
        states += [group.state for group in self.groups]
        return any(states) or any(edge.state for edge in self.edges)

    @property
    def nesting(self) -> Iterator[Step]:
        """Its boxes and frames, as `nested` has them."""
        frames = [(group.id, group.parent) for group in self.groups]
        return nested([node.group for node in self.nodes], frames)

    @property
    def by_id(self) -> dict[str, Node]:
        """The nodes by id."""
        return {node.id: node for node in self.nodes}


_GRAVEST = ("error", "warning", "info")


def severity(findings: tuple[Finding, ...]) -> str:
    """Returns the gravest severity of findings, empty without any."""
    return next(
        (level for level in _GRAVEST if any(finding.severity == level for finding in findings)), ""
    )


Step = tuple[Literal["box", "begin", "end"], int, int]
"""A box, or where a frame begins or ends: which, its number, and how many frames are around it."""


def nested(
    boxes: Sequence[str], frames: Sequence[tuple[str, str]], frame: str = "", depth: int = 0
) -> Iterator[Step]:
    """Yields boxes and frames: first those in no frame, then each frame with its own.

    `boxes`: the frame of each, empty for none. `frames`: id of each, and that of the frame around
    it. `frame`: within which it begins.
    """
    for number, around in enumerate(boxes):
        if around == frame:
            yield "box", number, depth
    for number, (own, around) in enumerate(frames):
        if around == frame:
            yield "begin", number, depth
            yield from nested(boxes, frames, own, depth + 1)
            yield "end", number, depth
