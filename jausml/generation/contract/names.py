"""What names mean in a file of the user."""

from __future__ import annotations

import ast

from jausml.generation.contract.scopes import Binding, Bound, Scope, scopes_of
from jausml.generation.contract.symbols import UNKNOWN, Class, Function, Module
from jausml.generation.contract.syntax import absolute, is_decorated_by
from jausml.generation.contract.types import ListOf, LookUp, Object, Type, Types


class Names:
    """The names of a file, each where it is used."""

    def __init__(self, module: Module, types: Types) -> None:
        self.module = module
        self.types = types
        self.scopes = scopes_of(module.tree)

    def in_scope(self, scope: Scope) -> LookUp:
        """Returns what names mean in a scope."""

        def look_up(name: str) -> Type:
            if name == "super":
                return self._super(scope)
            found = scope.find(name)
            if found is None:
                return UNKNOWN
            owner, bindings = found
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
            found = self.types.modules.find(name)
            return found or UNKNOWN
        source = absolute(node, self.module.name, is_package=self.module.is_package)
        module = self.types.modules.find(source) if source else UNKNOWN
        if not isinstance(module, Module):
            return UNKNOWN
        return self.types.of_symbol(self.types.modules.member(module, alias.name))

    def _class(self, node: ast.ClassDef) -> Class | None:
        """Returns a class of the file; None for one inside of a function."""
        modules, parent = self.types.modules, self.scopes[node].parent
        found: object = None
        if parent is not None and isinstance(parent.node, ast.ClassDef):
            outer = self._class(parent.node)
            found = modules.members(outer).get(node.name) if outer else None
        elif parent is not None and isinstance(parent.node, ast.Module):
            found = modules.member(self.module, node.name)
        return found if isinstance(found, Class) and found.node is node else None

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
        if position == 0 and not any(is_decorated_by(each, "staticmethod") for each in decorators):
            is_class = any(is_decorated_by(each, "classmethod") for each in decorators)
            return owner if is_class else Object(owner)
        if position < 0 or decorators:
            return UNKNOWN
        base = self.types.find(Object(owner, is_super=True), function.name)
        return self.types.parameter(base, position) if isinstance(base, Function) else UNKNOWN


def _probed(start: Scope, end: Scope) -> set[str]:
    """Returns the names of which nothing is certain, from one scope to one around it."""
    probed: set[str] = set()
    scope: Scope | None = start
    while scope is not None:
        probed |= scope.probed
        scope = None if scope is end else scope.parent
    return probed
