"""Writes a JAUS message with given values as bytes (SAE AS5684)."""

from __future__ import annotations

import ast
import struct
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias

from jausml.generation.literals import python_string
from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.flat.jaus_reading import number_of, octet_of
from jausml.generators.bridge.flat.pieces import Bytes, Packed, Piece, bytes_literal, joined
from jausml.generators.bridge.flat.protocols import Numbers, Place, Target
from jausml.generators.bridge.flat.vectors import NUMBERS
from jausml.generators.bridge.flat.wire_items import (
    bit_field_item,
    default_item,
    item,
    scaled_position,
)
from jausml.generators.python.codec.classes import (
    BitFieldClass,
    ContainerClass,
    VariableFieldClass,
)
from jausml.generators.python.codec.compounds import (
    ArrayValue,
    ListValue,
    PartValue,
    VariantValue,
)
from jausml.generators.python.codec.scalars import Bits, Blob, Fixed
from jausml.generators.python.statements import tuple_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.generators.bridge.flat.constants import Constants
    from jausml.generators.python.codec.members import Member
    from jausml.generators.python.codec.messages import MessageView
    from jausml.generators.python.names import Scope

_STEP = " " * 4
_MISFITS = "struct.error, TypeError, AttributeError, OverflowError"
Value: TypeAlias = Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue
_LETTERS = {1: "B", 2: "H", 4: "I", 8: "Q"}


@dataclass(frozen=True)
class _Given:
    """What has the value of a field.

    Attributes:
        code: A local variable or a literal.
        conditional: Whether it is None where the field is given no value.
    """

    code: str
    conditional: bool


@dataclass
class _Tree:
    """What is given to a message or element.

    Attributes:
        values: Values by path.
        made: Class names of optional parts and options of variants that are made, by path.
        lists: Lists that are given elements, by path.
    """

    values: dict[str, _Given] = field(default_factory=dict)
    made: dict[str, str] = field(default_factory=dict)
    lists: dict[str, JausSequenceWriting] = field(default_factory=dict)

    def within(self, path: str) -> bool:
        """Whether anything is given at a path or inside it."""
        paths = (*self.values, *self.made, *self.lists)
        return any(each == path or each.startswith(f"{path}.") for each in paths)


class _Writing:
    """Takes what is given to a message or to an element of a list."""

    def __init__(self, message: MessageView, constants: Constants, scope: Scope) -> None:
        self._message = message
        self._constants = constants
        self._scope = scope
        self._tree = _Tree()

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value of a field."""
        self._tree.values[path] = _Given(expression, conditional)

    def make(self, path: str, class_name: str) -> None:
        """Tells that an optional part, or an option of a variant, is made."""
        self._tree.made[path] = class_name

    def sequence(self, path: str) -> JausSequenceWriting:
        """Tells that a list is given elements."""
        if path in self._tree.lists:
            raise NotFlatError(f"{path} is given elements twice")
        value = self._value_at(path)
        if not isinstance(value, ListValue):
            raise NotFlatError(f"{path} is no list")
        name = self._scope.claim(path.rpartition(".")[2])
        found = JausSequenceWriting(self._message, value, name, self._constants, self._scope)
        self._tree.lists[path] = found
        return found

    def _value_at(self, path: str) -> Value:
        """What the layout has at a path of attributes."""
        value, place = self._root(), ""
        for step in path.split("."):
            place = f"{place}.{step}".lstrip(".")
            members = self._members(value, place.rpartition(".")[0])
            found = next((each for each in members if each.attribute == step), None)
            if found is None:
                raise NotFlatError(f"{path} is not where a flat form finds it")
            value = found.value
        return value

    def _members(self, value: Value, path: str) -> Sequence[Member]:
        if isinstance(value, VariantValue):
            value = self._option(value, path)
        if isinstance(value, PartValue) and isinstance(value.part, ContainerClass):
            return value.part.members
        return ()

    def _option(self, value: VariantValue, path: str) -> PartValue:
        """The option of a variant that is made: the first one, unless another is said."""
        name = self._tree.made.get(path)
        if name is None:
            return value.options[0]
        return next(each for each in value.options if each.python_type == name)

    def _root(self) -> Value:
        return PartValue(self._message.body, self._message.class_name)

    def _block(self) -> _Block:
        return _Block(self._message, self._constants, self._scope, self._tree, self._option)


class JausWriting(_Writing):
    """Writes a whole message.

    Args:
        message: The message.
        constants: Constants of the module.
        scope: Names of local variables.
    """

    def lines(self) -> Sequence[str]:
        """Returns the statements that make the bytes, with the return at their end."""
        block = self._block()
        block.pieces.append(Packed("H", self._message.code_text))
        block.container(self._message.body, "")
        block.check_all_used()
        inner = [*block.lines, f"return {joined(block.pieces, self._constants)}"]
        name = python_string(self._message.jaus_name)
        return [
            "try:",
            *(f"{_STEP}{line}" for line in inner),
            f"except ({_MISFITS}) as error:",
            f"{_STEP}raise EncodeError({name}, str(error)) from error",
        ]


class JausSequenceWriting:
    """Writes a list.

    Attributes:
        value: Its layout.
        name: Local variable that has the bytes of all elements.
        error: Local variable of the error of an element that does not fit. It is raised when the
            message is put together, as a codec would: the elements behind it are translated first.
        element: Writes one element.
    """

    def __init__(
        self,
        message: MessageView,
        value: ListValue,
        name: str,
        constants: Constants,
        scope: Scope,
    ) -> None:
        self.value = value
        self.name = name
        self.is_vector = False
        self.is_array = False
        self.is_sure = False
        self.error = scope.claim(f"{name}_error")
        self.element = _ElementWriting(message, value.element, self, constants, scope)

    def begin(self) -> Sequence[str]:
        """Returns the statements before the first element."""
        kind = ": Any" if self.is_array else ""
        return [f"{self.name}{kind} = []", f"{self.error} = None"]

    def append(self) -> Sequence[str]:
        """Returns the statements that add the element whose values are known."""
        return [*self.element.lines()]

    @property
    def octet(self) -> str | None:
        """Path of the number in an element that is one octet; None for other elements."""
        return octet_of(self.value.element)

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers."""
        path, element = number_of(self.value.element)
        return replace(numbers_of(element), path=path)

    def columns(self, values: Mapping[str, str]) -> Target:
        """Returns how elements are written whose values are columns."""
        return self.element.columns(values, self.name)

    def take_array(self, *, is_sure: bool = False) -> str:
        """Returns the variable of the elements, which may be an array from now on."""
        self.is_array, self.is_sure = True, is_sure
        return self.name

    def vector(self, expression: str) -> None:
        """Tells what has all elements as they stand on the wire, which are octets."""
        if self.octet is None:
            raise NotFlatError(f"{expression} is not written at once")
        self.name, self.is_vector = expression, True


