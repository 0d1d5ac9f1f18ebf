"""Assumptions: what a model cannot say, of its topics and of the runtime."""

from __future__ import annotations

import ast
import functools
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import jausml

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel.classes import bridge, jaus

Value = TypeVar("Value", int, float)

DEFAULT_RATE = 10.0
"""Messages each second of a topic or of a sender of which nothing is said."""

DEFAULT_LENGTH = 100
"""Elements of a list whose length is open."""


@dataclass(frozen=True)
class Assumptions:
    """What stands in where a model says nothing.

    `length`: elements of lists and bytes of octets. `rates`: rates of some connections, by
    `connection` or `bridge.connection`.
    """

    rate: float = DEFAULT_RATE
    length: int = DEFAULT_LENGTH
    rates: Mapping[str, float] = field(default_factory=dict)
    lengths: Mapping[str, int] = field(default_factory=dict)

    def rate_of(self, connection: bridge.Connection | jaus.ServiceConnection) -> float:
        """Returns the messages each second of the source of a connection."""
        return _chosen(self.rates, connection, self.rate)

    def length_of(self, connection: bridge.Connection | jaus.ServiceConnection) -> int:
        """Returns the elements of lists in the messages of a connection."""
        return _chosen(self.lengths, connection, self.length)

    @property
    def names(self) -> frozenset[str]:
        """The connections of which something is said."""
        return frozenset({*self.rates, *self.lengths})


def names_of(connection: bridge.Connection | jaus.ServiceConnection) -> tuple[str, str]:
    """Returns the names by which assumptions know a connection, the more exact one first."""
    owner = connection.eContainer()
    around = owner.name if owner is not None else ""
    return f"{around}.{connection.name}", str(connection.name)


def _chosen(
    known: Mapping[str, Value],
    connection: bridge.Connection | jaus.ServiceConnection,
    otherwise: Value,
) -> Value:
    return next((known[name] for name in names_of(connection) if name in known), otherwise)


@dataclass(frozen=True)
class RuntimeConstants:
    """Sizes in bytes, times in seconds, rates in hertz.

    `at_once`: packets of a message that go out without acknowledgement; more are acknowledged.
    """

    empty_message: int
    largest_fragment: int
    most_small_fragments: int
    at_once: int
    held_by_peers: int
    largest_message: int
    event_header: int
    acknowledge_timeout: float
    acknowledge_retries: int
    event_rate_min: float
    highest_event_rate: float
    check_interval: float
    watch_interval: float
    renewals: int
    queue_age_limit: float
    least_depth: int


@functools.cache
def runtime_constants() -> RuntimeConstants:
    """Returns the figures of the runtime that this installation copies."""
    settings = _File("base/settings.py")
    definitions = _File("services/definitions.py")
    packets = "transports/packets"
    events = _File("clients/event_stream.py")
    return RuntimeConstants(
        empty_message=int(_File(f"{packets}/packet.py").value("EMPTY_MESSAGE_SIZE")),
        largest_fragment=int(settings.value("MAX_FRAGMENT_SIZE")),
        most_small_fragments=int(_File(f"{packets}/outgoing.py").value("MOST_SMALL_FRAGMENTS")),
        at_once=int(_File(f"{packets}/messenger.py").value("AT_ONCE")),
        held_by_peers=int(_File(f"{packets}/messenger.py").value("HELD_BY_PEERS")),
        largest_message=int(settings.default("TransportSettings", "reassembly_limit")),
        event_header=int(events.value("EVENT_HEADER")),
        acknowledge_timeout=settings.default("TransportSettings", "acknowledge_timeout"),
        acknowledge_retries=int(settings.default("TransportSettings", "acknowledge_retries")),
        event_rate_min=definitions.default("ComponentSettings", "event_rate_min"),
        highest_event_rate=definitions.value("MAX_EVENT_RATE"),
        check_interval=definitions.default("ComponentSettings", "check_interval"),
        watch_interval=definitions.default("ComponentSettings", "watch_interval"),
        renewals=int(_File("clients/controlled_target.py").value("RENEWALS")),
        queue_age_limit=_File("bridge/ends/parameters.py").value("QUEUE_AGE_LIMIT"),
        least_depth=int(_File("bridge/ros/parameters.py").value("LEAST_DEPTH")),
    )


class _File:
    """A file of the runtime."""

    def __init__(self, path: str) -> None:
        text = (Path(jausml.__file__).parent / "runtime" / path).read_text("utf-8")
        self._body = ast.parse(text).body

    def value(self, name: str) -> float:
        """Returns the number that a module gives a name."""
        return self._number(_assigned(self._body, name))

    def default(self, owner: str, name: str) -> float:
        """Returns the number that a class gives an attribute."""
        classes = (each for each in self._body if isinstance(each, ast.ClassDef))
        body = next(each.body for each in classes if each.name == owner)
        return self._number(_assigned(body, name))

    def _number(self, node: ast.expr) -> float:
        if isinstance(node, ast.Name):
            return self.value(node.id)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.LShift):
            return int(self._number(node.left)) << int(self._number(node.right))
        number: float = ast.literal_eval(node)
        return number


def _assigned(body: list[ast.stmt], name: str) -> ast.expr:
    for node in body:
        if isinstance(node, ast.Assign):
            target: ast.expr = node.targets[0]
        elif isinstance(node, ast.AnnAssign):
            target = node.target
        else:
            continue
        if isinstance(target, ast.Name) and target.id == name and node.value is not None:
            return node.value
    raise LookupError(f"the runtime has no {name}")
