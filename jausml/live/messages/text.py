"""Messages and their definitions for people, a line for each field, and values to begin with."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, SupportsInt

from jausml.language import wire
from jausml.live.messages.codec import TAG
from jausml.live.messages.counted import MESSAGE
from jausml.live.messages.entries import DecodedMessage, EmbeddedMessage, MessageEntry
from jausml.live.messages.errors import DefinitionError
from jausml.live.messages.values import in_units, integers_in_words
from jausml.live.messages.walking import parts

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import jaus

_INDENT = "  "
_SHOWN_OCTETS = 32
_SHOWN_ELEMENTS = 64


def title(decoded: DecodedMessage) -> str:
    """Returns the first line of a message: its name, code and service."""
    return f"{decoded.entry.name} {decoded.entry.code_text} ({decoded.service.label})"


def lines(decoded: DecodedMessage) -> Iterator[str]:
    """Yields the fields of a message, indented by depth."""
    for member in decoded.entry.record.members:
        yield from _field(member.name, member.kind, decoded.fields[member.name], "")


def _field(name: str, kind: wire.Kind, value: Any, indent: str) -> Iterator[str]:
    match kind:
        case wire.List() | wire.Array():
            yield from _elements(name, kind.element.kind, value, indent)
        case wire.Record() | wire.Variant():
            yield f"{indent}{name}" + (f": {value[TAG]}" if isinstance(kind, wire.Variant) else "")
            for step, inner, part in parts(kind, value):
                yield from _field(step, inner, part, indent + _INDENT)
        case wire.Octets() | wire.FormattedOctets():
            yield f"{indent}{name}: {_octets(kind, value)}"
            yield from _message(value.get(MESSAGE), indent + _INDENT)
        case _:
            yield f"{indent}{name}: {simple(kind, value)}"


def _elements(name: str, kind: wire.Kind, value: Sequence[Any], indent: str) -> Iterator[str]:
    head = f"{indent}{name}[{len(value)}]"
    if isinstance(kind, wire.Number | wire.FixedText):
        shown = ", ".join(simple(kind, item) for item in value[:_SHOWN_ELEMENTS])
        yield f"{head}: {shown}" + (", ..." if len(value) > _SHOWN_ELEMENTS else "")
        return
    yield head
    for index, item in enumerate(value):
        yield from _field(f"[{index}]", kind, item, indent + _INDENT)


def _message(embedded: EmbeddedMessage | None, indent: str) -> Iterator[str]:
    """Yields the message that stands in a field."""
    if embedded is None:
        return
    if embedded.decoded is None:
        yield f"{indent}{MESSAGE}: {embedded['error']}"
        return
    yield f"{indent}{title(embedded.decoded)}"
    yield from (f"{indent}{_INDENT}{line}" for line in lines(embedded.decoded))


def simple(kind: wire.Scalar | wire.Text | wire.VariableNumber, value: Any) -> str:
    """Returns a decoded value that has no fields inside, with its unit or its name."""
    match kind:
        case wire.Integer():
            return in_units(named(kind.legal, value), kind.units)
        case wire.Scaled():
            decimals = max(0, 1 - math.floor(math.log10(kind.step)))
            return in_units(f"{value:.{decimals}f}", kind.units)
        case wire.Real():
            return in_units(repr(value), kind.units)
        case wire.BitField():
            return ", ".join(
                f"{group.name} {named(group.legal, value[group.name])}" for group in kind.groups
            )
        case wire.VariableNumber():
            return simple(kind.by_index[value["index"]], value["value"])
        case wire.Text() | wire.FixedText():
            # What a terminal would obey instead of showing it is escaped.
            return f'"{value if value.isprintable() else ascii(value)[1:-1]}"'


def named(legal: wire.LegalIntegers, value: SupportsInt) -> str:
    """Returns an integer with its name, if it has one, e.g. `1 (READY)`."""
    number = int(value)
    return f"{number} ({legal.names[number]})" if number in legal.names else str(number)


def _octets(kind: wire.Octets | wire.FormattedOctets, value: Mapping[str, Any]) -> str:
    if isinstance(kind, wire.Octets):
        name = kind.content
    else:
        name = kind.names.get(int(value["format"]), f"format {value['format']}")
    digits: str | None = value.get("hex")
    if digits is None:
        return name
    shown = digits[: 2 * _SHOWN_OCTETS] + ("..." if len(digits) > 2 * _SHOWN_OCTETS else "")
    return f"{len(digits) // 2} bytes of {name} {shown}".rstrip()


@dataclass(frozen=True)
class Row:
    """One field of a message.

    Attributes:
        path: Its path, as errors of `encode` name it; `[]` stands for an element.
        legal: Its legal values, in words; empty when all that the type can say are legal, and when
            `names` say it.
        presence: `optional` when a presence vector says whether it is there, `option 0` and so on
            in a variant, else empty.
        markers: By which values a ROS field says that it has none, in words.
    """

    path: str
    depth: int
    type: str
    legal: str = ""
    units: str = ""
    presence: str = ""
    names: Mapping[int, str] | None = None
    documentation: str = ""
    markers: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The last step of the path."""
        return self.path.rpartition(".")[2]

    def to_json(self) -> dict[str, Any]:
        """Returns the known facts as JSON, without empty ones."""
        content = {
            "path": self.path,
            "type": self.type,
            "legal": self.legal,
            "units": self.units,
            "presence": self.presence or "always",
            "names": {str(value): name for value, name in (self.names or {}).items()},
            "documentation": self.documentation,
            "markers": list(self.markers),
        }
        return {key: value for key, value in content.items() if value}


