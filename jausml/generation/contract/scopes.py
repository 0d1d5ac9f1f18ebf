"""Syntax trees of Python: questions to them, which names a file binds where, scopes of uses."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, auto


class SourceProblem(Exception):  # noqa: N818 - a finding, not a failure of jausml
    """The file is not Python."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


def tree_of(text: str | bytes) -> ast.Module:
    """Returns the syntax tree of a file; raises SourceProblem where it is not Python."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an invalid escape of the user is not our subject
            return ast.parse(text)
    except SyntaxError as error:
        raise SourceProblem(f"syntax error: {error.msg}", error.lineno or 1) from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise SourceProblem(f"cannot be parsed: {error}", 1) from error


def flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yields statements in order, those inside `if`, `try` and `with` too."""
    for statement in body:
        yield statement
        if isinstance(statement, (ast.If, ast.Try, ast.With)):
            for block in ("body", "handlers", "orelse", "finalbody"):
                for part in getattr(statement, block, ()):
                    yield from flat(part.body if isinstance(part, ast.ExceptHandler) else [part])


def absolute(node: ast.ImportFrom, module: str, *, is_package: bool) -> str:
    """Returns the dotted name of the module that an import names; empty when there is none."""
    if not node.level:
        return node.module or ""
    parts = module.split(".")
    kept = len(parts) - node.level + is_package
    if not module or kept < 1:
        return ""
    return ".".join((*parts[:kept], *([node.module] if node.module else [])))


def last_name(node: ast.expr) -> str:
    """Returns the last part of a dotted name, called or with parameters; empty for no name."""
    if isinstance(node, ast.Call):
        node = node.func
    if isinstance(node, ast.Subscript):
        node = node.value
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def is_decorated_by(decorator: ast.expr, *names: str) -> bool:
    """Tells whether a decorator, called or not, has one of some names."""
    return last_name(decorator) in names


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
        node: The import, class or function, the statement that annotates it, or the expression
            that is assigned or iterated over.
    """

    how: Bound
    node: ast.AST
    alias: ast.alias | None = None
    position: int = 0


@dataclass(eq=False)
class Scope:
    """A block with names of its own.

    Attributes:
        probed: Names whose values are looked at as they run (`isinstance`), so that nothing is
            certain of them.
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
            inside = [
                (syntax, at) for syntax, at in self._inside(node, place) if syntax is not None
            ]
            waiting += reversed(inside)

    def _inside(self, node: ast.AST, place: Place) -> Iterator[tuple[ast.AST | None, Place]]:
        match node:
            case ast.ClassDef():
                outside: Iterable[ast.AST | None] = (
                    *node.decorator_list,
                    *node.bases,
                    *node.keywords,
                )
                yield from _at(place, outside)
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
