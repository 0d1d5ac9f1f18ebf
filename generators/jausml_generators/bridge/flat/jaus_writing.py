"""Writes a JAUS message with given values as bytes (SAE AS5684)."""

from __future__ import annotations

import ast
import struct
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.jaus_elements import number_of, numbers_of, octet_of
from jausml_generators.bridge.flat.jaus_pieces import JausBlock, RecordBlock, Tree
from jausml_generators.bridge.flat.pieces import Packed, bytes_literal, joined
from jausml_generators.bridge.flat.protocols import Given, Numbers, Target
from jausml_generators.python.codec.classes import (
    ContainerClass,
)
from jausml_generators.python.codec.compounds import (
    ListValue,
    PartValue,
    VariantValue,
)
from jausml_generators.python.statements import tuple_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.bridge.flat.jaus_wanted import Value
    from jausml_generators.python.codec.members import Member
    from jausml_generators.python.codec.messages import MessageView
    from jausml_generators.python.names import Scope


_STEP = " " * 4


_MISFITS = "struct.error, TypeError, AttributeError, OverflowError"


class _Writing:
    """Takes what is given to a message or to an element of a list."""

    def __init__(self, message: MessageView, constants: Constants, scope: Scope) -> None:
        self._message = message
        self._constants = constants
        self._scope = scope
        self._tree = Tree()

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value of a field."""
        self._tree.values[path] = Given(expression, conditional)

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

    def _block(self) -> JausBlock:
        return JausBlock(self._message, self._constants, self._scope, self._tree, self._option)


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
        given = {path: Given(code, conditional=False) for path, code in values.items()}
        tree = Tree(given, dict(self._tree.made))
        block = RecordBlock(self._message, self._constants, self._scope, tree, self._option)
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


def _literal(code: str) -> float:
    """Returns the number that a Python text is."""
    try:
        found = ast.literal_eval(code)
    except (ValueError, SyntaxError):
        found = None
    if not isinstance(found, int | float):
        raise NotFlatError(f"{code} is no number")
    return found
