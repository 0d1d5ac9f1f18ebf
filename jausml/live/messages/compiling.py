"""Compiler from the layout of a message to its codec, run once for each message."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language import wire
from jausml.live.messages.blobs import Counted, FormattedOctets, Octets, Text, VariableNumber
from jausml.live.messages.containers import PRESENCE, TAG, Array, List, Member, Record, Variant
from jausml.live.messages.errors import DefinitionError
from jausml.live.messages.scalars import BitField, Bits, FixedText, Integer, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes import jaus
    from jausml.live.messages.blobs import EncodeMessage
    from jausml.live.messages.codec import Codec, Scalar


def compile_message(definition: jaus.MessageDef, encode_message: EncodeMessage) -> Record:
    """Returns the codec of a message's body: an object with the body field, or an empty one.

    Args:
        definition: The message.
        encode_message: Encodes messages that stand in it.

    Raises:
        DefinitionError: The definition gives no codec.
    """
    try:
        body = wire.resolve(definition).body
    except wire.LayoutError as error:
        raise DefinitionError(error.reason, error.path) from None
    if body is None:
        return Record(())
    try:
        return Record([_Compiler(encode_message).member(body)])
    except DefinitionError as error:
        raise error.inside(str(definition.name)) from None


class _Compiler:
    """Compiles one message."""

    def __init__(self, encode_message: EncodeMessage) -> None:
        self._encode_message = encode_message

    def member(self, field: wire.Field) -> Member:
        """Returns a field by its name; errors tell the path to it."""
        try:
            return Member(field.name, self._codec(field.kind), field.bit)
        except DefinitionError as error:
            raise error.inside(field.name) from None

    def _codec(self, kind: wire.Kind) -> Codec:  # noqa: C901 - a branch for each kind
        match kind:
            case wire.Record():
                _check_distinct((each.name for each in kind.members), PRESENCE)
                presence = _unsigned(kind.presence) if kind.presence else None
                return Record([self.member(each) for each in kind.members], presence)
            case wire.List():
                return List(self.member(kind.element).codec, _counted(kind.count))
            case wire.Array():
                return Array(self.member(kind.element).codec, kind.length)
            case wire.Variant():
                _check_distinct((each.name for each in kind.options), TAG)
                options = [self.member(each)[:2] for each in kind.options]
                return Variant(_unsigned(kind.tag), options)
            case wire.Text():
                return Text(_counted(kind.count))
            case wire.Octets():
                return Octets(_counted(kind.count), kind.content, self._encode_message)
            case wire.FormattedOctets():
                formats = {each.index: each.name for each in kind.formats}
                return FormattedOctets(formats, _counted(kind.count), self._encode_message)
            case wire.VariableNumber():
                return VariableNumber({a.index: _number(a.number) for a in kind.alternatives})
            case wire.BitField():
                return _bit_field(kind)
            case wire.FixedText():
                return FixedText(kind.length)
            case wire.Integer() | wire.Real() | wire.Scaled():
                return _number(kind)


def _check_distinct(names: Iterable[str], reserved: str) -> None:
    seen = {reserved}
    for name in names:
        if name in seen:
            raise DefinitionError(f"the name '{name}' is taken twice")
        seen.add(name)


def _unsigned(kind: wire.IntegerType) -> Integer:
    """Returns the codec of a tag or presence vector."""
    return Integer(kind.format, ((kind.lower, kind.upper),))


def _counted(count: wire.Count) -> Counted:
    return Counted(count.type.format, count.lower, count.upper)


def _number(kind: wire.Number) -> Scalar:
    struct_format = kind.type.format
    match kind:
        case wire.Integer():
            legal = kind.legal
            return Integer(struct_format, legal.ranges, legal.names, kind.units, legal.offset)
        case wire.Real():
            return Real(struct_format, kind.legal.lower, kind.legal.upper, kind.units)
        case wire.Scaled():
            return Scaled(struct_format, kind.lower, kind.upper, kind.rounding, kind.units)


def _bit_field(kind: wire.BitField) -> BitField:
    _check_distinct((each.name for each in kind.groups), "")
    groups = [
        Bits(each.name, each.low, each.mask, legal.ranges, legal.names, legal.offset)
        for each in kind.groups
        for legal in [each.legal]
    ]
    return BitField(kind.type.format, groups)
