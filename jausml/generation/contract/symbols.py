"""Names that Python modules and classes define, read from their syntax trees; nothing is run."""

from __future__ import annotations

import ast
import builtins
import enum
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from jausml.generation.contract.scopes import Binding, Bound, names_of
from jausml.generation.contract.syntax import (
    SourceProblem,
    absolute,
    flat,
    is_decorated_by,
    last_name,
    tree_of,
)

_KNOWN_BASES = {
    ("abc", "ABC"): object,
    ("typing", "Generic"): object,
    ("typing", "Protocol"): object,
    **{("enum", name): getattr(enum, name) for name in ("Enum", "Flag", "IntEnum", "IntFlag")},
}
"""Classes of the standard library that generated classes derive from: their attributes count."""
_SETTERS = ("setattr", "__setattr__", "vars")


@dataclass(frozen=True, eq=False)
class Module:
    """A module of the workspace."""

    name: str
    tree: ast.Module
    is_package: bool
    is_generated: bool


@dataclass(frozen=True, eq=False)
class Class:
    """A class; `name` is dotted inside of another."""

    name: str
    node: ast.ClassDef
    module: Module


@dataclass(frozen=True, eq=False)
class Function:
    """A function, or a method when it has an owner."""

    node: ast.FunctionDef | ast.AsyncFunctionDef
    module: Module
    owner: Class | None = None


@dataclass(frozen=True, eq=False)
class Value:
    """The value of an assignment or an annotation."""

    annotation: ast.expr | None
    value: ast.expr | None
    module: Module
    owner: Class | None = None


@dataclass(frozen=True)
class External:
    """A name of a module outside of the workspace."""

    module: str
    name: str


class Unknown(enum.Enum):
    """The type of all that cannot be known without running the code."""

    UNKNOWN = enum.auto()


UNKNOWN = Unknown.UNKNOWN
Symbol = Module | Class | Function | Value | External | Unknown


@dataclass(frozen=True)
class _Alias:
    module: str
    name: str
    is_passed_on: bool = False  # whether its module offers the name, as by `import A as A`


@dataclass
class _Names:
    """The names of a body; open when there may be others."""

    symbols: dict[str, Symbol | _Alias] = field(default_factory=dict)
    stars: list[str] = field(default_factory=list)
    is_open: bool = False


