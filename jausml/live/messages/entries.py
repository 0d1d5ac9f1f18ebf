"""Entries of the catalogue: services and messages, also messages inside messages."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from jausml.language import wire
from jausml.live.messages.codec import PRESENCE, codec_of, may_hold_message
from jausml.live.messages.counted import MESSAGE, EncodeMessage
from jausml.live.messages.errors import DecodeError, DefinitionError, EncodeError, MessageError
from jausml.live.messages.field_paths import completed
from jausml.live.messages.items import Codec
from jausml.live.messages.walking import holders

_CODE = struct.Struct("<H")
# Two definitions that differ in these alone decode and encode the same.
_BESIDE_BYTES = frozenset({"documentation", "units", "listed", "intervals"})


def read_code(payload: bytes) -> int:
    """Returns the message code that a payload begins with."""
    if len(payload) < _CODE.size:
        raise DecodeError(f"{len(payload)} bytes are too few for a message code")
    code: int = _CODE.unpack_from(payload)[0]
    return code


class ServiceEntry:
    """A service of the catalogue.

    Attributes:
        input_names: Names of the messages that it receives, without inherited ones.
        output_names: Names of the messages that it sends, without inherited ones.
    """

    def __init__(
        self,
        names: Mapping[str, str],
        input_names: tuple[str, ...],
        output_names: tuple[str, ...],
        messages: Callable[[], tuple[tuple[MessageEntry, ...], tuple[MessageEntry, ...]]],
    ) -> None:
        """Describes a service.

        Args:
            names: A text for each of `NAMES`.
            messages: Returns the entries of its inputs and of its outputs, when these are used.
        """
        self.urn, self.version, self.name = names["urn"], names["version"], names["name"]
        self.documentation = names["documentation"]
        self.set_name, self.set_version = names["set_name"], names["set_version"]
        self.input_names, self.output_names = input_names, output_names
        self.inherits: ServiceEntry | None = None
        self._find_messages = messages

    NAMES = ("urn", "version", "name", "documentation", "set_name", "set_version")
    """Its attributes that are texts."""

    def __repr__(self) -> str:
        return f"<ServiceEntry {self.label}>"

    @property
    def label(self) -> str:
        """URN and version, e.g. `urn:jaus:jss:core:Management/1.1`."""
        return f"{self.urn}/{self.version}"

    @cached_property
    def _messages(self) -> tuple[tuple[MessageEntry, ...], tuple[MessageEntry, ...]]:
        return self._find_messages()

    @property
    def inputs(self) -> tuple[MessageEntry, ...]:
        """The messages that it receives, without inherited ones."""
        return self._messages[0]

    @property
    def outputs(self) -> tuple[MessageEntry, ...]:
        """The messages that it sends, without inherited ones."""
        return self._messages[1]

    @property
    def messages(self) -> tuple[MessageEntry, ...]:
        """Inputs and outputs, each message once."""
        return tuple(dict.fromkeys((*self.inputs, *self.outputs)))

    @property
    def lineage(self) -> Iterator[ServiceEntry]:
        """The service itself, the one that it extends, and so on."""
        seen: list[ServiceEntry] = []
        service: ServiceEntry | None = self
        while service is not None and service not in seen:
            seen.append(service)
            yield service
            service = service.inherits


class Relations(NamedTuple):
    """What belongs to a message, by each service that defines it.

    Attributes:
        is_for_controller: Whether components obey it from their controller alone.
        answers: The messages that confirm or reject it.
        exchange: The query and the report of the value that it sets; None without them.
    """

    is_for_controller: bool = False
    answers: tuple[MessageEntry, ...] = ()
    exchange: tuple[MessageEntry, MessageEntry] | None = None


class MessageEntry:
    """A message of the catalogue: one name, code and layout, defined by one or more services."""

    def __init__(
        self,
        name: str,
        code: int,
        documentation: str,
        layout: Callable[[], wire.Message],
        encode_message: EncodeMessage,
        decode_message: DecodeMessage,
        relations: Callable[[], Relations] = Relations,
        *,
        is_command: bool,
    ) -> None:
        """Describes a message; whoever lists it sets its `services`.

        Args:
            layout: Returns how it is laid out, when that is used (`wire.LayoutError`: it is not).
            encode_message: Encodes a message inside it.
            decode_message: Decodes a message inside it where `decode` gets nothing else.
            relations: Returns what belongs to it, when that is used.
            is_command: Whether it commands its receiver.
        """
        self.name, self.code, self.documentation = name, code, documentation
        self.is_command = is_command
        self.services: tuple[ServiceEntry, ...] = ()
        self._find_layout, self._find_relations = layout, relations
        self._encode_message = encode_message
        self._decode_message = decode_message

    def __repr__(self) -> str:
        return f"<MessageEntry {self.name} {self.code_text}>"

    @property
    def code_text(self) -> str:
        """The message code in four hexadecimal digits, e.g. `0x4002`."""
        return f"0x{self.code:04X}"

    @property
    def label(self) -> str:
        """Name and first service, e.g. `ReportStatus of urn:jaus:jss:core:Management/1.0`."""
        return f"{self.name} of {self.services[0].label}" if self.services else self.name

    @property
    def is_rejection(self) -> bool:
        """Whether it rejects a request."""
        return self.name.startswith("Reject")

    @property
    def layout(self) -> wire.Message:
        """The layout of the message (`wire.LayoutError`: it has none)."""
        return self._find_layout()

    @cached_property
    def relations(self) -> Relations:
        """What belongs to it."""
        return self._find_relations()

    @cached_property
    def record(self) -> wire.Record:
        """The body as a record of its one field; without fields for a message of its code alone."""
        try:
            body = self.layout.body
        except wire.LayoutError as error:
            raise DefinitionError(error.reason, error.path) from None
        return wire.Record(() if body is None else (body,))

    @cached_property
    def _codec(self) -> Codec:
        try:
            return codec_of(self.record, self._encode_message)
        except DefinitionError as error:
            raise error.inside(self.name) from None

    @cached_property
    def may_hold_messages(self) -> bool:
        """Whether a field of the body can hold a message."""
        return may_hold_message(self.record)

    @cached_property
    def identity(self) -> tuple[Any, ...]:
        """The facts that two definitions of one message share."""
        return (self.name, self.code, wire.comparable(self.record, _BESIDE_BYTES))

    def completed(self, fields: dict[str, Any]) -> dict[str, Any]:
        """Returns fields in the shapes of `decode`.

        Args:
            fields: The one record of a body need not be named; names may be paths, as they are
                shown: `NodeList[0].NodeID`, or their ends, where one path alone has them.
        """
        return completed(self.record, fields)

    def shortened(self, fields: dict[str, Any]) -> dict[str, Any]:
        """Returns fields without the one record of a body, and without its presence vector."""
        members = self.record.members
        inner = fields.get(members[0].name) if len(members) == 1 else None
        shown = inner if isinstance(inner, dict) else fields
        there = {name: value for name, value in shown.items() if name != PRESENCE}
        return dict(_with_short_messages(there)) if self.may_hold_messages else there

    def decode(self, payload: bytes, decode_message: DecodeMessage | None = None) -> dict[str, Any]:
        """Returns the fields of the body.

        Shapes: a record or sequence is an object of its members, with `_pv` when it has a presence
        vector; a variant `{"_tag": n, OPTION: ...}`; a variable field `{"index", "value"}`; a
        variable format field `{"format", "hex"}`; a variable length field `{"hex"}`, both with
        `message` instead of `hex` where they hold one that is known; a bit field an object of
        integers; arrays and lists are lists. An integer with a name is a `NamedValue`.
        """
        code = read_code(payload)
        if code != self.code:
            raise DecodeError(f"0x{code:04X} is not the code of {self.name}, {self.code_text}")
        fields: dict[str, Any]
        fields, end = self._codec.read(payload, _CODE.size)
        if end != len(payload):
            # A longer body is of another definition: what was read of it cannot be trusted.
            raise DecodeError(f"{len(payload) - end} bytes follow the body of {self.name}")
        if self.may_hold_messages:
            put_in_place(self.record, fields, decode_message or self._decode_message)
        return fields

    def encode(self, fields: dict[str, Any]) -> bytes:
        """Returns message code and body.

        Args:
            fields: The fields in the shapes of `decode`. `_pv` may be left out; if it stands there
                it must agree with the members that are there.
        """
        out = bytearray(_CODE.pack(self.code))
        try:
            self._codec.write(fields, out)
        except struct.error as error:
            raise EncodeError(str(error)) from None
        return bytes(out)


@dataclass(frozen=True)
class DecodedMessage:
    """A message with its fields."""

    entry: MessageEntry
    fields: dict[str, Any]
    service: ServiceEntry

    def to_json(self) -> dict[str, Any]:
        """Returns the message as `jausml decode` prints it and `Catalogue.encode` takes it."""
        return {
            "message": self.entry.name,
            "code": self.entry.code_text,
            "service": self.service.urn,
            "service_version": self.service.version,
            "fields": self.fields,
        }


class EmbeddedMessage(dict[str, Any]):
    """A message inside another, as `DecodedMessage.to_json` has it.

    Attributes:
        decoded: The message; None when it cannot be decoded, and the object says why.
    """

    def __init__(self, decoded: DecodedMessage | None, error: str = "") -> None:
        super().__init__({"error": error} if decoded is None else decoded.to_json())
        self.decoded = decoded


DecodeMessage = Callable[[bytes], "DecodedMessage | None"]
"""Returns an embedded message of its payload; None leaves it as it is."""


def put_in_place(record: wire.Record, fields: dict[str, Any], decode: DecodeMessage) -> None:
    """Puts messages in the place of their hex; what cannot be decoded stays, and says why."""
    for holder in holders(record, fields):
        try:
            message = decode(bytes.fromhex(holder["hex"]))
        except MessageError as error:
            holder[MESSAGE] = EmbeddedMessage(None, str(error))
            continue
        if message is not None:
            del holder["hex"]
            holder[MESSAGE] = EmbeddedMessage(message)


def _with_short_messages(value: Any) -> Any:
    """Returns a value in which messages have the fields of `MessageEntry.shortened`."""
    match value:
        case EmbeddedMessage(decoded=DecodedMessage() as decoded):
            return {**value, "fields": decoded.entry.shortened(decoded.fields)}
        case dict():
            return {name: _with_short_messages(member) for name, member in value.items()}
        case list():
            return [_with_short_messages(item) for item in value]
        case _:
            return value
