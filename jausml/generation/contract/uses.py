"""Uses of the generated interface in a user's file that do not fit it, calls included."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from jausml.generation.contract.finding import (
    Edit,
    File,
    Finding,
    FindingKind,
    attribute_edit,
    name_edit,
)
from jausml.generation.contract.imports import Imports, Lost, Surroundings, alike
from jausml.generation.contract.symbols import (
    Class,
    Function,
    Module,
    Modules,
    is_enumeration,
    is_slotted,
)
from jausml.generation.contract.syntax import is_decorated_by
from jausml.generation.contract.types import Method, Names, Object, Type
from jausml.generation.contract.walk import Place, Walk


@dataclass(frozen=True)
class Signature:
    """The parameters of a call."""

    positional: tuple[str, ...]
    named: frozenset[str]
    required: frozenset[str]
    takes_more: bool = False
    takes_any_name: bool = False

    def problem(self, call: ast.Call) -> tuple[str, ast.keyword | None]:
        """Returns why a call does not fit, and the keyword that is wrong; empty when it fits."""
        is_open = any(isinstance(expression, ast.Starred) for expression in call.args)
        names = [keyword.arg for keyword in call.keywords if keyword.arg is not None]
        is_open_by_name = len(names) != len(call.keywords)
        if not self.takes_any_name:
            for keyword in call.keywords:
                if keyword.arg is not None and keyword.arg not in self.named:
                    return f"has no parameter {keyword.arg}", keyword
        count = sum(not isinstance(expression, ast.Starred) for expression in call.args)
        if count > len(self.positional) and not self.takes_more:
            few = len(self.positional)
            return f"takes {few} positional argument{'' if few == 1 else 's'}, not {count}", None
        # What `*` and `**` give is not known, so nothing is missing for certain.
        if is_open or is_open_by_name:
            return "", None
        arguments = {*self.positional[:count], *names}
        missing = [
            parameter for parameter in self.positional if parameter in self.required - arguments
        ]
        missing += sorted(self.required - arguments - set(missing))
        return (f"needs {', '.join(missing)}", None) if missing else ("", None)


def signature(modules: Modules, called: object) -> Signature | None:
    """Returns the possible arguments of a function or class; None when they are not certain."""
    match called:
        case Method(function=function, is_bound=is_bound):
            return _of_function(function.node, int(is_bound))
        case Function() if not called.node.decorator_list:
            return _of_function(called.node, 0)
        case Class():
            return _of_class(modules, called)
    return None


def _of_function(node: ast.FunctionDef | ast.AsyncFunctionDef, bound: int) -> Signature:
    arguments = node.args
    positional = [posonlyarg.arg for posonlyarg in (*arguments.posonlyargs, *arguments.args)]
    required = positional[: len(positional) - len(arguments.defaults)][bound:]
    required += [
        argument.arg
        for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
        if default is None
    ]
    named = [kwonlyarg.arg for kwonlyarg in (*arguments.args, *arguments.kwonlyargs)]
    return Signature(
        tuple(positional[bound:]),
        frozenset(named),
        frozenset(required),
        takes_more=arguments.vararg is not None,
        takes_any_name=arguments.kwarg is not None,
    )


def _of_class(modules: Modules, cls: Class) -> Signature | None:
    ancestors = modules.ancestors(cls)
    for ancestor in ancestors:
        if not isinstance(ancestor, Class):
            return None
        members = modules.members(ancestor)
        if "__new__" in members or ancestor.node.keywords:
            return None
        initializer = members.get("__init__")
        if isinstance(initializer, Function):
            return None if initializer.node.decorator_list else _of_function(initializer.node, 1)
        if any(
            is_decorated_by(decorator, "dataclass") for decorator in ancestor.node.decorator_list
        ):
            return _of_fields(
                [ancestor for ancestor in reversed(ancestors) if isinstance(ancestor, Class)]
            )
        if initializer is not None or ancestor.node.decorator_list:
            return None
    return None


def _of_fields(classes: Sequence[Class]) -> Signature | None:
    """Returns the parameters of the constructor of a data class."""
    positional: dict[str, bool] = {}
    for cls in classes:
        decorators = [
            decorator
            for decorator in cls.node.decorator_list
            if is_decorated_by(decorator, "dataclass")
        ]
        if not decorators:
            continue
        if any(
            "kw_only" in ast.unparse(decorator) or "init=" in ast.unparse(decorator)
            for decorator in decorators
        ):
            return None
        for statement in cls.node.body:
            if not isinstance(statement, ast.AnnAssign) or not isinstance(
                statement.target, ast.Name
            ):
                continue
            annotation = ast.unparse(statement.annotation)
            if "ClassVar" in annotation:
                continue
            if "KW_ONLY" in annotation or "InitVar" in annotation:
                return None
            value = ast.unparse(statement.value) if statement.value is not None else ""
            if value.startswith("field(") and ("init=" in value or "kw_only" in value):
                return None
            # field() without a default is as required as an annotation alone.
            is_bare = value.startswith("field(") and "default" not in value
            positional[statement.target.id] = not value or is_bare
    required = frozenset(name for name, is_required in positional.items() if is_required)
    return Signature(tuple(positional), frozenset(positional), required)


_IMPORT_CAUGHT = {"ImportError", "ModuleNotFoundError", "Exception", "BaseException", ""}


def misfits(file: File, around: Surroundings) -> list[Finding]:
    """Returns the uses in a file that do not fit."""
    names = Names(file.module, around.types)
    imports = Imports(file, names, around)
    findings = (
        use
        for node, place in Walk(file.tree, names.scopes)
        for use in _Reader(file, names, around, imports, place).read(node)
    )
    return list(dict.fromkeys(findings))


class _Reader:
    """Reader of one node in its scope."""

    def __init__(
        self, file: File, names: Names, around: Surroundings, imports: Imports, place: Place
    ) -> None:
        self._file = file
        self._look_up = names.in_scope(place.scope)
        self._around = around
        self._imports = imports
        self._modules = around.types.modules
        self._place = place

    def read(self, node: ast.AST) -> Iterator[Finding]:
        """Yields the findings about a node itself."""
        match node:
            case ast.Import():
                yield from self._tell_imports(self._imports.of_modules(node))
            case ast.ImportFrom():
                yield from self._tell_imports(self._imports.of_names(node, self._place.scope))
            case ast.Attribute():
                yield from self._attribute(node)
            case ast.Subscript(slice=ast.Constant(value=str(name)) as key):
                yield from self._member(self._type_of(node.value), key, name)
            case ast.Call():
                yield from self._call(node)

    def _type_of(self, node: ast.expr) -> Type:
        return self._around.types.of(node, self._look_up)

    def _tell_imports(self, lost_names: Iterable[Lost]) -> Iterator[Finding]:
        if self._place.caught.isdisjoint(_IMPORT_CAUGHT):
            for lost_name in lost_names:
                place = lost_name.node.lineno, lost_name.node.col_offset
                yield self._use(*place, lost_name.message, lost_name.edits, FindingKind.IMPORT)

    def _attribute(self, node: ast.Attribute) -> Iterator[Finding]:
        owner = self._type_of(node.value)
        # The file itself asks whether the attribute is there.
        if node.attr in self._file.asked or "AttributeError" in self._place.caught:
            return
        if isinstance(owner, Module):
            is_lost = owner.is_generated and self._modules.member(owner, node.attr) is None
            if is_lost and isinstance(node.ctx, ast.Load):
                yield self._lost_attribute(
                    node, owner.name, [owner.name], self._modules.names(owner)
                )
        elif isinstance(owner, (Class, Object)):
            yield from self._look_at(node, owner)

    def _look_at(self, node: ast.Attribute, owner: Class | Object) -> Iterator[Finding]:
        """Looks at an attribute of a class or of an object."""
        cls = owner.of if isinstance(owner, Object) else owner
        generated = [ancestor for ancestor in self._classes(cls) if ancestor.module.is_generated]
        if not generated or not self._is_lost(node, owner, cls):
            return
        members = (name for ancestor in generated for name in self._modules.members(ancestor))
        label = cls.name if cls.module.is_generated else generated[0].name
        places = [f"{ancestor.module.name}.{ancestor.name}" for ancestor in generated]
        yield self._lost_attribute(
            node, label, places, [member for member in members if not member.startswith("_")]
        )

    def _classes(self, cls: Class) -> list[Class]:
        return [
            ancestor for ancestor in self._modules.ancestors(cls) if isinstance(ancestor, Class)
        ]

    def _is_lost(self, node: ast.Attribute, owner: Class | Object, cls: Class) -> bool:
        """Tells whether an attribute certainly does not exist in a class or its objects."""
        name, is_super = node.attr, isinstance(owner, Object) and owner.is_super
        if name.startswith("_") or (is_super and self._is_uncalled(name)):
            return False
        # Where objects take any attribute, one that is set somewhere may be there.
        if not is_slotted(self._modules, cls) and name in self._file.stored:
            return False
        # Classes have the attributes of `type`, too.
        if isinstance(owner, Class) and hasattr(type, name):
            return False
        if self._around.types.find(owner, name) is None:
            # A class from which others derive may be completed by these.
            is_whole = cls.module.is_generated or cls.name not in self._around.derived
            return is_super or is_whole
        # The class may have names that nobody sees; one that generated code had and lost is gone.
        classes = self._classes(cls)
        return not any(name in self._modules.members(ancestor) for ancestor in classes) and any(
            f"{ancestor.module.name}.{ancestor.name}.{name}" in self._around.former
            for ancestor in classes
        )

    def _is_uncalled(self, name: str) -> bool:
        """Tells whether the node is in a method that nothing calls, which has a finding already."""
        method = self._place.scope.function
        return name in self._around.uncalled and name == getattr(method and method.node, "name", "")

    def _member(self, owner: Type, key: ast.Constant, name: str) -> Iterator[Finding]:
        """Looks at `State["MOVING"]`."""
        if not isinstance(owner, Class) or not owner.module.is_generated:
            return
        if is_enumeration(self._modules, owner) and self._modules.attribute(owner, name) is None:
            places, names = [f"{owner.module.name}.{owner.name}"], self._modules.members(owner)
            message, _ = self._lost(owner.name, name, places, names)
            yield self._use(key.lineno, key.col_offset, message)

    def _call(self, node: ast.Call) -> Iterator[Finding]:
        called = self._type_of(node.func)
        match called:
            case Method(function=function) | (Function() as function):
                module, label = function.module, function.node.name
            case Class(module=module, name=label):
                pass
            case _:
                return
        expected = signature(self._modules, called) if module.is_generated else None
        problem, keyword = expected.problem(node) if expected else ("", None)
        if expected is None or not problem:
            return
        edits: tuple[Edit, ...] = ()
        if keyword is not None and keyword.arg is not None:
            name = keyword.arg
            successor = self._around.former.get(f"{module.name}.{label}.{name}", "")
            problem += f"; it is {successor} now" if successor else alike(name, expected.named)
            if successor:
                edits = (name_edit(keyword.lineno, keyword.col_offset, name, successor),)
        place = keyword or node
        yield self._use(place.lineno, place.col_offset, f"{label} {problem}", edits)

    def _lost_attribute(
        self, node: ast.Attribute, label: str, places: list[str], names: Iterable[str]
    ) -> Finding:
        message, successor = self._lost(label, node.attr, places, names)
        edits = (attribute_edit(node, successor),) if successor else ()
        start = (node.end_col_offset or 0) - len(node.attr.encode())
        return self._use(node.end_lineno or node.lineno, start, message, edits)

    def _lost(
        self, label: str, name: str, places: list[str], names: Iterable[str]
    ) -> tuple[str, str]:
        """Returns the message about a name that is not there, and its certain successor."""
        known = [self._around.former.get(f"{place}.{name}") for place in places]
        successor = next(filter(None, known), "")
        message = f"{label} has no {name}"
        message += " any more" if any(candidate is not None for candidate in known) else ""
        message += f"; it is {successor} now" if successor else alike(name, names)
        return message, successor

    def _use(
        self,
        line: int,
        start: int,
        message: str,
        edits: tuple[Edit, ...] = (),
        kind: FindingKind = FindingKind.USE,
    ) -> Finding:
        path, column = self._file.path, self._file.lines.column(line, start)
        return Finding(
            kind, path, line, message, column=column, is_fatal=self._place.is_run, edits=edits
        )