def rows(entry: MessageEntry) -> list[Row]:
    """Returns the fields of a message from the outermost inwards."""
    return _rows_of(lambda: entry.layout)


def paths_of(entry: MessageEntry) -> list[str]:
    """Returns the paths of the values of a message, without the one record of a body.

    Elements of lists are those of the first one.
    """
    all_rows = rows(entry)
    body = f"{all_rows[0].path}." if all_rows and all_rows[0].type.startswith("record") else ""
    # The number of a variable field needs no path of its own: its unit tells the index.
    whole = [row for row in all_rows if not row.presence.startswith("index ")]
    paths = [row.path.removeprefix(body).replace("[]", "[0]") for row in whole]
    outer = {path.rpartition(".")[0].removesuffix("[0]") for path in paths}
    return [path for path in paths if path not in outer and f"{path}." != body]


def rows_of(definition: jaus.MessageDef) -> list[Row]:
    """Returns the fields of a definition from the outermost inwards, as `rows` does."""
    return _rows_of(lambda: wire.resolve(definition))


def _rows_of(layout: Callable[[], wire.Message]) -> list[Row]:
    try:
        body = layout().body
    except wire.LayoutError as error:
        raise DefinitionError(error.reason, error.path) from None
    return [] if body is None else list(_rows(body, "", 0))


def _rows(field: wire.Field, before: str, depth: int, presence: str = "") -> Iterator[Row]:
    path = f"{before}.{field.name}" if before else field.name
    presence = presence or ("optional" if field.is_optional else "")
    kind = field.kind
    row = Row(path, depth, "", presence=presence, documentation=field.documentation)
    yield _typed(row, kind)
    match kind:
        case wire.Record():
            for member in kind.members:
                yield from _rows(member, path, depth + 1)
        case wire.List() | wire.Array():
            yield from _list_rows(kind.element, f"{path}[]", depth + 1)
        case wire.Variant():
            for tag, option in enumerate(kind.options):
                yield from _rows(option, path, depth + 1, f"option {tag}")
        case wire.BitField():
            for bits in kind.groups:
                yield _bits(bits, path, depth + 1)
        case wire.VariableNumber():
            for alternative in kind.alternatives:
                part = Row(f"{path}.value", depth + 1, "", presence=f"index {alternative.index}")
                yield _typed(part, alternative.number)
        case _:
            pass  # a leaf


def _list_rows(element: wire.Field, path: str, depth: int) -> Iterator[Row]:
    """Yields the rows of an element; a record is named by its members alone."""
    kind = element.kind
    if isinstance(kind, wire.Record):
        for member in kind.members:
            yield from _rows(member, path, depth)
        return
    yield _typed(Row(path, depth, "", documentation=element.documentation), kind)
    if isinstance(kind, wire.List | wire.Array):
        yield from _list_rows(kind.element, f"{path}[]", depth + 1)


def _typed(row: Row, kind: wire.Kind) -> Row:
    """Returns the row with its type and its legal values."""
    known: dict[str, Any] = {"type": _type(kind)}
    match kind:
        case wire.Integer():
            known |= _integers(kind.legal) | {"units": kind.units}
        case wire.Real():
            known |= {"units": kind.units}
            if kind.legal.intervals:
                known["legal"] = f"{kind.legal.lower!r} .. {kind.legal.upper!r}"
        case wire.Scaled():
            legal = f"{kind.lower!r} .. {kind.upper!r}, step {kind.step:.3g}"
            known |= {"units": kind.units, "legal": legal}
        case wire.FormattedOctets():
            known["names"] = {data_format.index: data_format.name for data_format in kind.formats}
        case _:
            pass  # its type says all
    if known.get("units") == "one":
        known["units"] = ""
    return Row(**{**vars(row), **known})


