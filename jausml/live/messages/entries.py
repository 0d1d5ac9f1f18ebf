"""Entries of the catalogue: services, messages also inside messages, and their fields by paths.

A path is written as messages are shown: `ElementList[0].ElementUID=3`.
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from jausml.language import wire
from jausml.live.messages.codec import PRESENCE, TAG, codec_of, may_hold
from jausml.live.messages.counted import MESSAGE, EncodeMessage
from jausml.live.messages.errors import DecodeError, DefinitionError, EncodeError, MessageError
from jausml.live.messages.items import Codec

MAXIMUM_DEPTH = 8
"""Messages inside messages that are decoded; what stands deeper remains hex."""


def as_it_is(_payload: bytes, /) -> None:
    """Decodes no embedded message."""


def holds(kind: wire.Octets | wire.FormattedOctets, value: Mapping[str, Any]) -> bool:
    """Tells whether a decoded byte field holds a message."""
    if isinstance(kind, wire.Octets):
        return kind.holds_message
    return kind.holds_message(int(value["format"]))


def holders(kind: wire.Kind, value: Any) -> Iterator[dict[str, Any]]:
    """Yields the objects of a decoded field that hold a message."""
    if isinstance(kind, wire.Octets | wire.FormattedOctets):
        if holds(kind, value):
            yield value
        return
    for _, inner, part in parts(kind, value):
        yield from holders(inner, part)


def parts(kind: wire.Kind, value: Any) -> Iterator[tuple[str, wire.Kind, Any]]:
    """Yields the fields inside a decoded field: their names or `[index]`, kinds and values."""
    match kind:
        case wire.Record():
            for member in kind.members:
                if member.name in value:
                    yield member.name, member.kind, value[member.name]
        case wire.List() | wire.Array():
            for index, item in enumerate(value):
                yield f"[{index}]", kind.element.kind, item
        case wire.Variant() if kind.options:
            option = kind.options[value[TAG]]
            yield option.name, option.kind, value[option.name]
        case _:
            pass  # a leaf


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
        """Is what a catalogue lists.

        Args:
            names: What `NAMES` lists.
            messages: Returns the entries of its inputs and outputs.
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
        """Is what a catalogue lists.

        Args:
            layout: Returns how it is laid out, when that is used (`wire.LayoutError`: it is not).
            relations: Returns what belongs to it, when that is used.
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
        return may_hold(self.record)

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
        members = self.record.members
        is_whole = len(members) != 1 or any(_first(field) == members[0].name for field in fields)
        kind = self.record if is_whole else members[0].kind
        fields = by_name(_from_ends(kind, fields))
        return fields if is_whole else {members[0].name: fields}

    def shortened(self, fields: dict[str, Any]) -> dict[str, Any]:
        """Returns fields without the one record of a body, and without its presence vector."""
        members = self.record.members
        inner = fields.get(members[0].name) if len(members) == 1 else None
        shown = inner if isinstance(inner, dict) else fields
        there = {name: value for name, value in shown.items() if name != PRESENCE}
        return dict(shortened(there)) if self.may_hold_messages else there

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


def shortened(value: Any) -> Any:
    """Returns a value in which messages have the fields of `MessageEntry.shortened`."""
    match value:
        case EmbeddedMessage(decoded=DecodedMessage() as decoded):
            return {**value, "fields": decoded.entry.shortened(decoded.fields)}
        case dict():
            return {name: shortened(member) for name, member in value.items()}
        case list():
            return [shortened(item) for item in value]
        case _:
            return value


_PATH = r"\w+(?:\[\d+\])*(?:\.\w+(?:\[\d+\])*)*"
_STEP = re.compile(r"(\w+)|\[(\d+)\]")
_ASSIGNMENT = re.compile(rf"(?:^|(?<=\s))({_PATH})=")


def _first(path: str) -> str:
    return re.split(r"[.\[]", path, maxsplit=1)[0]


def _from_ends(kind: wire.Kind, fields: dict[str, Any]) -> dict[str, Any]:
    """Returns fields by whole paths, where a path left out its beginning and is unique."""
    places: dict[str, list[str]] = {}
    for name, path in _named_inside(kind, ""):
        places.setdefault(name, []).append(path)
    direct = {member.name for member in kind.members} if isinstance(kind, wire.Record) else set()
    fields_by_path = {}
    for path, value in fields.items():
        first = _first(str(path))
        prefixes = [] if first in direct else places.get(first, [])
        fields_by_path[f"{prefixes[0]}{path}" if len(prefixes) == 1 else path] = value
    return fields_by_path


def _named_inside(kind: wire.Kind, before: str) -> Iterator[tuple[str, str]]:
    """Yields the names in records and bit fields, with the paths before them."""
    if isinstance(kind, wire.BitField):
        yield from ((group.name, before) for group in kind.groups)
    if isinstance(kind, wire.Record):
        for member in kind.members:
            yield member.name, before
            yield from _named_inside(member.kind, f"{before}{member.name}.")


def by_name(fields: dict[str, Any]) -> dict[str, Any]:
    """Returns fields in which names that are paths have become objects and lists."""
    nested_fields: dict[str, Any] = {}
    for path, value in fields.items():
        steps = [name or int(index) for name, index in _STEP.findall(str(path))]
        if len(steps) < 2 or not re.fullmatch(_PATH, str(path)):
            nested_fields[path] = value
            continue
        _put(nested_fields, steps, value, str(path))
    return nested_fields


def _put(holder: Any, steps: list[str | int], value: Any, path: str) -> None:
    """Puts a value where steps lead, and makes what is on the way."""
    for step, following in zip(steps, [*steps[1:], None], strict=True):
        inner = value if following is None else ([] if isinstance(following, int) else {})
        if isinstance(step, int) and isinstance(holder, list):
            if step > len(holder):
                raise EncodeError(f"element {len(holder)} is not given before", path)
            if step == len(holder):
                holder.append(inner)
        elif isinstance(step, str) and isinstance(holder, dict):
            holder.setdefault(step, inner)
        else:
            raise EncodeError("this contradicts another field", path)
        if following is None:
            holder[step] = value
        holder = holder[step]


def parse_fields(text: str) -> dict[str, Any]:
    """Returns fields from an object of JSON, or from `PATH=VALUE PATH=VALUE`, as they are shown.

    A value behind a path is JSON, or text up to the next path.

    Raises:
        ValueError: It is neither.
    """
    matches = list(_ASSIGNMENT.finditer(text))
    try:
        if matches and not text[: matches[0].start()].strip():
            return _assigned(text, matches)
        fields = json.loads(text)
    except json.JSONDecodeError as error:
        raise ValueError(f"the fields are no JSON: {error}") from error
    except RecursionError:
        raise ValueError("the fields are nested too deep") from None
    if not isinstance(fields, dict):
        raise ValueError('the fields must be a JSON object, e.g. {"AuthorityCode": 5}')
    return fields


def _assigned(text: str, matches: list[re.Match[str]]) -> dict[str, Any]:
    ends = [*(match.start() for match in matches[1:]), len(text)]
    return {
        match[1]: _value(text[match.end() : end].strip())
        for match, end in zip(matches, ends, strict=True)
    }


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text[1:-1] if text[:1] == text[-1:] == "'" and len(text) > 1 else text
