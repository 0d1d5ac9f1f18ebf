"""Loops over elements that numpy goes through column by column, where there are many.

The statements of the loop are lowered a second time, on columns in the place of numbers. Nothing is
refused, counted or kept in them: if a value does not fit, or an optional one is absent, the loop
runs instead. What numpy computes is what the loop computes, to the last bit.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NoReturn, Protocol

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.column_values import columnwise, is_true
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.expressions import chain_of, lowered
from jausml_generators.bridge.flat.limits import FINITE, LimitCall, limit_call
from jausml_generators.bridge.flat.statements import Statements
from jausml_generators.bridge.flat.texts import text_of
from jausml_generators.bridge.flat.vectors import dtype, is_packed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml_generators.bridge.flat.protocols import (
        Group,
        Place,
        Records,
        SequenceReading,
        SequenceWriting,
        Target,
        Values,
    )

_STEP = " " * 4
_STAMP = ("0", "2147483647"), ("0", "999999999")
_RESULTS: dict[str, tuple[tuple[str, str], ...]] = {
    "columns.bits_of": (("0", "4294967295"),),
    "columns.time_of": _STAMP,
}


@dataclass
class _Values:
    """Takes the columns of the elements.

    Attributes:
        found: What has each value, by path.
    """

    found: dict[str, str] = field(default_factory=dict)

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value of a field."""
        if conditional:
            raise NotFlatError(f"{path} may be absent")
        self.found[path] = expression

    def make(self, path: str, class_name: str) -> None:
        """Refuses: records have no variants."""
        raise NotFlatError(f"{path} is no {class_name}")

    def sequence(self, path: str) -> NoReturn:
        """Refuses: records have no lists."""
        raise NotFlatError(f"{path} is no list")


class LoopLowering(Protocol):
    """The statements around a loop."""

    def columns_of(
        self, loop: Loop, writing: Values, kind: type[ColumnLowering]
    ) -> tuple[SequenceReading, ColumnLowering]:
        """Returns what reads the elements of a loop, and what lowers it to columns."""

    def claim(self, name: str) -> str:
        """Returns the name of a new local variable."""


class ColumnLowering(Statements):
    """The statements of a loop on columns.

    Attributes:
        limits: Least and greatest value of columns that are limited.
    """

    def prepare(self, reading: SequenceReading, index: str) -> None:
        """Names what columns there are before.

        Args:
            reading: What reads the elements.
            index: The variable of the position; empty for none.
        """
        self._reading = reading
        self._made_arrays = {index} if index else set()
        self.limits: dict[str, tuple[str, str]] = {}

    @property
    def arrays(self) -> set[str]:
        """Local variables that are columns."""
        return {*self._reading.asked, *self._made_arrays}

    @property
    def owner(self) -> str:
        """Attribute of the bridge that is the connection."""
        return self._names.owner

    def _code(self, expression: ast.expr) -> str:
        """Returns what is lowered as Python text on columns."""
        return text_of(columnwise(expression, self.arrays))

    def _text(self, expression: ast.expr) -> str:
        return self._code(self._lowered(expression))

    def _lowered(self, expression: ast.expr) -> ast.expr:
        return lowered(_Unlimited(self).of(expression), self._names)

    def _add(self, line: str) -> None:
        if line.startswith("raise "):
            raise NotFlatError("all elements are refused")
        super()._add(line)

    def _assign(self, place: ast.expr, value: ast.expr) -> None:
        if chain_of(place)[0] == "self":
            raise NotFlatError(f"{ast.unparse(place)} is kept")
        super()._assign(place, value)

    def _if(self, statement: ast.If) -> None:
        holds = is_true(self._lowered(self._truth(statement.test)), self.arrays)
        self._block(statement.body if holds else statement.orelse)

    def _assigned(self, variables: Sequence[str], code: str) -> None:
        super()._assigned(variables, code)
        tree = ast.parse(code, mode="eval").body
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        if names & self.arrays:
            self._made_arrays |= set(variables)
        if isinstance(tree, ast.Call) and code.startswith("columns."):
            known = _RESULTS.get(ast.unparse(tree.func), (FINITE,) * len(variables))
            self.limits |= dict(zip(variables, known, strict=True))

    def _store(self, variable: str, value: ast.expr) -> bool:
        call = limit_call(value, self._names.owner)
        if call is None:
            self._assigned([variable], self._text(value))
            return False
        self._store(variable, call.value)
        self._limit(variable, call)
        return False

    def _limit(self, variable: str, call: LimitCall) -> None:
        bounds = _bounds(call)
        if bounds is None or call.can_be_none or variable not in self.arrays:
            raise NotFlatError(f"{variable} is no column that is within two numbers")
        self.limits[variable] = bounds

    def without_limit(self, call: LimitCall) -> ast.expr:
        """Returns the variable of what is limited within an expression."""
        variable = self._scope.claim("column")
        self._names.variables.add(variable)
        self._assigned([variable], self._text(call.value))
        self._limit(variable, call)
        return ast.Name(variable, ast.Load())