class Modules:
    """The modules of a workspace by their dotted names.

    Args:
        read: Returns the text of a path of the workspace; None for none, UNKNOWN for what is
            there and is no text of Python.
    """

    def __init__(
        self,
        read: Callable[[str], str | bytes | Unknown | None],
        packages: Iterable[str],
        generated: Callable[[str], bool],
    ) -> None:
        self._read = read
        self.packages = frozenset(packages)
        self._generated = generated
        self._modules: dict[str, Module | Unknown | None] = {}
        self._scopes: dict[Module, _Names] = {}
        self._members: dict[Class, _Names] = {}

    def find(self, name: str) -> Module | Unknown | None:
        """Returns a module; None when its package has no such one."""
        if name.partition(".")[0] not in self.packages:
            return UNKNOWN
        if name not in self._modules:
            self._modules[name] = self._load(name)
        return self._modules[name]

    def _load(self, name: str) -> Module | Unknown | None:
        # A package of the workspace lies in a folder that bears its name, too.
        place = "/".join((name.partition(".")[0], *name.split(".")))
        for path, is_package in ((f"{place}/__init__.py", True), (f"{place}.py", False)):
            text = self._read(path)
            if isinstance(text, Unknown):
                return UNKNOWN
            if text is not None:
                try:
                    return Module(name, tree_of(text), is_package, self._generated(path))
                except SourceProblem:
                    return UNKNOWN
        return UNKNOWN if self._read(place) is UNKNOWN else None

    def member(self, module: Module, name: str) -> Symbol | None:
        """Returns the symbol that an importer of a name gets; None for an unknown name."""
        return self._member(module, name, ())

    def _member(self, module: Module, name: str, passed: tuple[Module, ...]) -> Symbol | None:
        names = self._scope(module)
        symbol = names.symbols.get(name)
        if isinstance(symbol, _Alias):
            # Modules may import a name from each other.
            if module in passed:
                return UNKNOWN
            return self._imported(symbol, (*passed, module))
        if symbol is not None:
            return symbol
        if module.is_package:
            inner = self.find(f"{module.name}.{name}")
            if inner is not None:
                return inner
        for star in names.stars:
            source = self.find(star)
            if not isinstance(source, Module) or source in passed:
                return UNKNOWN
            starred = self._member(source, name, (*passed, module))
            if starred is not None:
                return starred
        return UNKNOWN if names.is_open or _is_special(name) else None

    def _imported(self, alias: _Alias, passed: tuple[Module, ...]) -> Symbol:
        source = self.find(alias.module)
        if source is UNKNOWN:
            known = alias.module.partition(".")[0] in self.packages
            return UNKNOWN if known else External(alias.module, alias.name)
        if source is None or not alias.name:
            return UNKNOWN if source is None else source
        symbol = self._member(source, alias.name, passed)
        return UNKNOWN if symbol is None else symbol

    def names(self, module: Module) -> list[str]:
        """Returns the names that a module defines or imports."""
        symbols = self._scope(module).symbols
        return [name for name, symbol in symbols.items() if symbol is not UNKNOWN]

    def offered(self, module: Module) -> set[str]:
        """Returns the names that a module defines or passes on, not its own imports."""
        symbols = self._scope(module).symbols
        listed = symbols.get("__all__")
        values = ast.walk(listed.value) if isinstance(listed, Value) and listed.value else ()
        return {
            *(str(value.value) for value in values if isinstance(value, ast.Constant)),
            *(
                name
                for name, symbol in symbols.items()
                if not isinstance(symbol, Unknown)
                and (not isinstance(symbol, _Alias) or symbol.is_passed_on)
            ),
        }

    def _scope(self, module: Module) -> _Names:
        names = self._scopes.get(module)
        if names is None:
            names = self._scopes[module] = _names(module.tree, module)
            names.is_open = "__getattr__" in names.symbols
        return names

    def members(self, cls: Class) -> dict[str, Symbol]:
        """Returns the names of the body and the methods of a class, without its base classes."""
        return {
            name: UNKNOWN if isinstance(symbol, _Alias) else symbol
            for name, symbol in self._body(cls).symbols.items()
        }

    def _body(self, cls: Class) -> _Names:
        names = self._members.get(cls)
        if names is None:
            names = self._members[cls] = _names(cls.node, cls.module, cls)
            for name in _set_by_methods(cls.node):
                known = names.symbols.get(name)
                # A value that methods replace may be of any type.
                if known is None or (isinstance(known, Value) and known.annotation is None):
                    names.symbols[name] = UNKNOWN
            special = names.symbols.keys() & {"__getattr__", "__getattribute__"}
            names.is_open = bool(special or _is_dynamic(cls.node))
        return names

    def ancestors(self, cls: Class) -> list[Class | type | None]:
        """Returns a class and its base classes; None for an unknown one."""
        classes: list[Class | type | None] = []
        self._ancestors(cls, classes)
        return classes

    def _ancestors(self, cls: Class, classes: list[Class | type | None]) -> None:
        if cls in classes:
            return
        classes.append(cls)
        for node in cls.node.bases:
            base = self._base(node, cls)
            if isinstance(base, Class):
                self._ancestors(base, classes)
            else:
                classes.append(base)

    def _base(self, node: ast.expr, cls: Class) -> Class | type | None:
        node = node.value if isinstance(node, ast.Subscript) else node
        symbol = self.symbol(node, cls.module)
        if isinstance(symbol, Class):
            return symbol
        if isinstance(symbol, External):
            return _KNOWN_BASES.get((symbol.module, symbol.name))
        if symbol is None and isinstance(node, ast.Name):
            known = getattr(builtins, node.id, None)
            return known if isinstance(known, type) else None
        return None

    def symbol(self, node: ast.expr, module: Module) -> Symbol | None:
        """Returns the meaning of a dotted name at the top of a module; None for no such name."""
        if isinstance(node, ast.Name):
            return self.member(module, node.id)
        if not isinstance(node, ast.Attribute):
            return UNKNOWN
        owner = self.symbol(node.value, module)
        if isinstance(owner, Module):
            return self.member(owner, node.attr)
        return self.attribute(owner, node.attr) if isinstance(owner, Class) else UNKNOWN

    def attribute(self, cls: Class, name: str) -> Symbol | None:
        """Returns the attribute of a class or its objects by a name; None when there is none."""
        is_open = _is_special(name)
        for ancestor in self.ancestors(cls):
            if isinstance(ancestor, Class):
                body = self._body(ancestor)
                symbol = body.symbols.get(name)
                if symbol is not None:
                    return UNKNOWN if isinstance(symbol, _Alias) else symbol
                is_open = is_open or body.is_open
            elif ancestor is None or any(name in vars(kind) for kind in ancestor.__mro__):
                is_open = True
        return UNKNOWN if is_open else None


