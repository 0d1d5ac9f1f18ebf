"""Scopes of Python files: which names a block binds, and how."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum, auto

Block = (
    ast.Module
    | ast.ClassDef
    | ast.FunctionDef
    | ast.AsyncFunctionDef
    | ast.Lambda
    | ast.ListComp
    | ast.SetComp
    | ast.DictComp
    | ast.GeneratorExp
)
Function = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
_PROBES = {"isinstance", "issubclass", "hasattr", "getattr", "setattr", "delattr", "cast"}


class Bound(Enum):
    """How a name comes to be."""

    IMPORT = auto()
    CLASS = auto()
    PARAMETER = auto()
    VALUE = auto()
    ITEM = auto()
    ANNOTATED = auto()
    OTHER = auto()


@dataclass(frozen=True)
class Binding:
    """One binding of a name.

    Attributes:
        how: How the name comes to be.
        node: The import, class or function, the statement that annotates it, or the expression
            that is assigned or iterated over.
        alias: The part of an import that names it.
        position: Of a parameter, its place in calls; -1 where it is given by its name alone.
    """

    how: Bound
    node: ast.AST
    alias: ast.alias | None = None
    position: int = 0


@dataclass(eq=False)
class Scope:
    """A block with names of its own.

    Attributes:
        node: The block.
        parent: The scope around it; None for that of a file.
        bindings: All bindings of each name in it.
        probed: Names whose values are looked at as they run (`isinstance`), so that nothing is
            certain of them.
        counted: The targets whose bindings are known.
    """

    node: Block
    parent: Scope | None
    bindings: dict[str, list[Binding]] = field(default_factory=dict)
    probed: set[str] = field(default_factory=set)
    counted: set[ast.Name] = field(default_factory=set)

    def find(self, name: str) -> tuple[Scope, list[Binding]] | None:
        """Returns the bindings that a name has here, and the scope that has them."""
        scope: Scope | None = self
        while scope is not None:
            # Functions do not see the names of the class around them.
            is_seen = scope is self or not isinstance(scope.node, ast.ClassDef)
            if is_seen and name in scope.bindings:
                return scope, scope.bindings[name]
            scope = scope.parent
        return None

    @property
    def function(self) -> Scope | None:
        """The innermost method around it, the scope of which is within that of a class."""
        scope: Scope | None = self
        while scope is not None:
            parent = scope.parent
            in_class = parent is not None and isinstance(parent.node, ast.ClassDef)
            if in_class and isinstance(scope.node, Function):
                return scope
            scope = parent
        return None


def scopes_of(tree: ast.Module) -> dict[ast.AST, Scope]:
    """Returns the scopes of a file by the blocks that open them."""
    scopes: dict[ast.AST, Scope] = {}
    _open(tree, None, scopes)
    for scope in list(scopes.values()):
        for node in own_nodes(scope.node):
            if isinstance(node, (ast.Global, ast.Nonlocal)):
                for name in node.names:
                    _share(scope, name, node)
    return scopes


def _open(node: Block, parent: Scope | None, scopes: dict[ast.AST, Scope]) -> None:
    scope = scopes[node] = Scope(node, parent)
    if isinstance(node, Function):
        _parameters(scope, node)
    for syntax in own_nodes(node):
        _bind(scope, syntax)
        if isinstance(syntax, (*Function, *_COMPREHENSIONS, ast.ClassDef)):
            _open(syntax, scope, scopes)


def names_of(node: Block) -> dict[str, list[Binding]]:
    """Returns the names that a block binds itself."""
    scope = Scope(node, None)
    for syntax in own_nodes(node):
        _bind(scope, syntax)
    return scope.bindings


def _share(scope: Scope, name: str, node: ast.AST) -> None:
    """A name that inner functions bind, too, is certain nowhere."""
    outer: Scope | None = scope
    while outer is not None:
        # Twice, since a single binding counts as certain.
        outer.bindings.setdefault(name, []).extend([Binding(Bound.OTHER, node)] * 2)
        outer = outer.parent


def own_nodes(node: Block) -> Iterator[ast.AST]:
    """Yields the nodes of a block, inner blocks included, but not the nodes inside of these."""
    waiting = [*ast.iter_child_nodes(node)][::-1]
    while waiting:
        syntax = waiting.pop()
        yield syntax
        if isinstance(syntax, (*Function, *_COMPREHENSIONS, ast.ClassDef)):
            # Decorators run in the block around what they decorate.
            if not isinstance(syntax, (ast.Lambda, *_COMPREHENSIONS)):
                waiting += syntax.decorator_list[::-1]
        else:
            waiting += [*ast.iter_child_nodes(syntax)][::-1]


def _parameters(scope: Scope, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> None:
    arguments = node.args
    for position, argument in enumerate((*arguments.posonlyargs, *arguments.args)):
        _add(scope, argument.arg, Binding(Bound.PARAMETER, argument, position=position))
    for kwonlyarg in arguments.kwonlyargs:
        _add(scope, kwonlyarg.arg, Binding(Bound.PARAMETER, kwonlyarg, position=-1))
    for rest in (arguments.vararg, arguments.kwarg):
        if rest is not None:
            _add(scope, rest.arg, Binding(Bound.OTHER, rest))


def _bind(scope: Scope, node: ast.AST) -> None:
    """Adds the bindings that a node makes itself."""
    match node:
        case ast.Import() | ast.ImportFrom():
            for alias in node.names:
                top = alias.name.partition(".")[0] if isinstance(node, ast.Import) else alias.name
                _add(scope, alias.asname or top, Binding(Bound.IMPORT, node, alias))
        case ast.ClassDef(name=name):
            _add(scope, name, Binding(Bound.CLASS, node))
        case ast.Assign(targets=[ast.Name() as target], value=value):
            _count(scope, target, Binding(Bound.VALUE, value))
        case ast.AnnAssign(target=ast.Name() as target):
            _count(scope, target, Binding(Bound.ANNOTATED, node))
        case (
            ast.For(target=ast.Name() as target, iter=items)
            | ast.comprehension(target=ast.Name() as target, iter=items)
        ):
            _count(scope, target, Binding(Bound.ITEM, items))
        case ast.Name(id=name, ctx=ast.Store() | ast.Del()) if node not in scope.counted:
            _add(scope, name, Binding(Bound.OTHER, node))
        case _:
            _bind_otherwise(scope, node)


def _bind_otherwise(scope: Scope, node: ast.AST) -> None:
    match node:
        case (
            ast.FunctionDef(name=name)
            | ast.AsyncFunctionDef(name=name)
            | ast.ExceptHandler(name=str(name))
            | ast.MatchAs(name=str(name))
            | ast.MatchStar(name=str(name))
            | ast.MatchMapping(rest=str(name))
        ):
            _add(scope, name, Binding(Bound.OTHER, node))
        case ast.Call(func=ast.Name(id=probe), args=[first, *rest]) if probe in _PROBES:
            asked = rest[0] if probe == "cast" and rest else first
            scope.probed |= {
                syntax.id for syntax in ast.walk(asked) if isinstance(syntax, ast.Name)
            }
        case ast.Match(subject=ast.Name(id=name)):
            scope.probed.add(name)


def _count(scope: Scope, target: ast.Name, binding: Binding) -> None:
    """Adds the one target of a statement, which is not to be counted again as a name."""
    scope.counted.add(target)
    _add(scope, target.id, binding)


def _add(scope: Scope, name: str, binding: Binding) -> None:
    scope.bindings.setdefault(name, []).append(binding)