def _bounds(call: LimitCall) -> tuple[str, str] | None:
    """Returns least and greatest of what a limit lets through; None where these do not tell."""
    if call.is_range:
        return call.bounds
    if call.method != "listed":
        return None
    ((lower, upper), *others) = ast.literal_eval(call.limits[0])
    return None if others else (str(lower), str(upper))


class _Unlimited(ast.NodeTransformer):
    """Puts variables in the place of what is limited."""

    def __init__(self, lowering: ColumnLowering) -> None:
        self._lowering = lowering

    def of(self, expression: ast.expr) -> ast.expr:
        """Returns an expression without limits."""
        found = self.visit(ast.parse(ast.unparse(expression), mode="eval").body)
        if not isinstance(found, ast.expr):
            raise NotFlatError("an expression has no value")
        return found

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """A limit, or another call."""
        call = limit_call(node, self._lowering.owner)
        return self.generic_visit(node) if call is None else self._lowering.without_limit(call)


@dataclass(frozen=True)
class Loop:
    """A loop that makes elements of a list of the target.

    Attributes:
        body: Its statements, without the one that appends the element.
        item: What it calls an element of the source.
        index: What it calls the position; empty for nothing.
        element: What it calls the element that it makes.
        elements: What it goes over.
        sequence: What writes the list.
    """

    body: list[ast.stmt]
    item: str
    index: str
    element: str
    elements: ast.expr
    sequence: SequenceWriting


@dataclass(frozen=True)
class Range:
    """Columns that must be within the same two numbers.

    Attributes:
        bounds: These numbers.
        variables: The columns.
        values: The variable of all of them together.
    """

    bounds: tuple[str, str]
    variables: tuple[str, ...]
    values: str