def is_enumeration(modules: Modules, cls: Class) -> bool:
    """Tells whether the members of a class are its objects."""
    return any(
        isinstance(ancestor, type) and issubclass(ancestor, enum.Enum)
        for ancestor in modules.ancestors(cls)
    )


def is_slotted(modules: Modules, cls: Class) -> bool:
    """Tells whether objects of a class take no other attributes."""
    return all(
        isinstance(ancestor, Class)
        and ("__slots__" in modules.members(ancestor) or _has_slots(ancestor.node))
        for ancestor in modules.ancestors(cls)
        if ancestor is not object
    )


def _names(node: ast.Module | ast.ClassDef, module: Module, owner: Class | None = None) -> _Names:
    """Returns the names of a body; of one that is defined twice no more is known."""
    names = _Names()
    for name, bindings in names_of(node).items():
        first, *others = (_symbol(name, binding, module, owner) for binding in bindings)
        if name == "*":
            symbols = (first, *others)
            names.stars += [symbol.module for symbol in symbols if isinstance(symbol, _Alias)]
        else:
            names.symbols[name] = first if all(other == first for other in others) else UNKNOWN
    return names


def _symbol(name: str, binding: Binding, module: Module, owner: Class | None) -> Symbol | _Alias:
    """Returns the symbol of a name that a binding defines."""
    match binding.node:
        case ast.ClassDef() as node:
            return Class(f"{owner.name}.{name}" if owner else name, node, module)
        case ast.FunctionDef() | ast.AsyncFunctionDef() as node:
            return Function(node, module, owner)
        case ast.AnnAssign(annotation=annotation, value=value):
            return Value(annotation, value, module, owner)
        case ast.expr() as value if binding.how is Bound.VALUE:
            return Value(None, value, module, owner)
        case ast.Import() if binding.alias:
            # `import a.b` binds a; with `as` it is the inner module that gets the name.
            return _Alias(binding.alias.name if binding.alias.asname else name, "")
        case ast.ImportFrom() as node if binding.alias:
            source = absolute(node, module.name, is_package=module.is_package)
            passes_on = binding.alias.name == binding.alias.asname
            return _Alias(source, binding.alias.name, passes_on)
    return UNKNOWN


def _set_by_methods(node: ast.ClassDef) -> Iterator[str]:
    """Yields the names of attributes that methods of a class set on their object."""
    functions = (
        statement
        for statement in flat(node.body)
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef))
    )
    for function in functions:
        arguments = [*function.args.posonlyargs, *function.args.args][:1]
        for syntax in ast.walk(function) if arguments else ():
            match syntax:
                case ast.Attribute(value=ast.Name(id=name), ctx=ast.Store()):
                    if name == arguments[0].arg:
                        yield syntax.attr


def _is_dynamic(node: ast.ClassDef) -> bool:
    """Tells whether a class may have attributes that its text does not show."""
    known = ("dataclass", "final", "total_ordering", "unique")
    if node.keywords or not all(
        is_decorated_by(expression, *known) for expression in node.decorator_list
    ):
        return True
    named: set[ast.AST] = set()
    for syntax in ast.walk(node):
        match syntax:
            # With a constant key it can be seen what is set.
            case ast.Subscript(slice=ast.Constant()):
                named.add(syntax.value)
            case ast.Call() if syntax not in named and last_name(syntax) in _SETTERS:
                return True
            case ast.Attribute(attr="__dict__"):
                return True
    return False


def _has_slots(node: ast.ClassDef) -> bool:
    return any("slots=True" in ast.unparse(expression) for expression in node.decorator_list)


def _is_special(name: str) -> bool:
    return name.startswith("__") and name.endswith("__")
