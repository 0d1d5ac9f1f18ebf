"""Statements that write a ROS message with given values as CDR (OMG DDSI-RTPS 10, XCDR1).

The bytes are little endian. A primitive type is aligned to its own size, counted from behind the
encapsulation; a structure without fields has one octet. What stands between sequences is packed by
one `struct.Struct`: a constant, or one of those that `CdrLayouts` keeps by length of texts.
"""

from __future__ import annotations

import ast
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from jausml.generation.literals import python_literal, python_string
from jausml.generators.bridge.flat.cdr_chunks import SIZES, Chunk, Start
from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.flat.limits import FINITE, SINGLE
from jausml.generators.bridge.flat.loops import loop_over
from jausml.generators.bridge.flat.pieces import bytes_literal
from jausml.generators.bridge.flat.protocols import Numbers, Place, Target
from jausml.generators.bridge.flat.vectors import NUMBERS
from jausml.generators.bridge.translation.ros_fields import full_name
from jausml.generators.python.names import snake_case
from jausml.generators.python.statements import call, tuple_of
from jausml.metamodel.classes import ros

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.generators.bridge.flat.constants import Constants
    from jausml.generators.python.names import Scope

INDENT = " " * 4
_LETTERS = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
# What stands before a message: XCDR1, little endian.
_ENCAPSULATION = "256"
_MISFITS = "(struct.error, TypeError, AttributeError, OverflowError, UnicodeEncodeError)"


@dataclass(frozen=True)
class _Number:
    """A number, or several in a row.

    Attributes:
        path: Its path; that of the array for several.
        letter: Its letter in struct formats.
        defaults: Its value in a message as it is made; as many as there are.
    """

    path: str
    letter: str
    defaults: tuple[str, ...]


@dataclass(frozen=True)
class _Text:
    """A string.

    Attributes:
        path: Its path.
        bound: Most characters; 0 when nothing limits it.
        default: Its value in a message as it is made.
    """

    path: str
    bound: int
    default: str


@dataclass(frozen=True)
class _Many:
    """A sequence, or an array of what is no number.

    Attributes:
        path: Its path.
        field: The field, whose elements these are.
        bound: Most elements; 0 when nothing limits them.
    """

    path: str
    field: ros.Field
    bound: int


_Leaf: TypeAlias = "_Number | _Text | _Many"


def _leaves(message_type: ros.MessageType, prefix: str = "") -> Iterator[_Leaf]:
    """Yields what a message consists of, in the order of the bytes."""
    if not message_type.fields:
        yield _Number(f"{prefix}structure_needs_at_least_one_member", "B", ("0",))
    for each in message_type.fields:
        yield from _field(each, f"{prefix}{each.name}")


def _field(each: ros.Field, path: str) -> Iterator[_Leaf]:
    kind, size = each.arrayKind.name, int(each.arraySize)
    if kind in {"boundedSequence", "unboundedSequence"}:
        yield _Many(path, each, size if kind == "boundedSequence" else 0)
    elif kind == "single":
        yield from _single(each, path, _default(each))
    elif isinstance(each, ros.PrimitiveField) and each.type.name in _LETTERS:
        letter = _LETTERS[each.type.name]
        given = _default(each)
        values = given if isinstance(given, list) else [None] * size
        yield _Number(path, letter, tuple(_number(letter, value) for value in values))
    else:
        given = _default(each)
        for index in range(size):
            default = given[index] if isinstance(given, list) else None
            yield from _single(each, f"{path}[{index}]", default)


def _single(each: ros.Field, path: str, default: object) -> Iterator[_Leaf]:
    """Yields what one value of a field consists of; `default` is its own, or None."""
    if isinstance(each, ros.MessageField):
        yield from _leaves(each.messageType, f"{path}." if path else "")
    elif isinstance(each, ros.PrimitiveField) and each.type.name == "string":
        yield _Text(path, int(each.stringBound), str(default or ""))
    elif isinstance(each, ros.PrimitiveField) and each.type.name in _LETTERS:
        letter = _LETTERS[each.type.name]
        yield _Number(path, letter, (_number(letter, default),))
    else:
        raise NotFlatError(f"{path} is a wide string")


