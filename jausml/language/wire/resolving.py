"""Resolution of message definitions to layouts: the one walk over field kinds."""

from __future__ import annotations

import math
from collections.abc import Iterable

from jausml.language.metamodel.classes import jaus
from jausml.language.wire import kinds
from jausml.language.wire.numbers import (
    INTEGERS,
    REALS,
    UNSIGNED,
    Integer,
    IntegerType,
    LayoutError,
    LimitError,
    Number,
    Real,
    Scaled,
)
from jausml.language.wire.value_sets import legal_integers, legal_reals

LARGEST = 4 << 20
"""Most bytes of a text and elements of an array: larger messages are not put together."""

MAXIMUM_DEPTH = 64
"""Most containers around a field."""

MOST_FIELDS = 10_000
"""Most fields of a message, each as often as types that hold it are used: types double quickly."""

_BYTE = UNSIGNED["uint8"]


def resolve(message: jaus.MessageDef) -> kinds.Message:
    """Returns the layout of a message."""
    owner = message.eContainer()
    try:
        body = resolve_field(message.body) if message.body is not None else None
    except LayoutError as error:
        raise error.inside(str(message.name)) from None
    return kinds.Message(
        name=str(message.name),
        code=int(str(message.code), 16),
        is_command=bool(message.isCommand),
        body=body,
        documentation=str(message.documentation or ""),
        service=str(owner.urn) if isinstance(owner, jaus.Service) else "",
    )


def resolve_field(field: jaus.Field) -> kinds.Field:
    """Returns the layout of a field with all that stands in it."""
    layout = _Resolver().field(field)
    _check_values(layout.kind)
    return layout


def target_of(field: jaus.Field | None) -> jaus.Field | None:
    """Returns the field that a reference stands for; None for a dangling one or a circle."""
    seen = set()
    while isinstance(field, jaus.TypeReference):
        if field in seen:
            return None
        seen.add(field)
        field = field.target
    return field


def leaf_of(part: jaus.Field | jaus.Alternative) -> kinds.Leaf | None:
    """Returns the kind of a field that holds no other fields; None for a container.

    Args:
        part: A field that is no reference, or an alternative of a variable field.
    """
    match part:
        case jaus.FixedField() | jaus.Alternative():
            return _number(part)
        case jaus.BitField():
            return _bit_field(part)
        case jaus.FixedLengthString():
            return _fixed_text(part)
        case jaus.VariableLengthString():
            return kinds.Text(_length(part))
        case jaus.VariableLengthField():
            return kinds.Octets(_length(part), str(part.format))
        case jaus.VariableFormatField():
            return _formatted(part)
        case jaus.VariableField():
            return _variable(part)
    return None


class _Resolver:
    """Resolves one message; a declared type that occurs twice is resolved once."""

    def __init__(self) -> None:
        self._open: list[jaus.Field] = []
        self._known: dict[jaus.Field, kinds.Kind] = {}
        self._sizes: dict[jaus.Field, int] = {}
        self._count = 0

    def field(self, element: jaus.Field, bit: int = 0) -> kinds.Field:
        """Returns a field in its place; errors tell the path to it."""
        target = target_of(element)
        try:
            if target is None:
                raise LayoutError("the type reference leads to no type")
            if target not in self._known:
                before = self._count
                self._known[target] = self._entered(target)
                self._sizes[target] = self._count - before
            else:
                self._count += self._sizes[target]
            self._count += 1
            if self._count > MOST_FIELDS:
                raise LimitError(f"the message has more than {MOST_FIELDS} fields")
        except LayoutError as error:
            raise error.inside(str(element.name)) from None
        text = element.documentation or target.documentation
        return kinds.Field(str(element.name), str(text or ""), self._known[target], bit)

    def _entered(self, target: jaus.Field) -> kinds.Kind:
        if target in self._open:
            raise LayoutError("it contains itself")
        if len(self._open) >= MAXIMUM_DEPTH:
            raise LimitError(f"it is nested deeper than {MAXIMUM_DEPTH}")
        self._open.append(target)
        kind = self._kind(target)
        self._open.pop()
        return kind

    def _kind(self, target: jaus.Field) -> kinds.Kind:
        match target:
            case jaus.Record():
                return kinds.Record(*self._members(target))
            case jaus.Sequence():
                return kinds.Sequence(*self._members(target))
            case jaus.List():
                return self._list(target)
            case jaus.Array():
                return self._array(target)
            case jaus.Variant():
                options = tuple(self.field(option) for option in target.options)
                return kinds.Variant(_unsigned(target.tagType.name), options)
        leaf = leaf_of(target)
        if leaf is None:
            raise LayoutError(f"a {target.eClass.name} has no layout")
        return leaf

    def _members(
        self, group: jaus.Record | jaus.Sequence
    ) -> tuple[tuple[kinds.Field, ...], IntegerType | None]:
        """Returns the members of a group, and the type of its presence vector."""
        width = group.presenceVector.name
        if width == "none":
            return tuple(self.field(field) for field in group.fields), None
        members, bit = [], 1
        for field in group.fields:
            members.append(self.field(field, bit if field.optional else 0))
            bit <<= bool(field.optional)
        return tuple(members), _unsigned(width)

    def _list(self, field: jaus.List) -> kinds.List:
        # JAUS-DEVIATION: AS5684 also states a smallest count; components made with the JAUS Tool
        # Set send shorter lists (QueryServiceList without a subsystem), and mean them.
        count = _count(field.countType, 0, field.maximumCount)
        return kinds.List(self._element(field), count, int(field.minimumCount))

    def _array(self, field: jaus.Array) -> kinds.Array:
        sizes = tuple(int(size) for size in field.dimensions)
        if any(size < 1 for size in sizes) or math.prod(sizes) > LARGEST:
            raise LayoutError(f"dimensions {list(sizes)} make no array")
        array = kinds.Array(self._element(field), sizes)
        _check_values(array)
        return array

    def _element(self, field: jaus.List | jaus.Array) -> kinds.Field:
        if field.element is None:
            raise LayoutError("it has no element")
        return self.field(field.element)