class _ElementWriting(_Writing):
    """Writes an element of a list."""

    def __init__(
        self,
        message: MessageView,
        value: Value,
        sequence: JausSequenceWriting,
        constants: Constants,
        scope: Scope,
    ) -> None:
        super().__init__(message, constants, scope)
        self._element = value
        self._sequence = sequence

    def _root(self) -> Value:
        return self._element

    def columns(self, values: Mapping[str, str], variable: str) -> Target:
        """Returns how elements are written whose values are columns.

        Args:
            values: What has them, by path.
            variable: What gets the records.
        """
        given = {path: _Given(code, conditional=False) for path, code in values.items()}
        tree = _Tree(given, dict(self._tree.made))
        block = _RecordBlock(self._message, self._constants, self._scope, tree, self._option)
        block.value(self._element, "", variable)
        block.check_all_used()
        if block.lines or not all(isinstance(each, Packed) for each in block.pieces):
            raise NotFlatError(f"{variable} has more than numbers")
        pieces = [each for each in block.pieces if isinstance(each, Packed)]
        layout, names, template = "<", [], b""
        for piece in pieces:
            is_column = piece.code in block.places
            size = struct.calcsize(f"<{piece.letter}")
            layout += piece.letter if is_column else f"{size}x"
            names += [python_string(block.places[piece.code].name)] if is_column else []
            number = 0 if is_column else _literal(piece.code)
            template += struct.pack(f"<{piece.letter}", number)
        kind = f"record({self._constants.struct(layout)}, {tuple_of(*names)})"
        record = self._constants.named("_RECORD", kind)
        usual = f"bytearray({bytes_literal(template)}) * {{}}"
        made = f"numpy.frombuffer({usual}, {record})"
        return Target(variable, made, tuple(block.places.values()))

    def lines(self) -> Sequence[str]:
        """Returns the statements that add the bytes of the element to those of the list."""
        block = self._block()
        sequence = self._sequence
        block.value(self._element, "", sequence.name)
        block.check_all_used()
        inner = [*block.lines, f"{sequence.name}.append({joined(block.pieces, self._constants)})"]
        return [
            "try:",
            *(f"{_STEP}{line}" for line in inner),
            f"except (EncodeError, {_MISFITS}) as error:",
            f"{_STEP}{sequence.error} = error",
        ]


class _Block:
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
        tree: _Tree,
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
        inner = _Block(self._message, self._constants, self._scope, self._tree, self._option)
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
                default = sub.value.default
                self.lines.append(f"{code} = {default} if {given.code} is None else {given.code}")
            codes[sub.attribute] = code
        return bit_field_item(bits, codes)

    def _given(self, path: str) -> _Given | None:
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
        code = given.code if given is not None else value.default
        if given is not None and given.conditional:
            code = f"{value.default} if {given.code} is None else {given.code}"
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


class _RecordBlock(_Block):
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


def numbers_of(value: Fixed) -> Numbers:
    """Returns the numbers that a value may be.

    Args:
        value: What kind of value it is.

    Raises:
        NotFlatError: It is no number, or one that double precision does not hold.
    """
    if isinstance(value, Bits) and value.format in NUMBERS:
        most = 2 ** (8 * value.size) - 1
        return Numbers("", value.format, "{}", "0", str(most), is_rounded=True)
    if value.format not in NUMBERS or value.offset or value.reader:
        raise NotFlatError(f"{value.python_type} has no columns")
    if value.check == "scaled":
        _, _, maximum = value.limits
        position = scaled_position(value, "{}")
        return Numbers("", value.format, position, "0.0", maximum, is_rounded=True)
    if value.check not in {"real", "integer"}:
        raise NotFlatError(f"{value.python_type} has no columns")
    lower, upper = value.limits
    is_rounded = value.check == "integer"
    return Numbers("", value.format, "{}", lower, upper, is_rounded=is_rounded)


def _literal(code: str) -> float:
    """Returns the number that a Python text is."""
    try:
        found = ast.literal_eval(code)
    except (ValueError, SyntaxError):
        found = None
    if not isinstance(found, int | float):
        raise NotFlatError(f"{code} is no number")
    return found
