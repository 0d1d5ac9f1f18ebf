"""Statements that write a ROS message with given values as CDR (OMG DDSI-RTPS 10, XCDR1).

The bytes are little endian. A primitive type is aligned to its own size, counted from behind the
encapsulation; a structure without fields has one octet. What stands between sequences is packed by
one `struct.Struct`: a constant, or one of those that `CdrLayouts` keeps by length of texts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.cdr_chunks import SIZES, Chunk, Start
from jausml_generators.bridge.flat.cdr_leaves import (
    ManyLeaf,
    NumberLeaf,
    TextLeaf,
    WrittenLeaf,
    default_of,
    written_leaves,
)
from jausml_generators.bridge.flat.cdr_values import (
    CdrSequenceWriting,
    CdrValues,
    literal_of,
)
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.loops import loop_over
from jausml_generators.bridge.flat.pieces import bytes_literal
from jausml_generators.bridge.flat.protocols import Given
from jausml_generators.bridge.translation.ros_fields import full_name
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import ros
    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.python.names import Scope


INDENT = " " * 4


# What stands before a message: XCDR1, little endian.
_ENCAPSULATION = "256"


_MISFITS = "(struct.error, TypeError, AttributeError, OverflowError, UnicodeEncodeError)"


class CdrWriting(CdrValues):
    """Writes a ROS message.

    Args:
        message_type: Its type.
        constants: The constants of the module.
        scope: The names of the function.
    """

    def __init__(self, message_type: ros.MessageType, constants: Constants, scope: Scope) -> None:
        leaves = tuple(written_leaves(message_type))
        super().__init__(full_name(message_type), leaves, constants, scope)

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

    def write(self, values: CdrValues) -> None:
        """Writes a message or an element."""
        for leaf in values.leaves:
            match leaf:
                case NumberLeaf():
                    self._numbers(leaf, values)
                case TextLeaf():
                    self._text(leaf, values)
                case ManyLeaf():
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

    def _numbers(self, leaf: NumberLeaf, values: CdrValues) -> None:
        given = values.given(leaf)
        if given[0].startswith("*"):
            self._count_is(given[0][1:], leaf.path, f"!= {len(leaf.defaults)}")
            self.chunk.add(leaf.letter, given[0], len(leaf.defaults))
            return
        for code in given:
            self.chunk.add(leaf.letter, code)

    def _text(self, leaf: TextLeaf, values: CdrValues) -> None:
        given = values.values.get(leaf.path)
        literal = leaf.default if given is None else literal_of(given.code)
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

    def _many(self, leaf: ManyLeaf, values: CdrValues) -> None:
        sequence = values.lists.get(leaf.path)
        given = values.values.get(leaf.path)
        if sequence is None and given is not None:
            sequence = CdrSequenceWriting(self._name, leaf, self._constants, self._scope)
            self.lines.append(f"{sequence.rows} = {given.otherwise('()')}")
            sequence.is_vector = sequence.letter == "B"
            sequence.element.put(".", "item")
        if sequence is None:
            default = default_of(leaf.field)
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
        values = CdrValues(self._name, sequence.element.leaves, self._constants, self._scope)
        values.values = {
            path: Given(names.get(path, given.code), conditional=False)
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

    def _elements(self, values: CdrValues, start: Start) -> _Walk:
        walk = _Walk(self._name, self._constants, self._scope)
        walk._out, walk.chunk = self._out, Chunk(start)
        walk.write(values)
        return walk


def _word(path: str) -> str:
    return snake_case("_".join(path.replace("[", "_").replace("]", "").split(".")[-2:]) or "item")


def _alignment(leaf: WrittenLeaf) -> int:
    return SIZES[leaf.letter] if isinstance(leaf, NumberLeaf) else 4
