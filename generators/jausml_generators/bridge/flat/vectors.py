"""Loops over numbers that numpy goes through at once.

An element is one number made of one number by arithmetic with constants. Such arithmetic is
monotonic, rounded too: while the least and the greatest number fit, the others do. The numbers are
the same, since numpy does the same arithmetic with the same double precision. Of integers it is
known beforehand whether they fit. Others are asked for the least and the greatest, and the limit is
called for those that do not fit; where it may leave one out, or let one through that cannot be
packed, the loop runs instead.
"""

from __future__ import annotations

import ast
import operator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.expressions import lowered
from jausml_generators.bridge.flat.limits import limit_call
from jausml_generators.bridge.flat.octets import OctetValue
from jausml_generators.bridge.flat.texts import text_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml_generators.bridge.flat.expressions import Names
    from jausml_generators.bridge.flat.limits import LimitCall
    from jausml_generators.bridge.flat.protocols import Numbers, SequenceReading, SequenceWriting
    from jausml_generators.python.names import Scope

NUMBERS = frozenset("BHIbhifd")
"""Letters of numbers that double precision holds as they are."""

_STEP = " " * 4
_RAW = "raw"
# Arithmetic with such constants stays finite, and exact where they are integers.
_GREATEST = 1e15
_OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_UFUNCS: dict[type[ast.operator], str] = {
    ast.Add: "add",
    ast.Sub: "subtract",
    ast.Mult: "multiply",
    ast.Div: "divide",
}
_KINDS = {"b": "i", "h": "i", "i": "i", "f": "f", "d": "f"}
_SIZES = {"b": 1, "B": 1, "h": 2, "H": 2, "i": 4, "I": 4, "f": 4, "d": 8}


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
        test: The condition that all numbers fit; empty where they do whatever they are.
        lines: Statements for these.
        others: Statements where some do not; empty where the loop must run.
        after: Statements behind both.
    """

    before: tuple[str, ...]
    test: str
    lines: tuple[str, ...]
    others: tuple[str, ...] = ()
    after: tuple[str, ...] = ()

    @property
    def needs_loop(self) -> bool:
        """Whether the loop runs for numbers that do not fit."""
        return bool(self.test) and not self.others

    def around(self, loop: Iterable[str]) -> list[str]:
        """Returns the statements, with the loop for numbers that do not fit."""
        if not self.test:
            return [*self.before, *self.lines, *self.after]
        otherwise = self.others or loop
        fitting, otherwise = ([_STEP + each for each in lines] for lines in (self.lines, otherwise))
        return [*self.before, f"if {self.test}:", *fitting, "else:", *otherwise, *self.after]


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
    raw = scope.claim("numbers")
    before = [f"{raw} = {ends[0].array()}"]
    values = f"{raw} = {_with(_doubled(made.value), raw)}"
    packed = target.value.format(raw)
    if target.is_rounded:
        packed = f"numpy.rint({packed})"
    packed = f"{packed}.astype({dtype(target.letter)})"
    if _always_fits(made, source, target):
        taken = f"{ends[1].take_array(is_sure=True)} = {packed}"
        return AtOnce(tuple(before), "", (values, taken))
    low, high = (scope.claim(each) for each in ("low", "high"))
    tests = []
    can_be_packed = is_packed(made.limit.bounds if made.limit else None, target)
    for name, extreme in ((low, "minimum"), (high, "maximum")):
        reduced = f"numpy.{extreme}.reduce({raw}).item()"
        before.append(f"{name} = {reduced} if len({raw}) else 0.0")
        if not isinstance(made.value, ast.Name):
            before.append(f"{name} = {_with(made.value, name)}")
        if made.limit is not None:
            tests.append(made.limit.test(name))
        if not can_be_packed:
            tests.append(f"{target.lower} <= {target.value.format(name)} <= {target.upper}")
    test = " and ".join(tests)
    if made.limit is None or not can_be_packed or made.limit.can_be_none:
        return AtOnce(tuple(before), test, (values, f"{ends[1].take_array()} = {packed}"))
    names.limits.setdefault(made.limit.policy)
    lower, upper = made.limit.bounds
    called = f"lambda value: {made.limit.outside('value')}"
    others = (
        'with numpy.errstate(all="ignore"):',
        f"{_STEP}{values}",
        f"{raw} = columns.limited({raw}, {lower}, {upper}, {called})",
    )
    taken = f"{ends[1].take_array(is_sure=True)} = {packed}"
    return AtOnce(tuple(before), test, (values,), others, (taken,))


def is_packed(bounds: tuple[str, str] | None, target: Numbers) -> bool:
    """Whether whatever a limit lets through can be packed.

    Args:
        bounds: Least and greatest of the values; None where nothing limits them.
        target: What is packed.
    """
    if bounds is None or not target.lower:
        return not target.lower
    return all(_fits(target, ast.literal_eval(each)) for each in bounds)


def _fits(target: Numbers, number: float) -> bool:
    """Whether a number can be packed."""
    value = _computed(ast.parse(target.value.format(_RAW), mode="eval").body, number)
    return float(_number(target.lower)) <= value <= float(_number(target.upper))


def _number(text: str) -> float:
    return _computed(ast.parse(text, mode="eval").body, 0.0)


def _always_fits(made: _Element, source: Numbers, target: Numbers) -> bool:
    """Whether all numbers fit that can stand in the bytes."""
    if source.letter in {"f", "d"}:
        return False
    values = [_computed(made.value, raw) for raw in (0, 2 ** (8 * _SIZES[source.letter]) - 1)]
    if made.limit is not None:
        lower, upper = (_number(each) for each in made.limit.bounds)
        if not all(lower <= each <= upper for each in values):
            return False
    return all(_fits(target, each) for each in values)


def _computed(node: ast.expr, raw: float) -> float:
    """Returns the value of a linear function, or of arithmetic of numbers."""
    match node:
        case ast.Constant(value=float() | int() as number):
            return number
        case ast.Name(id=name) if name == _RAW:
            return raw
        case ast.UnaryOp(op=ast.USub()):
            return -_computed(node.operand, raw)
        case ast.BinOp(op=operation) if type(operation) in _OPERATIONS:
            left, right = (_computed(each, raw) for each in (node.left, node.right))
            return _OPERATIONS[type(operation)](left, right)
    raise NotFlatError(f"{ast.unparse(node)} is no arithmetic")


def _doubled(node: ast.expr) -> ast.expr:
    """Returns a linear function with its first step in double precision, whatever is given."""
    match node:
        case ast.BinOp(left=ast.Name(id=name)) if name == _RAW:
            return _ufunc(node.op, node.left, node.right)
        case ast.BinOp(right=ast.Name(id=name)) if name == _RAW:
            return _ufunc(node.op, node.left, node.right)
        case ast.BinOp() if _is_constant(node.left):
            return ast.BinOp(node.left, node.op, _doubled(node.right))
        case ast.BinOp():
            return ast.BinOp(_doubled(node.left), node.op, node.right)
        case ast.UnaryOp(operand=ast.UnaryOp() | ast.BinOp()):
            return ast.UnaryOp(node.op, _doubled(node.operand))
    return ast.parse(_with(node, f"{_RAW}.astype({dtype('d')})"), mode="eval").body


def _ufunc(operation: ast.operator, left: ast.expr, right: ast.expr) -> ast.expr:
    function = ast.parse(f"numpy.{_UFUNCS[type(operation)]}", mode="eval").body
    kind = ast.keyword("dtype", ast.parse(dtype("d"), mode="eval").body)
    return ast.Call(function, [left, right], [kind])


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