def _default(each: ros.Field) -> object:
    """The default value of a field in Python; None when it has none."""
    text = getattr(each, "defaultValue", None)
    if not text or not isinstance(each, ros.PrimitiveField):
        return None
    is_text = each.type.name == "string" and each.arrayKind.name == "single"
    return text if is_text else json.loads(text)


def _number(letter: str, value: object) -> str:
    if letter == "?":
        return python_literal(bool(value))
    if letter in "fd":
        return python_literal(float(value or 0.0))  # type: ignore[arg-type]
    return python_literal(int(value or 0))  # type: ignore[call-overload]


@dataclass(frozen=True)
class _Given:
    """What has the value of a field.

    Attributes:
        code: A local variable or a literal.
        conditional: Whether it is None where the field is given no value.
    """

    code: str
    conditional: bool

    def otherwise(self, default: str) -> str:
        """Returns the value, or the default where it is None, as Python text."""
        return (
            f"{default} if {self.code} is None else {self.code}" if self.conditional else self.code
        )


@dataclass
class _Values:
    """What is given to a message or to an element of a sequence.

    Attributes:
        name: Full name of the message type.
        leaves: What it consists of.
        constants: The constants of the module.
        scope: The names of the function.
        values: Values by path.
        lists: Sequences that are given elements, by path.
    """

    name: str
    leaves: tuple[_Leaf, ...]
    constants: Constants
    scope: Scope
    values: dict[str, _Given] = field(default_factory=dict)
    lists: dict[str, CdrSequenceWriting] = field(default_factory=dict)

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value of a field.

        Args:
            path: The field; `.` for an element itself.
            expression: A local variable or a literal, as Python text. Numbers of an array are any
                sequence.
            conditional: Whether it is None where the field is given no value.

        Raises:
            NotFlatError: There is no such field.
        """
        own = "" if path == "." else path
        whole, _, index = own.rpartition("[")
        paths = {each.path: each for each in self.leaves}
        leaf = paths.get(own) or (paths.get(whole) if index else None)
        if leaf is None or (own not in paths and not isinstance(leaf, _Number)):
            raise NotFlatError(f"{self.name} has no {path} that a flat form writes")
        self.values[own] = _Given(expression, conditional)

    def make(self, path: str, class_name: str) -> None:
        """Refuses: ROS messages are complete as they are made."""
        raise NotFlatError(f"{path} is made as {class_name}")

    def sequence(self, path: str) -> CdrSequenceWriting:
        """Tells that a sequence is given elements.

        Raises:
            NotFlatError: There is no such sequence.
        """
        leaf = next((each for each in self.leaves if each.path == path), None)
        if not isinstance(leaf, _Many) or path in self.lists:
            raise NotFlatError(f"{path} is no sequence that a flat form writes")
        found = CdrSequenceWriting(self.name, leaf, self.constants, self.scope)
        self.lists[path] = found
        return found

    def given(self, leaf: _Number) -> list[str]:
        """Returns the values of numbers."""
        whole = self.values.get(leaf.path)
        if len(leaf.defaults) == 1:
            return [whole.otherwise(leaf.defaults[0]) if whole else leaf.defaults[0]]
        if whole is not None:
            return [f"*{whole.code}"]
        found = [self.values.get(f"{leaf.path}[{index}]") for index in range(len(leaf.defaults))]
        pairs = zip(found, leaf.defaults, strict=True)
        return [each.otherwise(default) if each else default for each, default in pairs]


class CdrWriting(_Values):
    """Writes a ROS message.

    Args:
        message_type: Its type.
        constants: The constants of the module.
        scope: The names of the function.
    """

    def __init__(self, message_type: ros.MessageType, constants: Constants, scope: Scope) -> None:
        super().__init__(full_name(message_type), tuple(_leaves(message_type)), constants, scope)

    def lines(self) -> list[str]:
        """Returns the statements that make the bytes, with the return at their end."""
        walk = _Walk(self.name, self.constants, self.scope)
        walk.chunk.add("I", _ENCAPSULATION)
        walk.write(self)
        return [
            "try:",
            *(INDENT + line for line in walk.end()),
            f"except {_MISFITS} as error:",
            f"{INDENT}raise EncodeError({python_string(self.name)}, str(error)) from error",
        ]


class CdrSequenceWriting:
    """Writes a sequence.

    Attributes:
        element: Writes one element.
        leaf: The sequence.
        rows: The variable of the values of its elements, or of all of them at once.
        is_vector: Whether it has all of them at once, as bytes.
    """

    def __init__(self, name: str, leaf: _Many, constants: Constants, scope: Scope) -> None:
        self.leaf = leaf
        self.rows = scope.claim(snake_case(leaf.path.rpartition(".")[2]))
        self.is_vector = False
        self.is_array = False
        self.is_sure = False
        self.constants = constants
        self.records = self.text = ""
        inner = tuple(_single(leaf.field, "", None))
        self.element = _Values(name, inner, constants, scope)

    def begin(self) -> list[str]:
        """Returns the statements before the first element."""
        return [f"{self.rows}: Any = []" if self.is_array else f"{self.rows} = []"]

    def append(self) -> list[str]:
        """Returns the statements that add the element whose values are known."""
        values = [value for _, value in self.row]
        row = values[0] if len(values) == 1 else f"({', '.join(values)})"
        return [f"{self.rows}.append({row})"]

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers."""
        limits = {"f": SINGLE, "d": FINITE}.get(self.letter or "")
        if limits is None:
            raise NotFlatError(f"{self.leaf.path} has no real numbers")
        return Numbers("", self.letter or "", "{}", *limits)

    def columns(self, values: Mapping[str, str]) -> Target:
        """Returns how elements are written whose values are columns."""
        if self.letter is not None:
            (variable,) = values.values()
            return Target(self.rows, "", (Place(variable, "", _numbers(self.letter)),))
        fields, places, texts = [], [], []
        for leaf in self.element.leaves:
            if isinstance(leaf, _Text):
                code = values.get(leaf.path, python_string(leaf.default))
                texts.append(code)
                fields.append(tuple_of('""', '"s"', "0"))
                continue
            if not isinstance(leaf, _Number) or len(leaf.defaults) > 1:
                raise NotFlatError(f"{self.leaf.path} has more than numbers")
            code = values.get(leaf.path, leaf.defaults[0])
            is_known = _literal(code) is not None
            name = "" if is_known else snake_case(leaf.path.replace(".", "_"))
            if name:
                places.append(Place(code, name, _numbers(leaf.letter)))
            usual = code if is_known else "0"
            fields.append(tuple_of(python_string(name), python_string(leaf.letter), usual))
        last = self.element.leaves[-1]
        if len(texts) > 1 or not isinstance(last, _Number) or SIZES[last.letter] != 8:
            raise NotFlatError(f"{self.leaf.path} has elements that do not lie alike")
        self.records = self.constants.named("_RECORDS", call("CdrRecords", *fields))
        self.text = "".join(f", {each}" for each in texts)
        return Target(self.rows, f"{self.records}.make({{}}{self.text})", tuple(places))

    def take_array(self, *, is_sure: bool = False) -> str:
        """Returns the variable of the elements, which may be an array from now on."""
        self.is_array, self.is_sure = True, is_sure
        return self.rows

    def vector(self, expression: str) -> None:
        """Tells what has all elements, numbers of one type, at once.

        Args:
            expression: A local variable of a contiguous buffer, little endian, whose length is
                the number of elements: an array of numpy, or bytes.
        """
        if self.letter is None:
            raise NotFlatError(f"{self.leaf.path} is no sequence of numbers")
        self.rows, self.is_vector = expression, True

    @property
    def octet(self) -> str | None:
        """The path of the number, which is the element, when that is one octet; None for others."""
        return "" if self.letter in {"b", "B"} else None

    @property
    def letter(self) -> str | None:
        """Letter of the elements in struct formats; None when they are no numbers."""
        (first, *others) = self.element.leaves
        is_number = isinstance(self.leaf.field, ros.PrimitiveField) and not others
        return first.letter if isinstance(first, _Number) and is_number else None

    @property
    def row(self) -> list[tuple[str, str]]:
        """Paths of the elements that differ from one to the next, and their values."""
        defaults = {
            f"{leaf.path}[{i}]" if len(leaf.defaults) > 1 else leaf.path: default
            for leaf in self.element.leaves
            if isinstance(leaf, _Number)
            for i, default in enumerate(leaf.defaults)
        } | {e.path: python_string(e.default) for e in self.element.leaves if isinstance(e, _Text)}
        return [
            (path, given.otherwise(defaults.get(path, "()")))
            for path, given in self.element.values.items()
            if given.conditional or _literal(given.code) is None
        ]


