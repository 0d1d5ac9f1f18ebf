"""Statements of a readable translation, but for its loops, as statements on local variables."""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.paths.attributes import TIME_STAMP
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.expressions import (
    Names,
    chain_of,
    lowered,
    parts_of,
    stamp_of_time,
)
from jausml_generators.bridge.flat.limits import limit_call
from jausml_generators.bridge.flat.texts import text_of
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.bridge.flat.protocols import (
        SequenceWriting,
        Values,
    )
    from jausml_generators.python.names import Scope


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


class Statements:
    """The statements of one message, or of one element of a list.

    Args:
        names: The names that expressions know.
        writing: Is told what has the values of the target.
        scope: Names of local variables.
        target: Name of the target in the readable translation.
        constants: Constants of the module.
    """

    def __init__(
        self,
        names: Names,
        writing: Values,
        scope: Scope,
        target: str,
        constants: Constants,
    ) -> None:
        self._constants = constants
        self._names = names
        self._writing = writing
        self._scope = scope
        self._target = target
        # Objects that are made before they are put into a list of the target: their classes, and
        # what writes them once the list is known.
        self._made: dict[str, str] = {}
        self._writings: dict[str, Values] = {}
        self._last: list[Callable[[], Sequence[str]]] = []
        self._sequences: dict[str, SequenceWriting] = {}
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
            writing, inner = self._writing_of(path)
            writing.put(inner, place.variable, conditional=conditional)
        # What is in a list stands behind it, and is complete before it.
        last = [line for lines in reversed(self._last) for line in lines()]
        return [*self._first, *self._lines, *last]

    def _writing_of(self, path: str) -> tuple[Values, str]:
        """Returns what writes the object of a path, and the path in it."""
        root, slash, inner = path.partition("/")
        return (self._writings[root], inner) if slash else (self._writing, path)

    def _target_path(self, node: ast.expr) -> str | None:
        """Returns the path of a place in the target; None for other places."""
        root, path = chain_of(node)
        if root == self._target:
            return path
        return f"{root}/{path}" if root in self._writings else None

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
                case ast.For():
                    self._for(each)
                case ast.Raise(exc=ast.Call() as error):
                    self._add(f"raise {self._text(error)}")
                case _:
                    raise NotFlatError(f"{type(each).__name__} has no flat form")

    def _add(self, line: str) -> None:
        self._lines.append(f"{_STEP * self._depth}{line}")

    def _text(self, expression: ast.expr) -> str:
        return self._code(self._lowered(expression))

    def _lowered(self, expression: ast.expr) -> ast.expr:
        return lowered(expression, self._names)

    def _code(self, expression: ast.expr) -> str:
        """Returns what is lowered as Python text."""
        return text_of(expression)

    def _assigned(self, variables: Sequence[str], code: str) -> None:
        """Adds an assignment to local variables."""
        self._add(f"{', '.join(variables)} = {code}")

    def _if(self, statement: ast.If) -> None:
        match statement.body, statement.orelse:
            case [ast.Assign(targets=[ast.Name() as first])], [ast.Assign(targets=[second])] if (
                ast.unparse(second) == first.id
            ):
                (body,), (otherwise,) = statement.body, statement.orelse
                values = (body.value, otherwise.value)  # type: ignore[attr-defined]
                self._assign(first, ast.IfExp(statement.test, *values))
                return
        test = text_of(lowered(self._truth(statement.test), self._names))
        head = len(self._lines)
        self._add(f"if {test}:")
        self._inner(statement.body)
        if statement.orelse:
            self._add("else:")
            self._inner(statement.orelse)
        else:
            self._join(head, test)

    def _join(self, head: int, test: str) -> None:
        """Joins a condition and one that is all that stands in its block."""
        margin = _STEP * (self._depth + 1)
        first, *rest = self._lines[head + 1 :]
        is_all = all(line.startswith(margin + _STEP) for line in rest)
        if not first.startswith(f"{margin}if ") or not first.endswith(":") or not is_all:
            return
        tests = [test, first[len(margin) + len("if ") : -1]]
        both = " and ".join(f"({each})" if " or " in each else each for each in tests)
        del self._lines[head:]
        self._add(f"if {both}:")
        self._lines += [line[len(_STEP) :] for line in rest]

    def _inner(self, statements: list[ast.stmt]) -> None:
        self._depth += 1
        before = len(self._lines)
        self._block(statements)
        if len(self._lines) == before:
            self._add("pass")
        self._depth -= 1

    def _call(self, call: ast.Call) -> None:
        function = ast.unparse(call.func)
        if isinstance(call.func, ast.Attribute) and call.func.attr == "append":
            self._append(call.func.value, call.args[0])
            return
        if function not in _SETTERS:
            raise NotFlatError(f"{function} has no flat form")
        place, value = call.args
        path = self._target_path(place)
        if path is None:
            raise NotFlatError(f"{ast.unparse(place)} is no part of the target")
        places = [f"{path}.{part}" for part in _SETTERS[function]]
        variables = [self._variable(each) for each in places]
        self._assigned(variables, self._code(parts_of(self._lowered(value))))

    # -- assignments -----------------------------------------------------------------------------

    def _assign(self, place: ast.expr, value: ast.expr) -> None:
        root, _ = chain_of(place)
        path = self._target_path(place)
        if path is not None:
            if isinstance(value, ast.List) and not value.elts and not self._depth:
                self._first += self._sequence(path).begin()
            elif isinstance(value, ast.ListComp):
                self._comprehension(place, value)
            elif path or not (isinstance(value, ast.Call) and _is_class(value.func)):
                self._give(path, value)
        elif isinstance(place, ast.Name) and self._names_object(place.id, value):
            return
        elif root == "self":
            self._add(f"{self._text(place)} = {self._text(value)}")
        elif isinstance(place, ast.Name):
            self._names.variables.add(place.id)
            self._store(place.id, value)
        elif isinstance(place, ast.Tuple) and all(isinstance(e, ast.Name) for e in place.elts):
            self._names.variables |= {e.id for e in place.elts if isinstance(e, ast.Name)}
            self._assigned(ast.unparse(place).strip("()").split(", "), self._text(value))
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
            # A struct packs a truth as it packs 1 or 0.
            truth = value.value
            number = str(int(truth)) if isinstance(truth, bool) else ast.unparse(value)
            self._places[path] = _Place(number, is_sure=True)
            return True
        return False

    def _make(self, path: str, value: ast.Call) -> None:
        """An object of a class in a field of the target."""
        name = ast.unparse(value.func)
        match value.args:
            case [] if not self._depth:
                writing, inner = self._writing_of(path)
                writing.make(inner, name)
            case [ast.Starred(value=ast.Call() as stamp)] if _gives_stamp(stamp.func):
                bits = stamp_of_time(stamp.args[0], self._names)
                self._assigned([self._variable(path)], self._code(bits))
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
        words = path.replace("[", "_").replace("]", "").replace("/", ".").split(".")
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

    # -- objects and lists -----------------------------------------------------------------------

    def _truth(self, test: ast.expr) -> ast.expr:
        """Returns a condition with the number of elements in the place of lists."""
        match test:
            case ast.BoolOp():
                return ast.BoolOp(test.op, [self._truth(each) for each in test.values])
            case ast.UnaryOp(op=ast.Not()):
                return ast.UnaryOp(test.op, self._truth(test.operand))
            case ast.Name() | ast.Attribute() | ast.Subscript():
                root, _ = chain_of(test)
                if root in self._names.roots:
                    return ast.Call(ast.Name("len", ast.Load()), [test], [])
        return test

    def _names_object(self, name: str, value: ast.expr) -> bool:
        """Takes note of a name of an object, or of a part of a list; tells whether it is one."""
        if isinstance(value, ast.Call) and _is_class(value.func) and not value.args:
            self._made[name] = ast.unparse(value.func)
            return True
        if self._reverses(name, value):
            return True
        root, path = chain_of(value)
        if root in self._names.roots and path.endswith("]"):
            self._names.roots[name] = self._names.roots[root].inside(path)
            return True
        if isinstance(value, ast.Subscript) and isinstance(value.slice, ast.Slice):
            root, path = chain_of(value.value)
            if root in self._names.roots and value.slice.lower is None and value.slice.upper:
                most = self._text(value.slice.upper)
                count = text_of(self._names.roots[root].count(path))
                number = self._scope.claim(f"{name}_count")
                self._add(f"{number} = min({count}, {most})")
                self._names.slices[name] = (value.value, number)
                return True
        return False

    def _reverses(self, name: str, value: ast.expr) -> bool:
        """Takes note of the cells of a grid in reversed rows; tells whether they are such."""
        match value:
            case ast.Call(func=function, args=[cells, columns]) if (
                ast.unparse(function) == "conversions.reverse_rows"
            ):
                root, path = chain_of(cells)
            case _:
                return False
        if root not in self._names.roots:
            return False
        found = self._names.roots[root].elements(path)[0].octets()
        self._add(f"{name} = octets.reverse_rows({found.code}, {self._text(columns)})")
        self._names.variables.add(name)
        self._names.octets[name] = replace(found, code=name)
        return True

    def _append(self, place: ast.expr, value: ast.expr) -> None:
        """An object that was made before, as an element of a list."""
        path = self._target_path(place)
        if path is None or self._depth or not isinstance(value, ast.Name):
            raise NotFlatError(f"{ast.unparse(place)} is given elements in turn")
        made = self._made.pop(value.id, "")
        if not made:
            raise NotFlatError(f"{value.id} is no object that was made")
        writing, inner = self._writing_of(path)
        sequence = writing.sequence(inner)
        sequence.element.make("", made)
        self._writings[value.id] = sequence.element
        self._first += sequence.begin()
        self._last.append(sequence.append)

    def claim(self, name: str) -> str:
        """Returns a name of a local variable that is free."""
        return self._scope.claim(name)

    def _add_all(self, lines: Iterable[str]) -> None:
        for line in lines:
            self._add(line)

    def _sequence(self, path: str) -> SequenceWriting:
        """Returns what writes a list of the target."""
        if path not in self._sequences:
            writing, inner = self._writing_of(path)
            self._sequences[path] = writing.sequence(inner)
        return self._sequences[path]

    def _comprehension(self, place: ast.expr, value: ast.ListComp) -> None:
        """A list of values as the loop that it is short for."""
        (generator,) = value.generators
        element = ast.Name(self._scope.claim("element"), ast.Store())
        append = ast.Call(ast.Attribute(place, "append", ast.Load()), [element], [])
        body = [ast.Assign([element], value.elt), ast.Expr(append)]
        self._for(ast.For(generator.target, generator.iter, body, []))

    def _for(self, loop: ast.For) -> None:
        """A loop."""
        raise NotFlatError(f"{ast.unparse(loop.target)} is gone through inside a loop")


def _gives_stamp(function: ast.expr) -> bool:
    """Whether a function is the conversion that makes a TimeStamp of an instant."""
    module, name = chain_of(function)
    known = CONVERSIONS.get(name) if module == "conversions" else None
    return known is not None and known.outputs == (TIME_STAMP,)


def _is_class(function: ast.expr) -> bool:
    """Whether a function is a class: of a message, or inside one."""
    root, path = chain_of(function)
    return root[:1].isupper() and (not path or path[:1].isupper() or "." not in path)
