"""Loops over numbers that numpy goes through at once, while all of them fit.

An element is one number made of one number by arithmetic with constants. Such arithmetic is
monotonic, rounded too: while the least and the greatest number fit, the others do. Otherwise, and
for values that are no numbers, the loop runs. The numbers are the same, since numpy does the same
arithmetic with the same double precision.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.flat.expressions import lowered
from jausml.generators.bridge.flat.limits import limit_call
from jausml.generators.bridge.flat.octets import OctetValue
from jausml.generators.bridge.flat.texts import text_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.generators.bridge.flat.expressions import Names
    from jausml.generators.bridge.flat.limits import LimitCall
    from jausml.generators.bridge.flat.protocols import Numbers, SequenceReading, SequenceWriting
    from jausml.generators.python.names import Scope

_STEP = " " * 4
_RAW = "raw"
# Arithmetic with such constants stays finite, and exact where they are integers.
_GREATEST = 1e15
_KINDS = {"f": "f", "d": "f"}
_SIZES = {"B": 1, "H": 2, "I": 4, "f": 4, "d": 8}


def dtype(letter: str, mark: str = "<") -> str:
    """Returns numpy's name of a type of numbers, as Python text.

    Args:
        letter: Its letter in struct formats.
        mark: The order of its bytes.
    """
    return python_string(f"{mark}{_KINDS.get(letter, 'u')}{_SIZES[letter]}")


@dataclass(frozen=True)
class _Element:
    """What a loop makes of each element.

    Attributes:
        value: The number, as an expression of the raw one.
        limit: The limit of the connection for it; None for none.
    """

    value: ast.expr
    limit: LimitCall | None


@dataclass(frozen=True)
class AtOnce:
    """How all elements of a list are made at once.

    Attributes:
        before: Statements before the condition.
        test: The condition that all numbers fit.
        lines: Statements for these.
    """

    before: tuple[str, ...]
    test: str
    lines: tuple[str, ...]

    def around(self, loop: Iterable[str]) -> list[str]:
        """Returns the statements, with the loop for numbers that do not fit."""
        fitting, otherwise = ([_STEP + each for each in lines] for lines in (self.lines, loop))
        return [*self.before, f"if {self.test}:", *fitting, "else:", *otherwise]


def at_once(
    body: list[ast.stmt],
    item: str,
    element: str,
    names: Names,
    ends: tuple[SequenceReading, SequenceWriting],
    scope: Scope,
) -> AtOnce:
    """Returns how all elements of a list are made at once.

    Args:
        body: Statements of the loop, without the one that appends the element.
        item: What the loop calls an element.
        element: What it calls the element that is made.
        names: The names that the loop may use.
        ends: What reads the list, and what writes the other.
        scope: Names of local variables.

    Raises:
        NotFlatError: The elements are not that simple.
    """
    source, target = ends[0].numbers(), ends[1].numbers()
    made = _made(body, item, element, names, (source, target))
    raw, low, high = (scope.claim(each) for each in ("numbers", "low", "high"))
    reduced = [f"numpy.{each}.reduce({raw}).item()" for each in ("minimum", "maximum")]
    before = [f"{raw} = {ends[0].array()}"]
    tests = []
    for name, extreme in zip((low, high), reduced, strict=True):
        before.append(f"{name} = {extreme} if len({raw}) else math.nan")
        if not isinstance(made.value, ast.Name):
            before.append(f"{name} = {_with(made.value, name)}")
        if made.limit is not None:
            tests.append(made.limit.test(name))
        tests.append(f"{target.lower} <= {target.value.format(name)} <= {target.upper}")
    values = f"{raw}.astype({dtype('d')})"
    lines = [f"{raw} = {_with(made.value, values)}"]
    packed = target.value.format(raw)
    if target.is_rounded:
        packed = f"numpy.rint({packed})"
    lines.append(f"{ends[1].take_array()} = {packed}.astype({dtype(target.letter)})")
    return AtOnce(tuple(before), " and ".join(tests), tuple(lines))


def _made(
    body: list[ast.stmt], item: str, element: str, names: Names, ends: tuple[Numbers, Numbers]
) -> _Element:
    """Returns what the loop makes of an element."""
    source, target = ends
    place = f"{element}.{target.path}" if target.path else element
    values = [
        each.value
        for each in body
        if isinstance(each, ast.Assign) and ast.unparse(each.targets[0]) == place
    ]
    makes = 1 if not target.path else 2
    if len(values) != 1 or len(body) != makes:
        raise NotFlatError("elements are more than one number")
    limit = limit_call(values[0], names.owner)
    if limit is not None and limit.method not in {"", "finite", "single"}:
        raise NotFlatError("elements are no real numbers")
    readable = values[0] if limit is None else limit.value
    own = replace(
        names,
        attributes=list(names.attributes),
        limits={},
        roots={item: OctetValue(source.path, _RAW)},
    )
    found = lowered(readable, own)
    unpacked = ast.parse(source.value.format(_RAW), mode="eval").body
    value = _Put(unpacked).visit(found)
    if not isinstance(value, ast.expr) or not _is_linear(value):
        raise NotFlatError("elements are no linear function of numbers")
    return _Element(value, limit)


class _Put(ast.NodeTransformer):
    """Puts an expression in the place of the raw number."""

    def __init__(self, value: ast.expr) -> None:
        self._value = value

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """The raw number."""
        return self._value if node.id == _RAW else node


def _with(value: ast.expr, code: str) -> str:
    copied = ast.parse(ast.unparse(value), mode="eval").body
    return text_of(_Put(ast.parse(code, mode="eval").body).visit(copied))


def _is_linear(node: ast.expr) -> bool:
    """Whether an expression is the raw number, with constants added and multiplied."""
    match node:
        case ast.Name(id=name):
            return name == _RAW
        case ast.UnaryOp(op=ast.USub()):
            return _is_linear(node.operand)
        case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult()) if _is_constant(node.left):
            return _is_linear(node.right)
        case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult()):
            return _is_linear(node.left) and _is_constant(node.right)
        case ast.BinOp(op=ast.Div()):
            return _is_linear(node.left) and _is_constant(node.right, is_divisor=True)
    return False


def _is_constant(node: ast.expr, *, is_divisor: bool = False) -> bool:
    """Whether an expression is arithmetic of numbers; what is divided by must not be zero."""
    match node:
        case ast.Constant(value=float() | int() as number):
            return -_GREATEST < number < _GREATEST and not (is_divisor and number == 0)
        case _ if is_divisor and not (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div)):
            return False
        case ast.UnaryOp(op=ast.USub()):
            return _is_constant(node.operand)
        case ast.BinOp(op=ast.Div()):
            left = _is_constant(node.left, is_divisor=is_divisor)
            return left and _is_constant(node.right, is_divisor=True)
        case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult()):
            return _is_constant(node.left) and _is_constant(node.right)
    return False
