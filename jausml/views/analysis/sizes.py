"""Sizes of messages of JAUS and ROS (XCDR1), and what is assumed where a model says nothing."""

from __future__ import annotations

import ast
import functools
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import jausml
from jausml.language import wire
from jausml.language.cdr import PRIMITIVES
from jausml.language.metamodel.classes import bridge, jaus, ros

Value = TypeVar("Value", int, float)

DEFAULT_RATE = 10.0
"""Messages each second of a topic or of a sender of which nothing is said."""

DEFAULT_LENGTH = 100
"""Elements of a list whose length is open."""


@dataclass(frozen=True)
class Assumptions:
    """The figures that stand in where a model states none.

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
        most_small_fragments=int(_File(f"{packets}/outgoing.py").value("MAX_SMALL_FRAGMENTS")),
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
        classes = (statement for statement in self._body if isinstance(statement, ast.ClassDef))
        body = next(definition.body for definition in classes if definition.name == owner)
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


TEXT_LENGTH = 16
"""Characters of a text whose length nobody knows, such as the name of a frame."""


@dataclass(frozen=True)
class Size:
    """Bytes of a message.

    `least`: fewest bytes. `most`: most bytes; None where nothing but the receiver limits them.
    """

    least: int
    expected: int
    most: int | None

    def plus(self, more: int) -> Size:
        """Returns the size with so many bytes around it."""
        return Size(
            self.least + more, self.expected + more, None if self.most is None else self.most + more
        )


def jaus_size(message: wire.Message, length: int, present: Container[str] | None = None) -> Size:
    """Returns the size of a JAUS message without the header of the transport (AS5684).

    `length`: assumed elements of lists and bytes of octets, as far as their counts allow.
    `present`: optional fields of the body that may be there; None means all.
    """
    size = _Walk(length).body(message, present).plus(message.header.size)
    limit = runtime_constants().largest_message
    if size.most is None or size.most > limit:
        return Size(size.least, min(size.expected, limit), None)
    return size


class _Walk:
    """Sums the sizes of fields."""

    def __init__(self, length: int) -> None:
        self._length = length

    def body(self, message: wire.Message, present: Container[str] | None) -> Size:
        if message.body is None:
            return Size(0, 0, 0)
        kind = message.body.kind
        if isinstance(kind, wire.Record):
            return self._record(kind, present)
        return self.kind(kind)

    def kind(self, kind: wire.Kind) -> Size:
        match kind:
            case wire.Text():
                return self._counted(kind.count, TEXT_LENGTH, _fixed(1))
            case wire.Octets():
                return self._counted(kind.count, self._length, _fixed(1))
            case wire.FormattedOctets():
                return self._counted(kind.count, self._length, _fixed(1)).plus(1)
            case wire.List():
                return self._counted(kind.count, self._length, self.kind(kind.element.kind))
            case wire.Array():
                size = self.kind(kind.element.kind)
                return _times(size, kind.length, kind.length, kind.length)
            case wire.Record():
                return self._record(kind, None)
            case wire.Variant():
                return self._one_of([self.kind(option.kind) for option in kind.options]).plus(
                    kind.tag.size
                )
            case wire.VariableNumber():
                numbers = [
                    _fixed(alternative.number.minimum_size) for alternative in kind.alternatives
                ]
                return self._one_of(numbers).plus(1)
        return _fixed(kind.minimum_size)

    def _record(self, record: wire.Record, present: Container[str] | None) -> Size:
        total = _fixed(record.presence.size if record.presence else 0)
        for member in record.members:
            if member.is_optional and present is not None and member.name not in present:
                continue
            size = self.kind(member.kind)
            total = _sum(total, Size(0, size.expected, size.most) if member.is_optional else size)
        return total

    @staticmethod
    def _one_of(options: list[Size]) -> Size:
        if not options:
            return _fixed(0)
        mosts = [option.most for option in options]
        return Size(
            min(option.least for option in options),
            max(option.expected for option in options),
            None if None in mosts else max(bound for bound in mosts if bound is not None),
        )

    @staticmethod
    def _counted(count: wire.Count, length: int, element: Size) -> Size:
        expected = min(max(length, count.lower), count.upper)
        return _times(element, count.lower, expected, count.upper).plus(count.type.size)


def _fixed(size: int) -> Size:
    return Size(size, size, size)


def _sum(first: Size, second: Size) -> Size:
    most = None if first.most is None or second.most is None else first.most + second.most
    return Size(first.least + second.least, first.expected + second.expected, most)


def _times(size: Size, least: int, expected: int, most: int) -> Size:
    return Size(
        size.least * least,
        size.expected * expected,
        None if size.most is None else size.most * most,
    )


HEADER = 4
"""Bytes of the encapsulation header."""

_COUNT = 4
_GREATEST_ALIGNMENT = 8


class _UnboundedError(Exception):
    """A size without a limit."""


def ros_size(kind: ros.MessageType, length: int) -> Size:
    """Returns the size of a message of a type."""
    least = _Writer(_nothing, _nothing).message(kind, 0)
    expected = _Writer(
        lambda bound: min(length, bound) if bound else length,
        lambda bound: min(TEXT_LENGTH, bound) if bound else TEXT_LENGTH,
    ).message(kind, 0)
    try:
        most = _Writer(_bound, _bound).message(kind, 0)
    except _UnboundedError:
        return Size(HEADER + least, HEADER + expected, None)
    # rmw_fastrtps gives types of a bounded size a multiple of four bytes.
    return Size(*(HEADER + _aligned(size, _COUNT) for size in (least, expected, most)))


def _nothing(_: int) -> int:
    return 0


def _bound(bound: int) -> int:
    if not bound:
        raise _UnboundedError
    return bound


class _Writer:
    """Tells how far the serialized form of a message reaches."""

    def __init__(self, elements: Callable[[int], int], characters: Callable[[int], int]) -> None:
        self._elements = elements
        self._characters = characters

    def message(self, kind: ros.MessageType, position: int) -> int:
        """Returns the position after a message that begins at a position."""
        if not kind.fields:
            return position + 1  # rosidl puts a byte into an empty type
        for member in kind.fields:
            position = self._field(member, position)
        return position

    def _field(self, field: ros.Field, position: int) -> int:
        match field.arrayKind.name:
            case "single":
                return self._value(field, position)
            case "fixedArray":
                return self._repeat(field, position, int(field.arraySize))
            case "boundedSequence":
                count = self._elements(int(field.arraySize))
            case _:
                count = self._elements(0)
        return self._repeat(field, _aligned(position, _COUNT) + _COUNT, count)

    def _repeat(self, field: ros.Field, position: int, count: int) -> int:
        """Returns the position after so many values; their sizes recur with the alignment."""
        steps: dict[int, tuple[int, int]] = {}
        done = 0
        while done < count:
            phase = position % _GREATEST_ALIGNMENT
            if phase in steps:
                then, where = steps[phase]
                turns = (count - done) // (done - then)
                position += turns * (position - where)
                done += turns * (done - then)
                steps.clear()
                if done == count:
                    break
            steps[phase] = done, position
            position = self._value(field, position)
            done += 1
        return position

    def _value(self, field: ros.Field, position: int) -> int:
        if isinstance(field, ros.MessageField):
            return self.message(field.messageType, position)
        assert isinstance(field, ros.PrimitiveField)  # noqa: S101 - the only other class
        name = field.type.name
        if name not in PRIMITIVES:
            count = self._characters(int(field.stringBound))
            # A string ends with a NUL that counts; a wide one is UTF-16 without.
            octets = count + 1 if name == "string" else 2 * count
            return _aligned(position, _COUNT) + _COUNT + octets
        width = PRIMITIVES[name].size
        return _aligned(position, width) + width


def _aligned(position: int, width: int) -> int:
    return position + -position % width
