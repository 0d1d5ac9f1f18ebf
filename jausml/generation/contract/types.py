"""The meaning of names in a user's file, and types of expressions as far as they are certain."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass

from jausml.generation.contract.scopes import Binding, Bound, Scope, scopes_of
from jausml.generation.contract.symbols import (
    UNKNOWN,
    Class,
    External,
    Function,
    Module,
    Modules,
    Unknown,
    Value,
    is_enumeration,
)
from jausml.generation.contract.syntax import absolute, is_decorated_by

_LISTS = {"list", "List", "Sequence", "Iterable", "Collection", "tuple", "deque"}
_DEPTH = 20  # steps from a name to what it means, beyond which nothing is told of it


@dataclass(frozen=True)
class Object:
    """An object of a class; with `is_super`, of the classes after it, as of `super()`."""

    of: Class
    is_super: bool = False


@dataclass(frozen=True)
class ListOf:
    """A list of objects."""

    item: Type


@dataclass(frozen=True)
class Method:
    """A function as an attribute: bound ones are called without their first parameter."""

    function: Function
    is_bound: bool


Type = Module | Class | Function | Method | Object | ListOf | External | Unknown
LookUp = Callable[[str], Type]


class Types:
    """The types of expressions of the workspace."""

    def __init__(self, modules: Modules) -> None:
        self.modules = modules
        self._depth = 0

    def at_top(self, module: Module) -> LookUp:
        """Returns the function that finds the type of a name at the top of a module."""

        def look_up(name: str) -> Type:
            return self.of_symbol(self.modules.member(module, name))

        return look_up

    def of_symbol(self, symbol: object) -> Type:
        """Returns the type of the value of a symbol."""
        if isinstance(symbol, (Module, Class, Function, External)):
            return symbol
        if not isinstance(symbol, Value):
            return UNKNOWN
        look_up = self._within(symbol.owner) if symbol.owner else self.at_top(symbol.module)
        if symbol.owner is not None and is_enumeration(self.modules, symbol.owner):
            return Object(symbol.owner)
        # TypeAlias says nothing of the value.
        if symbol.annotation is not None and "TypeAlias" not in ast.unparse(symbol.annotation):
            return self.of_annotation(symbol.annotation, look_up)
        return UNKNOWN if symbol.value is None else self.of(symbol.value, look_up)

    def _within(self, owner: Class) -> LookUp:
        """Returns the function that finds the type of a name in the body of a class."""

        def look_up(name: str) -> Type:
            symbol = self.modules.members(owner).get(name)
            if symbol is not None:
                return self.of_symbol(symbol)
            return self.of_symbol(self.modules.member(owner.module, name))

        return look_up

    def of(self, node: ast.expr, look_up: LookUp) -> Type:
        """Returns the type of an expression."""
        if self._depth > _DEPTH:
            return UNKNOWN
        self._depth += 1
        try:
            return self._of(node, look_up)
        finally:
            self._depth -= 1

    def _of(self, node: ast.expr, look_up: LookUp) -> Type:
        match node:
            case ast.Name(id=name):
                return look_up(name)
            case ast.Attribute(value=owner, attr=name):
                return self.attribute(self.of(owner, look_up), name)
            case ast.Call(func=ast.Name(id="super"), args=[]):
                return look_up("super")
            case ast.Call(func=function):
                return self._result(self.of(function, look_up))
            case ast.Subscript(value=owner):
                owner_type = self.of(owner, look_up)
                # `State["MOVING"]` is a member of the enumeration.
                if isinstance(owner_type, Class) and is_enumeration(self.modules, owner_type):
                    return Object(owner_type)
                is_slice = isinstance(node.slice, ast.Slice)
                return (
                    owner_type.item if isinstance(owner_type, ListOf) and not is_slice else UNKNOWN
                )
        return UNKNOWN

    def attribute(self, owner: Type, name: str) -> Type:
        """Returns the type of an attribute."""
        if isinstance(owner, Module):
            return self.of_symbol(self.modules.member(owner, name))
        if not isinstance(owner, (Class, Object)):
            return UNKNOWN
        symbol = self.find(owner, name)
        if isinstance(symbol, Function):
            return self._method(symbol, owner)
        return self.of_symbol(symbol)

    def find(self, owner: Class | Object, name: str) -> object:
        """Returns the symbol of an attribute; None when there is certainly no such one."""
        if isinstance(owner, Class):
            return self.modules.attribute(owner, name)
        if not owner.is_super:
            return self.modules.attribute(owner.of, name)
        above = [self.modules.symbol(node, owner.of.module) for node in owner.of.node.bases]
        symbols = [
            self.modules.attribute(ancestor, name) if isinstance(ancestor, Class) else UNKNOWN
            for ancestor in above
        ]
        return next((symbol for symbol in symbols if symbol is not None), None)

    def _method(self, function: Function, owner: Class | Object) -> Type:
        decorators = function.node.decorator_list
        is_object = isinstance(owner, Object)
        # These decorators do not change how a method is called.
        match [
            decorator
            for decorator in decorators
            if not is_decorated_by(decorator, "override", "abstractmethod")
        ]:
            case []:
                return Method(function, is_bound=is_object)
            case [decorator] if is_decorated_by(decorator, "property", "cached_property"):
                return self._annotated(function) if is_object else UNKNOWN
            case [decorator] if is_decorated_by(decorator, "classmethod"):
                return Method(function, is_bound=True)
            case [decorator] if is_decorated_by(decorator, "staticmethod"):
                return Method(function, is_bound=False)
        return UNKNOWN

    def _result(self, called: Type) -> Type:
        match called:
            case Class():
                return Object(called)
            case Method(function=function):
                return self._annotated(function)
            case Function() if not called.node.decorator_list:
                return self._annotated(called)
        return UNKNOWN

    def _annotated(self, function: Function) -> Type:
        """Returns the type of the result of a function, by its annotation."""
        # A call of it gives something to await.
        if function.node.returns is None or isinstance(function.node, ast.AsyncFunctionDef):
            return UNKNOWN
        return self.of_annotation(function.node.returns, self.at_top(function.module))

    def parameter(self, function: Function, position: int) -> Type:
        """Returns the type of the argument of a method at a position, `self` being the first."""
        arguments = (*function.node.args.posonlyargs, *function.node.args.args)
        if position >= len(arguments) or arguments[position].annotation is None:
            return UNKNOWN
        annotation = arguments[position].annotation
        assert annotation is not None  # noqa: S101 - asked above
        return self.of_annotation(annotation, self.at_top(function.module))

    def of_annotation(self, node: ast.expr, look_up: LookUp) -> Type:
        """Returns the type that an annotation names, of an optional one without None."""
        match node:
            case ast.Constant(value=str(text)):
                try:
                    return self.of_annotation(ast.parse(text, mode="eval").body, look_up)
                except (SyntaxError, ValueError):
                    return UNKNOWN
            case ast.BinOp(left=left, op=ast.BitOr(), right=ast.Constant(value=None)):
                return self.of_annotation(left, look_up)
            case ast.BinOp(left=ast.Constant(value=None), op=ast.BitOr(), right=right):
                return self.of_annotation(right, look_up)
            case ast.Subscript(value=ast.Name(id="Optional"), slice=inner):
                return self.of_annotation(inner, look_up)
            case ast.Subscript(value=ast.Name(id=name), slice=inner) if name in _LISTS:
                # Of tuples, `tuple[X, ...]` alone has elements of one type.
                if isinstance(inner, ast.Tuple):
                    inner = (
                        inner.elts[0] if len(inner.elts) == 2 and _is_rest(inner.elts[1]) else node
                    )
                value_type = UNKNOWN if inner is node else self.of_annotation(inner, look_up)
                return UNKNOWN if value_type is UNKNOWN else ListOf(value_type)
            case ast.Name() | ast.Attribute():
                value_type = self.of(node, look_up)
                return Object(value_type) if isinstance(value_type, Class) else UNKNOWN
        return UNKNOWN


def _is_rest(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is ...


class Names:
    """The names of a file, each where it is used."""

    def __init__(self, module: Module, types: Types) -> None:
        self.module = module
        self.types = types
        self.scopes = scopes_of(module.tree)

    def in_scope(self, scope: Scope) -> LookUp:
        """Returns the function that finds the type of a name in a scope."""

        def look_up(name: str) -> Type:
            if name == "super":
                return self._super(scope)
            definition = scope.find(name)
            if definition is None:
                return UNKNOWN
            owner, bindings = definition
            # Of a name that is bound twice, nobody knows which value it has.
            if len(bindings) != 1 or name in _probed(scope, owner):
                return UNKNOWN
            return self._bound(owner, bindings[0])

        return look_up

    def _bound(self, scope: Scope, binding: Binding) -> Type:
        match binding.how, binding.node:
            case Bound.IMPORT, (ast.Import() | ast.ImportFrom()) as node:
                return self._imported(node, binding.alias) if binding.alias else UNKNOWN
            case Bound.CLASS, ast.ClassDef() as node:
                return self._class(node) or UNKNOWN
            case Bound.VALUE, ast.expr() as node:
                return self.types.of(node, self.in_scope(scope))
            case Bound.ANNOTATED, ast.AnnAssign(annotation=annotation):
                return self.types.of_annotation(annotation, self.in_scope(scope))
            case Bound.ITEM, ast.expr() as node:
                items = self.types.of(node, self.in_scope(scope))
                return items.item if isinstance(items, ListOf) else UNKNOWN
            case Bound.PARAMETER, ast.arg() as node:
                return self._parameter(scope, node, binding.position)
        return UNKNOWN

    def _imported(self, node: ast.Import | ast.ImportFrom, alias: ast.alias) -> Type:
        if isinstance(node, ast.Import):
            name = alias.name if alias.asname else alias.name.partition(".")[0]
            symbol = self.types.modules.find(name)
            return symbol or UNKNOWN
        source = absolute(node, self.module.name, is_package=self.module.is_package)
        module = self.types.modules.find(source) if source else UNKNOWN
        if not isinstance(module, Module):
            return UNKNOWN
        return self.types.of_symbol(self.types.modules.member(module, alias.name))

    def _class(self, node: ast.ClassDef) -> Class | None:
        """Returns a class of the file; None for one inside of a function."""
        modules, parent = self.types.modules, self.scopes[node].parent
        symbol: object = None
        if parent is not None and isinstance(parent.node, ast.ClassDef):
            outer = self._class(parent.node)
            symbol = modules.members(outer).get(node.name) if outer else None
        elif parent is not None and isinstance(parent.node, ast.Module):
            symbol = modules.member(self.module, node.name)
        return symbol if isinstance(symbol, Class) and symbol.node is node else None

    def _owner(self, scope: Scope) -> Class | None:
        """Returns the class of the method that a scope is of."""
        if scope.parent is None or not isinstance(scope.parent.node, ast.ClassDef):
            return None
        return self._class(scope.parent.node)

    def _super(self, start: Scope) -> Type:
        method = start.function
        owner = self._owner(method) if method else None
        return Object(owner, is_super=True) if owner else UNKNOWN

    def _parameter(self, scope: Scope, node: ast.arg, position: int) -> Type:
        owner, function = self._owner(scope), scope.node
        is_method = owner is not None and isinstance(
            function, ast.FunctionDef | ast.AsyncFunctionDef
        )
        if node.annotation is not None and not (is_method and position == 0):
            return self.types.of_annotation(node.annotation, self.in_scope(scope.parent or scope))
        if owner is None or not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            return UNKNOWN
        decorators = function.decorator_list
        if position == 0 and not any(
            is_decorated_by(decorator, "staticmethod") for decorator in decorators
        ):
            is_class = any(is_decorated_by(decorator, "classmethod") for decorator in decorators)
            return owner if is_class else Object(owner)
        if position < 0 or decorators:
            return UNKNOWN
        # The base that calls the method says by its annotations what it gives.
        base = self.types.find(Object(owner, is_super=True), function.name)
        return self.types.parameter(base, position) if isinstance(base, Function) else UNKNOWN


def _probed(start: Scope, end: Scope) -> set[str]:
    """Returns the names that are only probed, from one scope to one around it."""
    probed: set[str] = set()
    scope: Scope | None = start
    while scope is not None:
        probed |= scope.probed
        scope = None if scope is end else scope.parent
    return probed
