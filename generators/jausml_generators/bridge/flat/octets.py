"""Loops over single octets, of which a table says what becomes of each."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NoReturn

from jausml.generation.literals import python_literal
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.expressions import lowered
from jausml_generators.bridge.flat.limits import limit_call
from jausml_generators.bridge.flat.texts import text_of
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from jausml_generators.bridge.flat.expressions import Names
    from jausml_generators.bridge.flat.protocols import Octets, SequenceReading

_VALUE = "value"


@dataclass
class OctetValue:
    """An element of such a list as expressions ask for it.

    Attributes:
        path: Path of the number in the element.
        variable: What has the number.
    """

    path: str
    variable: str = _VALUE

    def expression(self, path: str) -> ast.expr:
        """Returns the number."""
        if path != self.path:
            raise NotFlatError(f"{path} is no octet")
        return ast.Name(self.variable, ast.Load())

    presence = expression
    stamp_bits = expression

    def parts(self, path: str, names: tuple[str, ...]) -> list[ast.expr]:
        """Refuses: a number has no parts."""
        raise NotFlatError(f"{path} has no {names}")

    def chosen(self, path: str, class_name: str) -> ast.expr:
        """Refuses: a number is no variant."""
        raise NotFlatError(f"{path} is no {class_name}")

    def count(self, path: str) -> ast.expr:
        """Refuses: a number is no list."""
        raise NotFlatError(f"{path} is no list")

    def elements(self, path: str) -> tuple[SequenceReading, OctetValue]:
        """Refuses: a number is no list."""
        raise NotFlatError(f"{path} is no list")

    def inside(self, path: str) -> OctetValue:
        """Refuses: there is nothing inside of a number."""
        raise NotFlatError(f"{path} is no part")


@dataclass
class OneValue:
    """Takes the one value of an element.

    Attributes:
        code: The value, as Python text.
        is_sure: Whether it is there whatever holds.
    """

    code: str = ""
    is_sure: bool = field(default=False)

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value."""
        del path
        self.code, self.is_sure = expression, not conditional

    def make(self, path: str, class_name: str) -> None:
        """Refuses: a number is no variant."""
        raise NotFlatError(f"{path} is no {class_name}")

    def sequence(self, path: str) -> NoReturn:
        """Refuses: a number is no list."""
        raise NotFlatError(f"{path} is no list")


def table(
    body: list[ast.stmt], item: str, octets: Octets, names: Names, target: tuple[str, str]
) -> str:
    """Returns the expression of the table for a loop over octets.

    Args:
        body: Statements of the loop, without the one that appends the element.
        item: What the loop calls an element.
        octets: The list.
        names: The names that the loop may use; the table knows none of them.
        target: The element that is made, and the path of its number.

    Raises:
        NotFlatError: The elements do not depend on the octets alone.
    """
    element, path = target
    place = f"{element}.{path}" if path else element
    values = [
        each.value
        for each in body
        if isinstance(each, ast.Assign) and ast.unparse(each.targets[0]) == place
    ]
    limited = limit_call(values[0], names.owner) if len(values) == 1 else None
    if limited is None or limited.method != "integer" or limited.can_be_none:
        raise NotFlatError("no table has the elements")
    own = replace(names, variables=set(), module=frozenset(), roots={item: OctetValue(octets.path)})
    found = lowered(limited.value, own)
    text = text_of(found)
    if any(name in text for name in ("attribute_", "_limit")):
        raise NotFlatError("no table has the elements")
    function = f"lambda {_VALUE}: {text}"
    if isinstance(found, ast.Call) and text == f"{text_of(found.func)}({_VALUE})":
        function = text_of(found.func)
    signed = f"is_signed={python_literal(octets.is_signed)}"
    return call("octets.Table", function, *limited.limits, signed)
