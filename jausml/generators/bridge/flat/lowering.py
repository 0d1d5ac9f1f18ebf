"""Statements of a readable translation as statements on local variables."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.flat.expressions import (
    Names,
    chain_of,
    lowered,
    parts_of,
    stamp_of_time,
    text_of,
)
from jausml.generators.bridge.flat.limits import limit_call
from jausml.generators.python.names import snake_case
from jausml.semantics.attributes import TIME_STAMP
from jausml.semantics.conversions import CONVERSIONS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.generators.bridge.flat.protocols import Values
    from jausml.generators.python.names import Scope

_STEP = " " * 4
_SETTERS = {"set_time": ("sec", "nanosec"), "set_quaternion": ("x", "y", "z", "w")}


@dataclass
class _Place:
    """A field of the target.

    Attributes:
        variable: Local variable or literal that has its value.
        is_sure: Whether it is given a value whatever holds.
        can_be_none: Whether that value may be None.
    """

    variable: str
    is_sure: bool
    can_be_none: bool = False


class Lowering:
    """The statements of one message, or of one element of a list.

    Args:
        names: The names that expressions know.
        writing: Is told what has the values of the target.
        scope: Names of local variables.
        target: Name of the target in the readable translation.
    """

    def __init__(self, names: Names, writing: Values, scope: Scope, target: str) -> None:
        self._names = names
        self._writing = writing
        self._scope = scope
        self._target = target
        self._places: dict[str, _Place] = {}
        self._own: set[str] = set()
        self._first: list[str] = []
        self._lines: list[str] = []
        self._depth = 0

    def lower(self, statements: Iterable[ast.stmt]) -> list[str]:
        """Returns the statements on local variables, and tells what has the target's values.

        Args:
            statements: Those of the readable translation.

        Raises:
            NotFlatError: One of them needs objects.
        """
        self._block(statements)
        for path, place in self._places.items():
            conditional = place.can_be_none or not place.is_sure
            self._writing.put(path, place.variable, conditional=conditional)
        return [*self._first, *self._lines]

    # -- statements ------------------------------------------------------------------------------

    def _block(self, statements: Iterable[ast.stmt]) -> None:
        for each in statements:
            match each:
                case ast.Assign(targets=[place]):
                    self._assign(place, each.value)
                case ast.Expr(value=ast.Call() as call):
                    self._call(call)
                case ast.If():
                    self._if(each)
                case ast.Raise(exc=ast.Call() as error):
                    self._add(f"raise {self._text(error)}")
                case _:
                    raise NotFlatError(f"{type(each).__name__} has no flat form")

    def _add(self, line: str) -> None:
        self._lines.append(f"{_STEP * self._depth}{line}")

    def _text(self, expression: ast.expr) -> str:
        return text_of(lowered(expression, self._names))

    def _if(self, statement: ast.If) -> None:
        match statement.body, statement.orelse:
            case [ast.Assign(targets=[ast.Name() as first])], [ast.Assign(targets=[second])] if (
                ast.unparse(second) == first.id
            ):
                (body,), (otherwise,) = statement.body, statement.orelse
                values = (body.value, otherwise.value)  # type: ignore[attr-defined]
                self._assign(first, ast.IfExp(statement.test, *values))
                return
        self._add(f"if {self._text(statement.test)}:")
        self._inner(statement.body)
        if statement.orelse:
            self._add("else:")
            self._inner(statement.orelse)

    def _inner(self, statements: list[ast.stmt]) -> None:
        self._depth += 1
        before = len(self._lines)
        self._block(statements)
        if len(self._lines) == before:
            self._add("pass")
        self._depth -= 1

    def _call(self, call: ast.Call) -> None:
        function = ast.unparse(call.func)
        if function not in _SETTERS:
            raise NotFlatError(f"{function} has no flat form")
        place, value = call.args
        root, path = chain_of(place)
        if root != self._target:
            raise NotFlatError(f"{ast.unparse(place)} is no part of the target")
        places = [f"{path}.{part}" for part in _SETTERS[function]]
        variables = [self._variable(each) for each in places]
        parts = text_of(parts_of(lowered(value, self._names)))
        self._add(f"{', '.join(variables)} = {parts}")

    # -- assignments -----------------------------------------------------------------------------

    def _assign(self, place: ast.expr, value: ast.expr) -> None:
        root, path = chain_of(place)
        if root == self._target:
            if path:
                self._give(path, value)
        elif root == "self":
            self._add(f"{self._text(place)} = {self._text(value)}")
        elif isinstance(place, ast.Name):
            self._names.variables.add(place.id)
            self._store(place.id, value)
        elif isinstance(place, ast.Tuple) and all(isinstance(e, ast.Name) for e in place.elts):
            self._names.variables |= {e.id for e in place.elts if isinstance(e, ast.Name)}
            self._add(f"{ast.unparse(place).strip('()')} = {self._text(value)}")
        else:
            raise NotFlatError(f"{ast.unparse(place)} has no flat form")

    def _give(self, path: str, value: ast.expr) -> None:
        """Gives a field of the target its value."""
        if isinstance(value, ast.Call) and _is_class(value.func):
            self._make(path, value)
            return
        if not self._depth and path not in self._places and self._give_known(path, value):
            return
        variable = self._variable(path)
        if self._store(variable, value):
            self._places[path].can_be_none = True

    def _give_known(self, path: str, value: ast.expr) -> bool:
        """Gives it what a local variable has anyway, or a number; tells whether it is that."""
        root, _ = chain_of(value)
        if root in self._names.roots:
            known = lowered(value, self._names)
            if not isinstance(known, ast.Name):
                return False
            self._places[path] = _Place(known.id, is_sure=True)
            return True
        if isinstance(value, ast.Constant) and type(value.value) in {int, float, bool}:
            self._places[path] = _Place(ast.unparse(value), is_sure=True)
            return True
        return False

    def _make(self, path: str, value: ast.Call) -> None:
        """An object of a class in a field of the target."""
        name = ast.unparse(value.func)
        match value.args:
            case [] if not self._depth:
                self._writing.make(path, name)
            case [ast.Starred(value=ast.Call() as stamp)] if _gives_stamp(stamp.func):
                bits = stamp_of_time(stamp.args[0], self._names)
                self._add(f"{self._variable(path)} = {text_of(bits)}")
            case [ast.Constant(value=int() as index), number] if not self._depth:
                self._places[f"{path}.index"] = _Place(str(index), is_sure=True)
                variable = self._variable(f"{path}.value")
                if self._store(variable, number):
                    raise NotFlatError(f"{path} may be dropped alone")
            case _:
                raise NotFlatError(f"{name} has no flat form")

    def _variable(self, path: str) -> str:
        """Returns the local variable of a field of the target, which is given a value here."""
        known = self._places.get(path)
        if known is not None and known.variable in self._own:
            known.is_sure = known.is_sure or not self._depth
            return known.variable
        words = path.replace("[", "_").replace("]", "").split(".")
        variable = self._scope.claim(snake_case("_".join(words[-2:]) or "value"))
        self._names.variables.add(variable)
        self._own.add(variable)
        if known is not None:
            self._first.append(f"{variable} = {known.variable}")
            self._places[path] = _Place(variable, is_sure=True)
            return variable
        if self._depth:
            self._first.append(f"{variable} = None")
        self._places[path] = _Place(variable, is_sure=not self._depth)
        return variable

    def _store(self, variable: str, value: ast.expr) -> bool:
        """Adds the assignment to a local variable; tells whether it may be None afterwards."""
        call = limit_call(value, self._names.owner)
        if call is None:
            self._add(f"{variable} = {self._text(value)}")
            return False
        can_be_none = self._store(variable, call.value)
        test, outside = call.test(variable), call.outside(variable)
        fitting = call.fitting(variable)
        if can_be_none:
            raise NotFlatError(f"{variable} is limited twice")
        self._names.limits.setdefault(call.policy)
        if fitting == variable:
            self._add(f"if not {test}:" if " and " not in test else f"if not ({test}):")
            self._add(f"{_STEP}{variable} = {outside}")
        else:
            self._add(f"{variable} = {fitting} if {test} else {outside}")
        return call.can_be_none


def _gives_stamp(function: ast.expr) -> bool:
    """Whether a function is the conversion that makes a TimeStamp of an instant."""
    module, name = chain_of(function)
    known = CONVERSIONS.get(name) if module == "conversions" else None
    return known is not None and known.outputs == (TIME_STAMP,)


def _is_class(function: ast.expr) -> bool:
    """Whether a function is a class: of a message, or inside one."""
    root, path = chain_of(function)
    return root[:1].isupper() and (not path or path[:1].isupper() or "." not in path)
