"""The bytes of a JAUS message, or of a part of one, put together of given values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.jaus_elements import numbers_of
from jausml_generators.bridge.flat.pieces import Bytes, Packed, Piece, joined
from jausml_generators.bridge.flat.protocols import Given, Place
from jausml_generators.bridge.flat.wire_items import (
    bit_field_item,
    default_item,
    item,
)
from jausml_generators.python.codec.classes import (
    BitFieldClass,
    ContainerClass,
    VariableFieldClass,
)
from jausml_generators.python.codec.compounds import (
    ArrayValue,
    ListValue,
    PartValue,
    VariantValue,
)
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.bridge.flat.jaus_wanted import Value
    from jausml_generators.python.codec.members import Member
    from jausml_generators.python.codec.messages import MessageView
    from jausml_generators.python.names import Scope


_STEP = " " * 4
_LETTERS = {1: "B", 2: "H", 4: "I", 8: "Q"}


class ListPieces(Protocol):
    """What has the elements of a list.

    Attributes:
        name: Local variable of their bytes, or of all of them together.
        error: Local variable of the error of an element that does not fit.
        is_vector: Whether the variable has the bytes of all.
        is_array: Whether it may be an array.
        is_sure: Whether it is one, and all of it fits.
    """

    name: str
    error: str
    is_vector: bool
    is_array: bool
    is_sure: bool


@dataclass
class Tree:
    """What is given to a message or element.

    Attributes:
        values: Values by path.
        made: Class names of optional parts and options of variants that are made, by path.
        lists: Lists that are given elements, by path.
    """

    values: dict[str, Given] = field(default_factory=dict)
    made: dict[str, str] = field(default_factory=dict)
    lists: dict[str, ListPieces] = field(default_factory=dict)

    def within(self, path: str) -> bool:
        """Whether anything is given at a path or inside it."""
        paths = (*self.values, *self.made, *self.lists)
        return any(each == path or each.startswith(f"{path}.") for each in paths)


class JausBlock:
    """Statements and pieces of a part of a message.

    Attributes:
        lines: What is done before the pieces are there.
        pieces: The pieces.
    """

    def __init__(
        self,
        message: MessageView,
        constants: Constants,
        scope: Scope,
        tree: Tree,
        option: Callable[[VariantValue, str], PartValue],
    ) -> None:
        self._message = message
        self._constants = constants
        self._scope = scope
        self._tree = tree
        self._option = option
        self._used: set[str] = set()
        self.places: dict[str, Place] = {}
        self.lines: list[str] = []
        self.pieces: list[Piece] = []

    def check_all_used(self) -> None:
        """Refuses values that the layout had no place for."""
        given = {*self._tree.values, *self._tree.lists, *self._tree.made}
        for path in sorted(given - self._used):
            raise NotFlatError(f"{path} is not where a flat form finds it")

    # -- containers ------------------------------------------------------------------------------

    def container(self, container: ContainerClass, path: str) -> None:
        """Adds a container: its presence vector, and its members that are there."""
        members = [(each, f"{path}.{each.attribute}".lstrip(".")) for each in container.members]
        there = [pair for pair in members if not pair[0].is_optional or self._is_there(pair[1])]
        sure = [member for member, place in there if not self._may_be_absent(member, place)]
        presence = f"0x{sum(member.bit for member in sure):X}"
        if len(sure) < len(there):
            name = self._scope.claim("presence")
            self.lines.append(f"{name} = {presence}")
            presence = name
        if container.presence_size:
            self.pieces.append(Packed(_LETTERS[container.presence_size], presence))
        for member, place in there:
            if self._may_be_absent(member, place):
                self._optional(member, place, presence)
            else:
                self.value(member.value, place, member.attribute)

    def _is_there(self, path: str) -> bool:
        return self._tree.within(path)

    def _may_be_absent(self, member: Member, path: str) -> bool:
        given = self._tree.values.get(path)
        return member.is_optional and given is not None and given.conditional

    def _optional(self, member: Member, path: str, presence: str) -> None:
        """Adds a member that is left out where its value is None."""
        given = self._tree.values[path]
        name = self._scope.claim(f"{member.attribute}_bytes")
        inner = JausBlock(self._message, self._constants, self._scope, self._tree, self._option)
        inner.value(member.value, path, member.attribute, is_given=True)
        self._used |= inner._used
        self.lines += [
            f'{name} = b""',
            f"if {given.code} is not None:",
            f"{_STEP}{presence} |= 0x{member.bit:X}",
            *(f"{_STEP}{line}" for line in inner.lines),
            f"{_STEP}{name} = {joined(inner.pieces, self._constants)}",
        ]
        self.pieces.append(Bytes(name))

    # -- values ----------------------------------------------------------------------------------

    def value(self, value: Value, path: str, attribute: str, *, is_given: bool = False) -> None:
        """Adds a value of any kind.

        Args:
            value: Its layout.
            path: Its path.
            attribute: Attribute that an error names.
            is_given: Whether it is known to be no None.
        """
        match value:
            case Fixed():
                self._fixed(value, path, attribute, is_given=is_given)
            case Blob():
                self._blob(value, path, attribute)
            case PartValue():
                self._part(value, path)
            case VariantValue():
                self._variant(value, path)
            case ListValue():
                self._list(value, path, attribute)
            case ArrayValue():
                self._array(value, path, attribute)

    def _fixed(self, value: Fixed, path: str, attribute: str, *, is_given: bool) -> None:
        bits = self._bit_field(value) if isinstance(value, Bits) else None
        given = self._given(path)
        if given is None and bits is not None and self._tree.within(path):
            self.pieces.append(Packed(value.format, self._parts_of(bits, path)))
            return
        default = default_item(value, bits, attribute)
        if given is None:
            self.pieces.append(Packed(value.format, default))
            return
        code = item(value, given.code, attribute)
        if given.conditional and not is_given:
            code = f"{default} if {given.code} is None else {code}"
        self.pieces.append(Packed(value.format, code))

    def _parts_of(self, bits: BitFieldClass, path: str) -> str:
        """The integer of a bit field whose parts are given."""
        codes = {}
        for sub in bits.sub_fields:
            given = self._given(f"{path}.{sub.attribute}")
            if given is None:
                continue
            code = given.code
            if given.conditional:
                code = self._scope.claim(sub.attribute)
                self.lines.append(f"{code} = {given.otherwise(sub.value.default)}")
            codes[sub.attribute] = code
        return bit_field_item(bits, codes)

    def _given(self, path: str) -> Given | None:
        self._used.add(path)
        return self._tree.values.get(path)

    def _bit_field(self, value: Fixed) -> BitFieldClass:
        return next(
            each
            for each in self._message.nested
            if isinstance(each, BitFieldClass) and each.path == value.python_type
        )

    def _blob(self, value: Blob, path: str, attribute: str) -> None:
        given = self._given(path)
        code = value.default if given is None else given.otherwise(value.default)
        name = self._scope.claim(f"{attribute}_bytes")
        field_text = python_string(attribute)
        self.lines.append(f"{name} = {code}")
        if value.is_text:
            # What is usual costs no function of Python, which all texts beyond ASCII do.
            others = f"latin1({name}, {field_text})"
            usual = f'{name}.encode("ascii")'
            self.lines.append(f"{name} = {usual} if {name}.isascii() else {others}")
        fits = f"{value.lower} <= len({name}) <= {value.upper}"
        size = f"len({name}) if {fits} else {value.sized(name, attribute)}"
        self.pieces.append(Packed(value.count_format, size))
        self.pieces.append(Bytes(name))

    def _part(self, value: PartValue, path: str) -> None:
        self._used.add(path)
        if isinstance(value.part, ContainerClass) and not value.part.is_format:
            self.container(value.part, path)
        elif isinstance(value.part, VariableFieldClass):
            self._variable(value.part, path)
        else:
            raise NotFlatError(f"{path} is a message inside the message")

    def _variable(self, part: VariableFieldClass, path: str) -> None:
        """Adds the index and the number of a variable field, which are given together."""
        index = self._given(f"{path}.index" if path else "index")
        number = self._given(f"{path}.value" if path else "value")
        if index is None or number is None:
            first = part.alternatives[0]
            chosen, code = first, first.value.default
        else:
            chosen = next(each for each in part.alternatives if str(each.index) == index.code)
            code = number.code
            if number.conditional:
                raise NotFlatError(f"{path} may have no value")
        self.pieces.append(Packed("B", str(chosen.index)))
        self.pieces.append(Packed(chosen.value.format, item(chosen.value, code, "value")))

    def _variant(self, value: VariantValue, path: str) -> None:
        self._used.add(path)
        option = self._option(value, path)
        tag = value.options.index(option)
        self.pieces.append(Packed(value.tag_format, str(tag)))
        self._part(option, path)

    def _list(self, value: ListValue, path: str, attribute: str) -> None:
        self._used.add(path)
        found = self._tree.lists.get(path)
        if found is None:
            self.pieces.append(Packed(value.count_format, "0"))
            return
        if found.is_vector:
            self.pieces.append(Packed(value.count_format, value.sized(found.name, attribute)))
            self.pieces.append(Bytes(found.name))
            return
        if found.is_sure:
            self.pieces.append(Packed(value.count_format, value.sized(found.name, attribute)))
            self.pieces.append(Bytes(f"{found.name}.tobytes()"))
            return
        text = f"EncodeError({python_string(attribute)}, str({found.error}))"
        self.lines += [
            f"if {found.error} is not None:",
            f"{_STEP}raise {text} from {found.error}",
        ]
        self.pieces.append(Packed(value.count_format, value.sized(found.name, attribute)))
        together = f'b"".join({found.name})'
        if found.is_array:
            test = f"isinstance({found.name}, list)"
            together = f"({together} if {test} else {found.name}.tobytes())"
        self.pieces.append(Bytes(together))

    def _array(self, value: ArrayValue, path: str, attribute: str) -> None:
        if self._tree.within(path):
            raise NotFlatError(f"{path} is an array")
        for _ in range(value.count):
            self.value(value.element, path, attribute)


class RecordBlock(JausBlock):
    """The pieces of an element whose values are columns.

    Attributes:
        places: Where each column is written.
    """

    def _fixed(self, value: Fixed, path: str, attribute: str, *, is_given: bool) -> None:
        given = self._tree.values.get(path)
        if given is None or not given.code.isidentifier():
            super()._fixed(value, path, attribute, is_given=is_given)
            return
        self._used.add(path)
        if given.code in self.places:
            raise NotFlatError(f"{path} is the same as another field")
        name = path.replace(".", "_") or attribute
        self.places[given.code] = Place(given.code, name, numbers_of(value))
        self.pieces.append(Packed(value.format, given.code))