def _integers(legal: wire.LegalIntegers) -> dict[str, Any]:
    if not legal.is_stated:
        return {}
    words = "" if legal.is_closed else integers_in_words(legal.ranges, most=None)
    return {"legal": words, "names": legal.names}


def _bits(bits: wire.Bits, path: str, depth: int) -> Row:
    span = f"bit {bits.low}" if bits.low == bits.high else f"bits {bits.low} to {bits.high}"
    legal = _integers(bits.legal)
    return Row(f"{path}.{bits.name}", depth, span, documentation=bits.documentation, **legal)


def _type(kind: wire.Kind) -> str:  # noqa: C901 - a branch for each kind
    match kind:
        case wire.Integer() | wire.Real():
            return kind.type.name
        case wire.Scaled():
            return f"scaled {kind.type.name}"
        case wire.BitField():
            return f"bit field {kind.type.name}"
        case wire.Record():
            return "record" + (f" with presence {kind.presence.name}" if kind.presence else "")
        case wire.List():
            return f"list of {kind.count.lower} to {kind.count.upper}"
        case wire.Array():
            return f"array of {' x '.join(map(str, kind.dimensions))}"
        case wire.Variant():
            return "variant"
        case wire.FixedText():
            return f"text of {kind.length} bytes"
        case wire.Text():
            return f"text of {kind.count.lower} to {kind.count.upper} bytes"
        case wire.Octets():
            return f"bytes of {kind.content}" if kind.content else "bytes"
        case wire.FormattedOctets():
            return "format and bytes"
        case wire.VariableNumber():
            return "index and value"


def sample(kind: wire.Kind) -> Any:
    """Returns a legal value in the shape that `MessageEntry.encode` takes.

    Numbers are the smallest legal ones (0 if legal), optional members are left out, lists are as
    short as they may be.
    """
    return _Sampler(is_full=False).value(kind)


def example(entry: MessageEntry) -> dict[str, Any]:
    """Returns legal fields of a message, as an example.

    As `sample`, but with optional members, an element in each list, and values by their names.
    """
    fields: dict[str, Any] = _Sampler(is_full=True).value(entry.record)
    return fields


@dataclass(frozen=True)
class _Sampler:
    """Maker of values for fields."""

    is_full: bool

    def value(self, kind: wire.Kind) -> Any:
        match kind:
            case wire.Record():
                return self._record(kind)
            case wire.List():
                least = max(kind.count.lower, min(1, kind.count.upper) if self.is_full else 0)
                return [self.value(kind.element.kind) for _ in range(least)]
            case wire.Array():
                return [self.value(kind.element.kind) for _ in range(kind.length)]
            case wire.Variant():
                first = kind.options[:1]
                return {TAG: 0, **{option.name: self.value(option.kind) for option in first}}
            case _:
                return self._leaf(kind)

    def _record(self, kind: wire.Record) -> dict[str, Any]:
        # A definition may have more optional members than its vector has bits.
        most = kind.presence.upper if kind.presence is not None and self.is_full else 0
        return {
            member.name: self.value(member.kind) for member in kind.members if member.bit <= most
        }

    def _leaf(self, kind: wire.Leaf) -> Any:
        match kind:
            case wire.Integer():
                return self._integer(kind.legal)
            case wire.Scaled():
                return min(max(0.0, kind.lower), kind.upper)
            case wire.Real():
                return min(max(0.0, kind.legal.lower), kind.legal.upper)
            case wire.BitField():
                return {group.name: self._integer(group.legal) for group in kind.groups}
            case wire.Octets():
                return {"hex": bytes(kind.count.lower).hex()}
            case wire.FormattedOctets():
                return {"format": min(kind.names), "hex": bytes(kind.count.lower).hex()}
            case wire.VariableNumber():
                index, number = min(kind.by_index.items(), key=lambda item: item[0])
                return {"index": index, "value": self.value(number)}
            case wire.Text():
                return " " * kind.count.lower
            case wire.FixedText():
                return ""

    def _integer(self, legal: wire.LegalIntegers) -> int | str:
        names = legal.names
        known = list(names.values())
        telling = (
            names[value]
            for value in sorted(names)
            if known.count(names[value]) == 1 and not names[value].lower().startswith("reserved")
        )
        legal_zero = any(low <= 0 <= high for low, high in legal.ranges)
        number = 0 if legal_zero else legal.ranges[0][0]
        return next(telling, number) if self.is_full else number