def _numbers(letter: str) -> Numbers:
    """Returns numbers as structs take them; of double precision they take all."""
    if letter == "d":
        return Numbers("", letter)
    if letter == "f":
        return Numbers("", letter, "{}", *SINGLE)
    if letter not in NUMBERS:
        raise NotFlatError(f"{letter} has no columns")
    bits = 8 * SIZES[letter]
    least, most = (-(2 ** (bits - 1)), 2 ** (bits - 1)) if letter.islower() else (0, 2**bits)
    return Numbers("", letter, "{}", str(least), str(most - 1), is_rounded=True)


def _literal(code: str) -> object:
    """Returns the value of a literal; None for other expressions."""
    try:
        return ast.literal_eval(code)
    except (ValueError, SyntaxError):
        return None


class _Walk:
    """Writes the statements in the order of the bytes.

    Args:
        name: Full name of the message type.
        constants: The constants of the module.
        scope: The names of the function.
    """

    def __init__(self, name: str, constants: Constants, scope: Scope) -> None:
        self._name = name
        self._constants = constants
        self._scope = scope
        self._out = ""
        self.lines: list[str] = []
        # The encapsulation stands before the place that alignment counts from.
        self.chunk = Chunk(Start(8, 4))

    def end(self) -> list[str]:
        """Returns the statements, with the return at their end."""
        if not self._out:
            return [*self.lines, f"return {self._packed()}"]
        self.flush()
        return [*self.lines, f"return bytes({self._out})"]

    def write(self, values: _Values) -> None:
        """Writes a message or an element."""
        for leaf in values.leaves:
            match leaf:
                case _Number():
                    self._numbers(leaf, values)
                case _Text():
                    self._text(leaf, values)
                case _Many():
                    self._many(leaf, values)

    # -- what is packed --------------------------------------------------------------------------

    def _packed(self) -> str:
        """Returns the expression of the bytes of the present chunk."""
        where = f"len({self._out}) + 4 & 7"
        return self.chunk.packed(self._constants, where)

    def flush(self) -> None:
        """Adds the bytes of the present chunk to those of the message."""
        if self._out and self.chunk.items:
            self.lines.append(f"{self._out} += {self._packed()}")
        elif not self._out:
            packed = self._packed()
            self._out = self._scope.claim("out")
            self.lines.append(f"{self._out} = bytearray({packed})")

    def _numbers(self, leaf: _Number, values: _Values) -> None:
        given = values.given(leaf)
        if given[0].startswith("*"):
            self._count_is(given[0][1:], leaf.path, f"!= {len(leaf.defaults)}")
            self.chunk.add(leaf.letter, given[0], len(leaf.defaults))
            return
        for code in given:
            self.chunk.add(leaf.letter, code)

    def _text(self, leaf: _Text, values: _Values) -> None:
        given = values.values.get(leaf.path)
        literal = leaf.default if given is None else _literal(given.code)
        if isinstance(literal, str):
            self.chunk.add_text(bytes_literal(literal.encode()), len(literal.encode()))
            return
        assert given is not None  # noqa: S101 - what has no value is a literal
        local = self._scope.claim(f"{snake_case(leaf.path.rpartition('.')[2]) or 'text'}_text")
        code = given.otherwise(python_string(leaf.default))
        code = f"({code})" if given.conditional else code
        if leaf.bound:
            self._count_is(code, leaf.path, f"> {leaf.bound}")
        self.lines.append(f"{local} = {code}.encode()")
        self.chunk.add_text(local)

    def _count_is(self, code: str, path: str, wrong: str) -> None:
        """Refuses a number of elements or characters."""
        text = f'str(len({code})) + " of them do not fit"'
        self.lines += [
            f"if len({code}) {wrong}:",
            f"{INDENT}raise EncodeError({python_string(path)}, {text})",
        ]

    # -- sequences -------------------------------------------------------------------------------

    def _many(self, leaf: _Many, values: _Values) -> None:
        sequence = values.lists.get(leaf.path)
        given = values.values.get(leaf.path)
        if sequence is None and given is not None:
            sequence = CdrSequenceWriting(self._name, leaf, self._constants, self._scope)
            self.lines.append(f"{sequence.rows} = {given.otherwise('()')}")
            sequence.is_vector = sequence.letter == "B"
            sequence.element.put(".", "item")
        if sequence is None:
            default = _default(leaf.field)
            if default:
                raise NotFlatError(f"{leaf.path} is not empty in a message as it is made")
            self.chunk.add("I", "0")
            return
        if leaf.bound:
            self._count_is(sequence.rows, leaf.path, f"> {leaf.bound}")
        self.chunk.add("I", f"len({sequence.rows})")
        self.flush()
        if sequence.letter is not None:
            self._vector(sequence, sequence.letter)
        else:
            self._rows(sequence)

    def _vector(self, sequence: CdrSequenceWriting, letter: str) -> None:
        size, rows = SIZES[letter], sequence.rows
        if size > 4:
            self.lines += [
                f"if len({rows}) > 0:",
                f"{INDENT}{self._out} += bytes(4 - len({self._out}) & 7)",
            ]
        packed = f"memoryview({rows})"
        if not sequence.is_vector:
            packed = f'struct.pack(f"<{{len({rows})}}{letter}", *{rows})'
        if sequence.is_sure:
            packed = f"{rows}.tobytes()"
        elif sequence.is_array:
            packed = f"{packed} if isinstance({rows}, list) else {rows}.tobytes()"
        self.lines.append(f"{self._out} += {packed}")
        self.chunk = Chunk(Start(min(size, 4), 0))

    def _rows(self, sequence: CdrSequenceWriting) -> None:
        """Writes elements one by one."""
        row = sequence.row
        names = {path: self._scope.claim(_word(path)) for path, _ in row}
        values = _Values(self._name, sequence.element.leaves, self._constants, self._scope)
        values.values = {
            path: _Given(names.get(path, given.code), conditional=False)
            for path, given in sequence.element.values.items()
        }
        if sequence.element.lists:
            raise NotFlatError(f"{sequence.leaf.path} has elements with sequences")
        start = Start(4, 0)
        if _alignment(sequence.element.leaves[0]) == 8:
            start = Start(8, 0)
            gap = f"bytes(4 - len({self._out}) & 7)"
            any_rows = f"isinstance({sequence.rows}, list) and {sequence.rows}"
            test = any_rows if sequence.records else sequence.rows
            self.lines += [f"if {test}:", f"{INDENT}{self._out} += {gap}"]
        inner = self._elements(values, start)
        if not inner.chunk.ends_at(start):
            inner = self._elements(values, Start(1, 0))
        inner.flush()
        targets = ", ".join(names[path] for path, _ in row)
        loop = loop_over(sequence.rows, targets, "", self._scope)
        loop += [INDENT + line for line in inner.lines]
        if sequence.records:
            put = f"{sequence.records}.put({sequence.rows}, {self._out}{sequence.text})"
            head = f"if isinstance({sequence.rows}, list):"
            loop = [head, *(INDENT + line for line in loop), "else:", INDENT + put]
        self.lines += loop
        self.chunk = Chunk(start if inner.chunk.ends_at(start) else Start(1, 0))
        if start.modulus == 8:
            self.chunk = Chunk(Start(4, 0) if inner.chunk.ends_at(start) else Start(1, 0))

    def _elements(self, values: _Values, start: Start) -> _Walk:
        walk = _Walk(self._name, self._constants, self._scope)
        walk._out, walk.chunk = self._out, Chunk(start)
        walk.write(values)
        return walk


def _word(path: str) -> str:
    return snake_case("_".join(path.replace("[", "_").replace("]", "").split(".")[-2:]) or "item")


def _alignment(leaf: _Leaf) -> int:
    return SIZES[leaf.letter] if isinstance(leaf, _Number) else 4