@dataclass(frozen=True)
class ByColumns:
    """How a loop runs on columns.

    Attributes:
        body: The statements on columns.
        records: What reads the columns.
        count: Python text of the number of elements.
        target: How the elements are written.
        ranges: What is asked of columns.
        index: The variable of the position; empty for none.
        fits: Local variable that tells whether all values fit.
    """

    body: tuple[str, ...]
    records: Records
    count: str
    target: Target
    ranges: tuple[Range, ...]
    index: str
    fits: str

    def around(self, loop: Iterable[str]) -> list[str]:
        """Returns the statements, with the loop where it must run."""
        records, count = self.records, self.count
        inner = [*records.lines, *(line for each in records.columns for line in _read(each))]
        if self.index:
            inner.append(f'{self.index} = numpy.arange({count}, dtype="<f8")')
        inner += [*self.body, *self.stacked]
        tests = (f"columns.fit({each.values}, {', '.join(each.bounds)})" for each in self.ranges)
        inner.append(f"{self.fits} = {' and '.join(tests) or 'True'}")
        return [
            f"{self.fits} = False",
            f"if {records.test}:",
            f'{_STEP}with numpy.errstate(all="ignore"):',
            *(_STEP * 2 + line for line in inner),
            f"if {self.fits}:",
            *(_STEP + line for line in self._written()),
            "else:",
            *(_STEP + line for line in (*records.otherwise, *loop)),
        ]

    @property
    def stacked(self) -> list[str]:
        """Statements that put columns together of which the same is asked."""
        many = (each for each in self.ranges if len(each.variables) > 1)
        return [f"{each.values} = numpy.array(({', '.join(each.variables)}))" for each in many]

    def _written(self) -> list[str]:
        """Returns the statements that write the columns."""
        target = self.target
        made = [f"{target.variable} = {target.made.format(self.count)}"] if target.made else []
        return [*made, *(line for each in _alike(target.places) for line in self._put(each))]

    def _put(self, places: Sequence[Place]) -> list[str]:
        """Returns the statements that write columns of which the same is made."""
        target, numbers = self.target.variable, places[0].numbers
        variables = tuple(each.variable for each in places)
        if not places[0].name:
            values = f"numpy.rint({variables[0]})" if numbers.is_rounded else variables[0]
            return [f"{target} = {values}.astype({dtype(numbers.letter)})"]
        fields = [f"{target}[{python_string(each.name)}]" for each in places]
        if numbers.value == "{}" and not numbers.is_rounded:
            return [f"{field} = {each}" for field, each in zip(fields, variables, strict=True)]
        known = {each.variables: each.values for each in self.ranges}
        together = f"numpy.array(({', '.join(variables)}))" if len(variables) > 1 else variables[0]
        packed = numbers.value.format(known.get(variables, together))
        return [
            f"{', '.join(fields)} = {f'numpy.rint({packed})' if numbers.is_rounded else packed}"
        ]


def _read(group: Group) -> list[str]:
    """Returns the statements that make columns in double precision."""
    arrays = [array for _, array in group.columns]
    if len(arrays) == 1:
        values = f'{arrays[0]}.astype("<f8")'
    else:
        values = f'numpy.array(({", ".join(arrays)}), "<f8")'
    return [f"{', '.join(name for name, _ in group.columns)} = {group.value.format(values)}"]


def _alike(places: Iterable[Place]) -> list[list[Place]]:
    """Returns the places by what is made of their columns."""
    found: dict[object, list[Place]] = {}
    for each in places:
        found.setdefault(replace(each.numbers, path="") if each.name else each, []).append(each)
    return list(found.values())


def by_columns(lowering: LoopLowering, loop: Loop) -> ByColumns:
    """Returns how a loop runs on columns.

    Args:
        lowering: The statements around it.
        loop: The loop.

    Raises:
        NotFlatError: It does not.
    """
    values = _Values()
    reading, inner = lowering.columns_of(loop, values, ColumnLowering)
    inner.prepare(reading, loop.index)
    body = inner.lower(loop.body)
    records = reading.records()
    target = loop.sequence.columns(values.found)
    for place in target.places:
        limits, numbers = inner.limits.get(place.variable), place.numbers
        if place.variable not in inner.arrays and (limits or numbers.is_rounded):
            raise NotFlatError(f"{place.variable} is the same in all elements")
        if not is_packed(limits, numbers):
            raise NotFlatError(f"{place.variable} may not fit")
    loop.sequence.take_array()
    ranges = tuple(_ranges(inner.limits, lowering))
    fits = lowering.claim("fits")
    return ByColumns(tuple(body), records, reading.count, target, ranges, loop.index, fits)


def _ranges(limits: dict[str, tuple[str, str]], lowering: LoopLowering) -> Iterator[Range]:
    """Yields what is asked of columns, those of the same limits together."""
    found: dict[tuple[str, str], list[str]] = {}
    for variable, bounds in limits.items():
        found.setdefault(bounds, []).append(variable)
    for bounds, variables in found.items():
        values = lowering.claim("limited") if len(variables) > 1 else variables[0]
        yield Range(bounds, tuple(variables), values)
