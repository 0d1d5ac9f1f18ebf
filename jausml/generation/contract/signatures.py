"""What functions and classes may be called with."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.contract.symbols import Class, Function, Modules
from jausml.generation.contract.syntax import is_decorated_by
from jausml.generation.contract.types import Method

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class Signature:
    """The parameters of a call.

    Attributes:
        positional: Those that may be given by position, in order.
        named: Those that may be given by name.
        required: Those without a default.
        takes_more: Whether any number may be given by position.
        takes_any_name: Whether others may be given by name.
    """

    positional: tuple[str, ...]
    named: frozenset[str]
    required: frozenset[str]
    takes_more: bool = False
    takes_any_name: bool = False

    def problem(self, call: ast.Call) -> tuple[str, ast.keyword | None]:
        """Says why a call does not fit, and which keyword is the reason; empty when it fits."""
        is_open = any(isinstance(each, ast.Starred) for each in call.args)
        names = [each.arg for each in call.keywords if each.arg is not None]
        is_open_by_name = len(names) != len(call.keywords)
        if not self.takes_any_name:
            for each in call.keywords:
                if each.arg is not None and each.arg not in self.named:
                    return f"has no parameter {each.arg}", each
        count = sum(not isinstance(each, ast.Starred) for each in call.args)
        if count > len(self.positional) and not self.takes_more:
            few = len(self.positional)
            return f"takes {few} positional argument{'' if few == 1 else 's'}, not {count}", None
        if is_open or is_open_by_name:
            return "", None
        given = {*self.positional[:count], *names}
        missing = [each for each in self.positional if each in self.required - given]
        missing += sorted(self.required - given - set(missing))
        return (f"needs {', '.join(missing)}", None) if missing else ("", None)


def signature(modules: Modules, called: object) -> Signature | None:
    """Returns what may be given to a function or class; None when it is not certain."""
    match called:
        case Method(function=function, is_bound=is_bound):
            return _of_function(function.node, int(is_bound))
        case Function() if not called.node.decorator_list:
            return _of_function(called.node, 0)
        case Class():
            return _of_class(modules, called)
    return None


def _of_function(node: ast.FunctionDef | ast.AsyncFunctionDef, bound: int) -> Signature:
    given = node.args
    positional = [each.arg for each in (*given.posonlyargs, *given.args)]
    required = positional[: len(positional) - len(given.defaults)][bound:]
    required += [
        each.arg
        for each, default in zip(given.kwonlyargs, given.kw_defaults, strict=True)
        if default is None
    ]
    named = [each.arg for each in (*given.args, *given.kwonlyargs)]
    return Signature(
        tuple(positional[bound:]),
        frozenset(named),
        frozenset(required),
        takes_more=given.vararg is not None,
        takes_any_name=given.kwarg is not None,
    )


def _of_class(modules: Modules, cls: Class) -> Signature | None:
    ancestors = modules.ancestors(cls)
    for each in ancestors:
        if not isinstance(each, Class):
            return None
        members = modules.members(each)
        if "__new__" in members or each.node.keywords:
            return None
        made = members.get("__init__")
        if isinstance(made, Function):
            return None if made.node.decorator_list else _of_function(made.node, 1)
        if any(is_decorated_by(d, "dataclass") for d in each.node.decorator_list):
            return _of_fields([e for e in reversed(ancestors) if isinstance(e, Class)])
        if made is not None or each.node.decorator_list:
            return None
    return None


def _of_fields(classes: Sequence[Class]) -> Signature | None:
    """Returns the parameters of the constructor of a data class."""
    positional: dict[str, bool] = {}
    for cls in classes:
        decorators = [d for d in cls.node.decorator_list if is_decorated_by(d, "dataclass")]
        if not decorators:
            continue
        if any("kw_only" in ast.unparse(d) or "init=" in ast.unparse(d) for d in decorators):
            return None
        for each in cls.node.body:
            if not isinstance(each, ast.AnnAssign) or not isinstance(each.target, ast.Name):
                continue
            annotation = ast.unparse(each.annotation)
            if "ClassVar" in annotation:
                continue
            if "KW_ONLY" in annotation or "InitVar" in annotation:
                return None
            value = ast.unparse(each.value) if each.value is not None else ""
            if value.startswith("field(") and ("init=" in value or "kw_only" in value):
                return None
            is_bare = value.startswith("field(") and "default" not in value
            positional[each.target.id] = not value or is_bare
    required = frozenset(name for name, is_required in positional.items() if is_required)
    return Signature(tuple(positional), frozenset(positional), required)
