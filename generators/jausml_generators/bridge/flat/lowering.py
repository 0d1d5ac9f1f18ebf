"""Loops of a readable translation, and with them all of its statements, on local variables."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml_generators.bridge.flat.columns import Loop, by_columns
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.expressions import (
    Names,
    chain_of,
)
from jausml_generators.bridge.flat.limits import limit_call
from jausml_generators.bridge.flat.octets import OctetValue, OneValue, table
from jausml_generators.bridge.flat.statements import Statements
from jausml_generators.bridge.flat.vectors import AtOnce, at_once

if TYPE_CHECKING:
    from jausml_generators.bridge.flat.columns import ByColumns, ColumnLowering
    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.bridge.flat.protocols import (
        Octets,
        SequenceReading,
        SequenceWriting,
        Values,
    )
    from jausml_generators.python.names import Scope


_STEP = " " * 4


class Lowering(Statements):
    """The statements of one message, or of one element of a list, with loops.

    Args:
        names: The names that expressions know.
        writing: Is told what has the values of the target.
        scope: Names of local variables.
        target: Name of the target in the readable translation.
        constants: Constants of the module.
        has_columns: Whether its loops run on columns where they can.
    """

    def __init__(
        self,
        names: Names,
        writing: Values,
        scope: Scope,
        target: str,
        constants: Constants,
        *,
        has_columns: bool = False,
    ) -> None:
        super().__init__(names, writing, scope, target, constants)
        self._has_columns = has_columns

    def _octets(
        self,
        body: list[ast.stmt],
        item: str,
        made: tuple[str, SequenceWriting],
        elements: ast.expr,
    ) -> bool:
        """Adds a loop over octets that makes octets; tells whether it is that simple."""
        element, sequence = made
        if sequence.octet is None:
            return False
        cells = self._names.octets.get(ast.unparse(elements))
        if cells is None:
            cells = self._plain_octets(body, item, (element, sequence.octet), elements)
        if cells is None:
            return False
        source = table(body, item, cells, self._names, (element, sequence.octet))
        name = self._constants.named("_TABLE", source)
        number, result = self._scope.claim("number"), self._scope.claim("cells")
        one = OneValue()
        roots = {**self._names.roots, item: OctetValue(cells.path, number)}
        inner = Lowering(
            replace(self._names, roots=roots), one, self._scope, element, self._constants
        )
        lines = inner.lower(body)
        octet = self._scope.claim("octet") if cells.is_signed else number
        signed = f"{_STEP * 2}{number} = {octet} - 256 * ({octet} > 127)"
        sequence.vector(result)
        for line in (
            f"{result} = {cells.code}.translate({name}.octets)",
            f"if {name}.odd is not None and {name}.odd in {result}:",
            f"{_STEP}{result} = bytearray()",
            f"{_STEP}for {octet} in {cells.code}:",
            *([signed] if cells.is_signed else []),
            *(f"{_STEP * 2}{line}" for line in lines),
            f"{_STEP * 2}{result}.append({one.code} & 0xFF)",
        ):
            self._add(line)
        return True

    def _plain_octets(
        self, body: list[ast.stmt], item: str, target: tuple[str, str], elements: ast.expr
    ) -> Octets | None:
        """Returns a list of the source as octets, None where a loop must go over it."""
        root, path = chain_of(elements)
        if root not in self._names.roots:
            return None
        reading, _ = self._names.roots[root].elements(path)
        cells = reading.plain_octets
        if cells is None:
            return None
        try:
            table(body, item, cells, self._names, target)
        except NotFlatError:
            return None
        return reading.octets()

    def _at_once(
        self,
        body: list[ast.stmt],
        item: str,
        made: tuple[str, SequenceWriting],
        elements: ast.expr,
    ) -> AtOnce | None:
        """Returns how a loop over numbers makes all of them at once; None for other loops."""
        root, source = chain_of(elements)
        if root not in self._names.roots:
            return None
        element, sequence = made
        reading, _ = self._names.roots[root].elements(source)
        try:
            return at_once(body, item, element, self._names, (reading, sequence), self._scope)
        except NotFlatError:
            return None

    def _for(self, loop: ast.For) -> None:
        """A loop whose body makes an element of a list of the target."""
        *body, last = loop.body
        match last:
            case ast.Expr(
                value=ast.Call(
                    func=ast.Attribute(value=place, attr="append"), args=[ast.Name() as e]
                )
            ):
                path = self._target_path(place)
            case _:
                path = None
        if path is None:
            raise NotFlatError("a loop has no flat form")
        index, item, elements = _iterated(loop)
        elements = self._sized(elements)
        is_begun = path in self._sequences
        sequence = self._sequence(path)
        names = replace(
            self._names, roots=dict(self._names.roots), variables={*self._names.variables, index}
        )
        most = ""
        if isinstance(elements, ast.Name) and elements.id in self._names.slices:
            elements, most = self._names.slices[elements.id]
        root, source = chain_of(elements)
        is_whole = not (index or most or is_begun)
        if is_whole and self._octets(body, item, (e.id, sequence), elements):
            return
        vector = self._at_once(body, item, (e.id, sequence), elements) if is_whole else None
        if vector is not None and not vector.needs_loop:
            self._add_all(vector.around(()))
            return
        found = Loop(body, item, index, e.id, elements, sequence)
        inner = Lowering(names, sequence.element, self._scope, e.id, self._constants)
        if root in self._names.roots:
            reading, names.roots[item] = self._names.roots[root].elements(source)
            lines = inner.lower(body)
            columns = self._columns(found) if vector is None and not (most or is_begun) else None
            lines = [*reading.loop([*lines, *sequence.append()], index, most)]
            if columns is not None:
                lines = columns.around(lines)
        else:
            names.variables.add(item)
            head = self._head(index, item, elements)
            lines = inner.lower(body)
            lines = [head, *(_STEP + line for line in [*lines, *sequence.append()])]
        if not is_begun:
            self._first += sequence.begin()
        self._add_all(lines if vector is None else vector.around(lines))

    def _columns(self, loop: Loop) -> ByColumns | None:
        """Returns how a loop runs on columns; None where it does not."""
        if not self._has_columns:
            return None
        try:
            return by_columns(self, loop)
        except NotFlatError:
            return None

    def columns_of(
        self, loop: Loop, writing: Values, kind: type[ColumnLowering]
    ) -> tuple[SequenceReading, ColumnLowering]:
        """Returns what reads the elements of a loop, and what lowers it to columns.

        Args:
            loop: The loop.
            writing: Is told what has the columns.
            kind: What lowers it.
        """
        root, source = chain_of(loop.elements)
        reading, values = self._names.roots[root].elements(source)
        names = replace(
            self._names,
            roots={**self._names.roots, loop.item: values},
            variables={*self._names.variables, loop.index},
        )
        return reading, kind(names, writing, self._scope, loop.element, self._constants)

    def _head(self, index: str, item: str, elements: ast.expr) -> str:
        """Returns the head of a loop over what is no list of the source."""
        values = self._text(elements)
        return (
            f"for {index}, {item} in enumerate({values}):" if index else f"for {item} in {values}:"
        )

    def _sized(self, elements: ast.expr) -> ast.expr:
        """Refuses a wrong number of elements; returns the elements."""
        call = limit_call(elements, self._names.owner)
        if call is None:
            return elements
        count = self._text(ast.Call(ast.Name("len", ast.Load()), [call.value], []))
        self._names.limits.setdefault(call.policy)
        lower, upper = call.limits
        test = f"{count} <= {upper}" if lower == "0" else f"{lower} <= {count} <= {upper}"
        self._add(f"if not {test}:" if lower == "0" else f"if not ({test}):")
        self._add(f"{_STEP}{call.outside(f'range({count})')}")
        return call.value


def _iterated(loop: ast.For) -> tuple[str, str, ast.expr]:
    """Returns the variables of index and item, and what a loop goes over."""
    match loop:
        case ast.For(
            target=ast.Tuple(elts=[ast.Name() as index, ast.Name() as item]),
            iter=ast.Call(func=ast.Name(id="enumerate"), args=[elements]),
        ):
            return index.id, item.id, elements
        case ast.For(target=ast.Name() as item):
            return "", item.id, loop.iter
    raise NotFlatError("a loop has no flat form")
