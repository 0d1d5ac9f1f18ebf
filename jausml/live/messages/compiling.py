"""From the definition of a message in a model to its codec, once for each message."""

from __future__ import annotations

import math
from math import prod
from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import Counted, FormattedOctets, Octets, Text, VariableNumber
from jausml.live.messages.containers import PRESENCE, TAG, Array, List, Member, Record, Variant
from jausml.live.messages.errors import DefinitionError
from jausml.live.messages.scalars import BitField, Bits, FixedText, Integer, Ranges, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from jausml.live.messages.blobs import EncodeMessage
    from jausml.live.messages.codec import Codec, Scalar

_FORMATS = {
    "uint8": "B",
    "int8": "b",
    "uint16": "H",
    "int16": "h",
    "uint32": "I",
    "int32": "i",
    "uint64": "Q",
    "int64": "q",
    "float32": "f",
    "float64": "d",
}
_REAL_LIMITS = {"float32": 3.4028234663852886e38, "float64": 1.7976931348623157e308}
_MAXIMUM_DEPTH = 64
_MAXIMUM_ELEMENTS = 1 << 20


def compile_message(definition: Any, encode_message: EncodeMessage) -> Record:
    """Returns the codec of a message's body: an object with the body field, or an empty one.

    Args:
        definition: A MessageDef of the model.
        encode_message: Encodes messages that stand in it.

    Raises:
        DefinitionError: The definition gives no codec.
    """
    try:
        return _Compiler(encode_message).body(definition)
    except DefinitionError as error:
        raise error.inside(str(definition.name)) from None


def resolve(element: Any) -> Any:
    """Returns what a field of a model is after its type references, which keep their own name.

    Args:
        element: A Field of the model.

    Raises:
        DefinitionError: The references lead nowhere or in a circle.
    """
    target, seen = element, set()
    while target is not None and target.eClass.name == "TypeReference":
        if target in seen:
            raise DefinitionError("the type reference refers to itself")
        seen.add(target)
        target = target.target
    if target is None:
        raise DefinitionError("the type reference has no target")
    return target


class _Compiler:
    """Compiles one message."""

    def __init__(self, encode_message: EncodeMessage) -> None:
        self._encode_message = encode_message
        self._open: list[Any] = []
        self._kinds: dict[str, Callable[[Any], Codec]] = {
            "FixedField": _number,
            "VariableField": _variable_number,
            "BitField": _bit_field,
            "FixedLengthString": _fixed_text,
            "VariableLengthString": lambda field: Text(_counted_bytes(field)),
            "VariableLengthField": self._octets,
            "VariableFormatField": self._formatted_octets,
            "Record": self._record,
            "Sequence": self._record,
            "List": self._list,
            "Array": self._array,
            "Variant": self._variant,
        }

    def body(self, definition: Any) -> Record:
        if definition.body is None:
            return Record(())
        return Record([Member(str(definition.body.name), self._field(definition.body))])

    def _field(self, element: Any) -> Codec:
        """Returns the codec of a field; errors tell the path to it."""
        try:
            target = resolve(element)
            if target in self._open:
                raise DefinitionError("it contains itself")
            if len(self._open) >= _MAXIMUM_DEPTH:
                raise DefinitionError(f"it is nested deeper than {_MAXIMUM_DEPTH}")
            self._open.append(target)
            codec = self._kinds[target.eClass.name](target)
            self._open.pop()
        except DefinitionError as error:
            raise error.inside(str(element.name)) from None
        return codec

    def _record(self, field: Any) -> Record:
        names = _distinct(field.fields, PRESENCE)
        width = _name(field.presenceVector)
        if width == "none":
            pairs = zip(names, field.fields, strict=True)
            return Record([Member(name, self._field(element)) for name, element in pairs])
        members, bit = [], 1
        for name, element in zip(names, field.fields, strict=True):
            members.append(Member(name, self._field(element), bit if element.optional else 0))
            bit <<= bool(element.optional)
        return Record(members, _unsigned(width))

    def _list(self, field: Any) -> List:
        # JAUS-DEVIATION: AS5684 also states a smallest count; components made with the JAUS Tool
        # Set send shorter lists (QueryServiceList without a subsystem), and mean them.
        counted = _counted(field, 0, int(field.maximumCount))
        return List(self._element(field), counted)

    def _array(self, field: Any) -> Array:
        count = prod(int(size) for size in field.dimensions)
        if any(size < 1 for size in field.dimensions) or count > _MAXIMUM_ELEMENTS:
            raise DefinitionError(f"dimensions {list(field.dimensions)} make no array")
        return Array(self._element(field), count)

    def _element(self, field: Any) -> Codec:
        if field.element is None:
            raise DefinitionError("it has no element")
        return self._field(field.element)

    def _variant(self, field: Any) -> Variant:
        names = _distinct(field.options, TAG)
        options = [(n, self._field(o)) for n, o in zip(names, field.options, strict=True)]
        return Variant(_unsigned(_name(field.tagType)), options)

    def _octets(self, field: Any) -> Octets:
        return Octets(_counted_bytes(field), str(field.format), self._encode_message)

    def _formatted_octets(self, field: Any) -> FormattedOctets:
        formats = {int(each.index): str(each.name) for each in field.formats}
        if not formats or not all(0 <= index <= 255 for index in formats):
            raise DefinitionError("the indices of its formats do not lie in 0 .. 255")
        return FormattedOctets(formats, _counted_bytes(field), self._encode_message)


