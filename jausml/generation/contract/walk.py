"""Walk through the nodes of a Python file, with the place of each."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from jausml.generation.contract.scopes import Block, Function, Scope
from jausml.generation.contract.syntax import last_name


@dataclass(frozen=True)
class Place:
    """Where a node stands.

    Attributes:
        caught: The exceptions that are caught there, by their names; an empty one for each.
        is_run: Whether the program comes there, as it does not to what type checkers alone read.
    """

    scope: Scope
    caught: frozenset[str] = frozenset()
    is_run: bool = True


class Walk:
    """The nodes of a file with their places, outer ones first."""

    def __init__(self, tree: ast.Module, scopes: Mapping[ast.AST, Scope]) -> None:
        self._tree = tree
        self._scopes = scopes
        self._is_lazy = any(
            isinstance(statement, ast.ImportFrom)
            and statement.module == "__future__"
            and any(alias.name == "annotations" for alias in statement.names)
            for statement in tree.body
        )

    def __iter__(self) -> Iterator[tuple[ast.AST, Place]]:
        """Yields each node."""
        waiting: list[tuple[ast.AST, Place]] = [(self._tree, Place(self._scopes[self._tree]))]
        while waiting:
            node, place = waiting.pop()
            yield node, place
            children = [
                (child, at) for child, at in self._children(node, place) if child is not None
            ]
            waiting += reversed(children)

    def _children(self, node: ast.AST, place: Place) -> Iterator[tuple[ast.AST | None, Place]]:
        """Yields the nodes directly inside one, with their places; None for those left out."""
        match node:
            case ast.ClassDef():
                yield from _at(place, (*node.decorator_list, *node.bases, *node.keywords))
                yield from _at(self._within(node, place), node.body)
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.Lambda():
                yield from self._of_function(node, place)
            case ast.ListComp() | ast.SetComp() | ast.DictComp() | ast.GeneratorExp():
                yield from _at(self._within(node, place), ast.iter_child_nodes(node))
            case ast.AnnAssign():
                # Python never evaluates annotations of local variables.
                is_local = isinstance(place.scope.node, Function)
                yield node.annotation, self._annotation(place, is_run=not is_local)
                yield from _at(place, (node.target, node.value))
            case ast.If():
                is_run = place.is_run and last_name(node.test) != "TYPE_CHECKING"
                yield node.test, place
                yield from _at(replace(place, is_run=is_run), node.body)
                yield from _at(place, node.orelse)
            case ast.Try():
                caught = frozenset(name for handler in node.handlers for name in _caught(handler))
                yield from _at(replace(place, caught=place.caught | caught), node.body)
                yield from _at(place, (*node.handlers, *node.orelse, *node.finalbody))
            case _:
                yield from _at(place, ast.iter_child_nodes(node))

    def _of_function(
        self, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda, place: Place
    ) -> Iterator[tuple[ast.AST | None, Place]]:
        arguments = node.args
        yield from _at(place, (*arguments.defaults, *arguments.kw_defaults))
        # What is caught around a definition is not caught where the function is called.
        inner = replace(self._within(node, place), caught=frozenset())
        if isinstance(node, ast.Lambda):
            yield node.body, inner
            return
        yield from _at(place, node.decorator_list)
        parameters = (
            *arguments.posonlyargs,
            *arguments.args,
            arguments.vararg,
            *arguments.kwonlyargs,
            arguments.kwarg,
        )
        annotations = (parameter.annotation for parameter in parameters if parameter is not None)
        yield from _at(self._annotation(place), (*annotations, node.returns))
        yield from _at(inner, node.body)

    def _within(self, node: Block, place: Place) -> Place:
        return replace(place, scope=self._scopes[node])

    def _annotation(self, place: Place, *, is_run: bool = True) -> Place:
        return replace(place, is_run=place.is_run and is_run and not self._is_lazy)


def _at(place: Place, nodes: Iterable[ast.AST | None]) -> Iterator[tuple[ast.AST | None, Place]]:
    for node in nodes:
        yield node, place


def _caught(handler: ast.ExceptHandler) -> list[str]:
    """Returns the names of the exceptions of a handler; an empty one for all."""
    kinds = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return ["" if kind is None else last_name(kind) for kind in kinds]