def _check_values(kind: kinds.Kind) -> None:
    if _values(kind) > LARGEST:
        raise LimitError(f"its smallest instance has more than {LARGEST} values")


def _values(kind: kinds.Kind) -> int:
    """Returns how many values a field of a kind has when lists and texts are as short as stated."""
    match kind:
        case kinds.Record():
            return max(1, sum(_values(member.kind) for member in kind.members))
        case kinds.Array():
            return kind.length * _values(kind.element.kind)
        case kinds.Variant():
            return max((_values(option.kind) for option in kind.options), default=1)
        case kinds.List():
            return max(1, kind.stated * _values(kind.element.kind))
        case kinds.Text() | kinds.Octets() | kinds.FormattedOctets():
            return max(1, kind.count.lower)
        case kinds.FixedText():
            return max(1, kind.length)
    return 1


def _number(part: jaus.FixedField | jaus.Alternative) -> Number:
    type_name, units = part.type.name, str(part.units or "")
    if type_name in REALS:
        real = REALS[type_name]
        return Real(real, legal_reals(part.values, real), units)
    kind = INTEGERS[type_name]
    if part.scale is None:
        return Integer(kind, legal_integers(part.values, kind.lower, kind.upper), units)
    lower, upper = float(part.scale.lower), float(part.scale.upper)
    if not lower < upper or not kind.is_unsigned:
        raise LayoutError(f"{lower} .. {upper} is no scale of {type_name}")
    return Scaled(kind, lower, upper, part.scale.rounding.name, units)


def _unsigned(type_name: str) -> IntegerType:
    """Returns the type of a count, tag, presence vector or bit field."""
    if type_name not in UNSIGNED:
        raise LayoutError(f"{type_name} is no unsigned integer")
    return UNSIGNED[type_name]


def _length(
    field: jaus.VariableLengthString | jaus.VariableLengthField | jaus.VariableFormatField,
) -> kinds.Count:
    return _count(field.countType, field.minimumLength, field.maximumLength)


def _count(count_type: jaus.NumericType, least: int, most: int) -> kinds.Count:
    """Returns a count; an upper limit of 0 means all that its type can say."""
    kind = _unsigned(count_type.name)
    return kinds.Count(kind, int(least), min(int(most), kind.upper) if most > 0 else kind.upper)


def _bit_field(field: jaus.BitField) -> kinds.BitField:
    whole = _unsigned(field.type.name)
    groups = []
    for sub in field.subFields:
        low, high = int(sub.lowBit), int(sub.highBit)
        if not 0 <= low <= high < whole.bits:
            raise LayoutError(f"bits {low} .. {high} do not fit the type", str(sub.name))
        legal = legal_integers(sub.values, 0, (1 << high - low + 1) - 1)
        groups.append(kinds.Bits(str(sub.name), str(sub.documentation or ""), low, high, legal))
    return kinds.BitField(whole, tuple(groups))


def _fixed_text(field: jaus.FixedLengthString) -> kinds.FixedText:
    length = int(field.length)
    if not 0 <= length <= LARGEST:
        raise LayoutError(f"a length of {length} bytes has no meaning")
    return kinds.FixedText(length)


def _formatted(field: jaus.VariableFormatField) -> kinds.FormattedOctets:
    formats = tuple(kinds.Format(int(form.index), str(form.name)) for form in field.formats)
    _check_indices("formats", (data_format.index for data_format in formats))
    return kinds.FormattedOctets(formats, _length(field))


def _variable(field: jaus.VariableField) -> kinds.VariableNumber:
    alternatives = tuple(
        kinds.Alternative(
            int(alternative.index),
            str(alternative.name),
            str(alternative.documentation or ""),
            _number(alternative),
        )
        for alternative in field.alternatives
    )
    _check_indices("alternatives", (alternative.index for alternative in alternatives))
    return kinds.VariableNumber(alternatives)


def _check_indices(what: str, indices: Iterable[int]) -> None:
    numbers = tuple(indices)
    if not numbers or not all(_BYTE.lower <= index <= _BYTE.upper for index in numbers):
        raise LayoutError(f"the indices of its {what} do not lie in 0 .. {_BYTE.upper}")