def _name(literal: Any) -> str:
    """Returns the name of an enumeration literal; a default is a plain string."""
    return str(getattr(literal, "name", literal))


def _distinct(elements: Iterable[Any], reserved: str) -> list[str]:
    names = [str(element.name) for element in elements]
    for name in names:
        if name == reserved or names.count(name) > 1:
            raise DefinitionError(f"the name '{name}' is taken twice")
    return names


def _limits(numeric_type: str) -> tuple[int, int]:
    """Returns the smallest and the largest integer of a wire type."""
    bits = int(numeric_type.removeprefix("u").removeprefix("int"))
    if numeric_type.startswith("u"):
        return 0, (1 << bits) - 1
    return -(1 << bits - 1), (1 << bits - 1) - 1


def _unsigned(numeric_type: str) -> Integer:
    """Returns the codec of a tag or presence vector."""
    if not numeric_type.startswith("u"):
        raise DefinitionError(f"{numeric_type} is no unsigned integer")
    return Integer(_FORMATS[numeric_type], (_limits(numeric_type),))


def _counted_bytes(field: Any) -> Counted:
    return _counted(field, int(field.minimumLength), int(field.maximumLength))


def _counted(field: Any, least: int, most: int) -> Counted:
    """Returns the count of a field; an upper limit of 0 means all that the count can say."""
    count_type = _unsigned(_name(field.countType))
    largest = count_type.ranges[0][1]
    return Counted(count_type.format, least, min(most, largest) if most > 0 else largest)


def _number(field: Any) -> Scalar:
    """Returns the codec of a fixed field or of an alternative of a variable field."""
    numeric_type, units = _name(field.type), str(field.units or "")
    if numeric_type in _REAL_LIMITS:
        return Real(_FORMATS[numeric_type], *_real_limits(numeric_type, field.values), units)
    if field.scale is not None:
        lower, upper = float(field.scale.lower), float(field.scale.upper)
        if not lower < upper or not numeric_type.startswith("u"):
            raise DefinitionError(f"{lower} .. {upper} is no scale of {numeric_type}")
        return Scaled(_FORMATS[numeric_type], lower, upper, _name(field.scale.rounding), units)
    ranges = _ranges(field.values, *_limits(numeric_type))
    return Integer(_FORMATS[numeric_type], ranges, _value_names(field.values), units)


def _values(value_set: Any) -> Sequence[Any]:
    return () if value_set is None else tuple(value_set.values)


def _ranges(value_set: Any, lower: int, upper: int) -> Ranges:
    """Returns the legal integers; a value set without any that fit the type says nothing."""
    found = []
    for value in _values(value_set):
        if value.eClass.name == "EnumeratedValue":
            first = last = int(value.value)
        else:
            first = math.ceil(value.lower) if value.lowerInclusive else math.floor(value.lower) + 1
            last = math.floor(value.upper) if value.upperInclusive else math.ceil(value.upper) - 1
        first, last = max(first, lower), min(last, upper)
        if first <= last:
            found.append((first, last))
    merged: list[tuple[int, int]] = []
    for first, last in sorted(found):
        if merged and first <= merged[-1][1] + 1:
            merged[-1] = (merged[-1][0], max(last, merged[-1][1]))
        else:
            merged.append((first, last))
    return tuple(merged) or ((lower, upper),)


def _value_names(value_set: Any) -> dict[int, str]:
    """Returns the names of listed values; of several names of one value the first."""
    names: dict[int, str] = {}
    for value in _values(value_set):
        if value.eClass.name == "EnumeratedValue":
            names.setdefault(int(value.value), str(value.name))
    return names


def _real_limits(numeric_type: str, value_set: Any) -> tuple[float, float]:
    """Returns the outer limits of the ranges of a value set; a set of single reals has no use."""
    values = _values(value_set)
    if not values or any(value.eClass.name != "ValueRange" for value in values):
        return -_REAL_LIMITS[numeric_type], _REAL_LIMITS[numeric_type]
    lower = min(float(value.lower) for value in values)
    upper = max(float(value.upper) for value in values)
    if numeric_type == "float32":
        # A limit that is not a single is met by the single next to it.
        single = Real("f", -math.inf, math.inf).struct
        lower = min(lower, single.unpack(single.pack(lower))[0])
        upper = max(upper, single.unpack(single.pack(upper))[0])
    return lower, upper


def _variable_number(field: Any) -> VariableNumber:
    alternatives = {int(each.index): _number(each) for each in field.alternatives}
    if not alternatives or not all(0 <= index <= 255 for index in alternatives):
        raise DefinitionError("the indices of its alternatives do not lie in 0 .. 255")
    return VariableNumber(alternatives)


def _bit_field(field: Any) -> BitField:
    whole = _unsigned(_name(field.type))
    names = _distinct(field.subFields, "")
    groups = []
    for name, sub in zip(names, field.subFields, strict=True):
        low, high = int(sub.lowBit), int(sub.highBit)
        if not 0 <= low <= high < 8 * whole.minimum_size:
            raise DefinitionError(f"bits {low} .. {high} do not fit the type", name)
        mask = (1 << high - low + 1) - 1
        groups.append(Bits(name, low, mask, _ranges(sub.values, 0, mask), _value_names(sub.values)))
    return BitField(whole.format, groups)


def _fixed_text(field: Any) -> FixedText:
    length = int(field.length)
    if not 0 <= length <= _MAXIMUM_ELEMENTS:
        raise DefinitionError(f"a length of {length} bytes has no meaning")
    return FixedText(length)
