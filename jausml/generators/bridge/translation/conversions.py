"""Values through the conversions of an assignment, in order."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from jausml.generation.literals import python_literal
from jausml.generators.bridge.translation.formulas import ExpressionStatements
from jausml.generators.bridge.translation.tables import look_up
from jausml.generators.bridge.translation.values import (
    BOOLEAN,
    INPUT_TYPES,
    NUMBERS,
    PYTHON_TYPES,
    QUATERNION,
    TIME,
    AssignmentError,
    Value,
)
from jausml.generators.python.codec.jaus_fields import BITS, INTEGER, REAL
from jausml.generators.python.names import snake_case
from jausml.generators.python.statements import call
from jausml.languages.expressions import occurrences, parse_expression, source_names
from jausml.semantics.conversions import conversion_of
from jausml.semantics.conversions.authored import Expression, LookUp, User, WithUnits
from jausml.semantics.conversions.conversion import MAXIMUM
from jausml.semantics.conversions.numbers import Clamp, Limit, Linear, Scale

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.generators.bridge.translation.body import Body
    from jausml.generators.bridge.translation.surroundings import Surroundings
    from jausml.generators.bridge.translation.targets import Target

_RESULTS = {
    "number": REAL,
    "geometry_msgs/Quaternion": QUATERNION,
    "builtin_interfaces/Time": TIME,
    "TimeStamp": BITS,
}

# Characters of a source that may stand in an expression without a name of its own.
_SHORT = 40


class Chain:
    """The conversions of one assignment.

    Args:
        body: Takes statements that the values need before the last one.
        surroundings: The class and the module around.
        target: Where the results go.
        target_paths: To which of its places.
        to_ros: Whether the target is of ROS.
    """

    def __init__(
        self,
        body: Body,
        surroundings: Surroundings,
        target: Target,
        target_paths: Sequence[str],
        *,
        to_ros: bool,
    ) -> None:
        self._body = body
        self._surroundings = surroundings
        self._target = target
        self._target_paths = target_paths
        self._to_ros = to_ros

    def apply(
        self, conversions: Sequence[Any], values: Sequence[Value], source_paths: Sequence[str]
    ) -> list[Value]:
        """Returns the values for the targets.

        Args:
            conversions: The `bridge.Conversion` elements.
            values: The values of the sources.
            source_paths: Their paths, by which expressions name them.

        Raises:
            AssignmentError: A conversion does not take what it gets.
        """
        current, paths = list(values), list(source_paths)
        if not self._keeps_integers(conversions):
            current = [_real(each) for each in current]
        for position, conversion in enumerate(conversions):
            is_last = position == len(conversions) - 1
            before = len(current)
            current = self._convert(conversion, current, paths, is_last=is_last)
            paths = paths if len(current) == before else [f"value{i + 1}" for i in range(99)]
        if len(current) != len(self._target_paths):
            raise AssignmentError(
                f"{', '.join(self._target_paths)}: {len(current)} values for"
                f" {len(self._target_paths)} targets"
            )
        return current

    def scaled(self, values: Sequence[Value], step: tuple[float, float] | None) -> list[Value]:
        """Returns the values in the unit of the target.

        Args:
            values: The results of the conversions.
            step: Factor and offset between the units; None when they are the same.
        """
        if step is None:
            return list(values)
        factor, offset = step
        function, arguments = (Linear.name, (factor, offset)) if offset else (Scale.name, (factor,))
        numbers = tuple(python_literal(each) for each in arguments)
        return [
            replace(
                each,
                code=call(f"conversions.{function}", each.code, *numbers),
                kind=REAL,
                limits=None,
                known=(),
                is_computed=True,
            )
            for each in values
        ]

    def _keeps_integers(self, conversions: Sequence[Any]) -> bool:
        """Whether integers may stay what they are.

        So they may before what gives real numbers anyway, and where all of their digits go to other
        integers.
        """
        known = [conversion_of(each) for each in conversions]
        first = next((each for each in known if not each.changes_nothing), None)
        if first is None or not first.keeps_integers:
            return True
        kinds = {self._target.kind(path) for path in self._target_paths}
        return kinds == {INTEGER} and all(each.keeps_integers and each.keeps_size for each in known)

    # -- one conversion --------------------------------------------------------------------------

    def _convert(
        self, conversion: Any, values: list[Value], paths: list[str], *, is_last: bool
    ) -> list[Value]:
        match conversion_of(conversion):
            case WithUnits():
                return values
            case LookUp():
                return [self._look_up(conversion, values, is_last=is_last)]
            case Expression():
                return [self._expression(conversion, values, paths)]
            case User():
                return self._user(conversion, values, is_last=is_last)
        return self._call(conversion, values)

    def _call(self, conversion: Any, values: list[Value]) -> list[Value]:
        """The function of the runtime that has the name of the conversion."""
        known = conversion_of(conversion)
        if len(values) != len(known.inputs):
            raise AssignmentError(f"{known.name} does not take {len(values)} values")
        arguments = [python_literal(float(each)) for each in conversion.arguments]
        if conversion.quantity is not None:
            is_maximum = MAXIMUM in known.arguments
            arguments = [self._surroundings.quantity(conversion.quantity, is_maximum=is_maximum)]
        if known.needs_clock:
            arguments.append("near=self.now()")
        if isinstance(known, (Clamp, Limit)):
            code = self._limited(values[0], arguments)
        else:
            code = call(f"conversions.{known.name}", *(each.code for each in values), *arguments)
        kinds = [_RESULTS[output] for output in known.outputs]
        return self._results(code, kinds, values)

    def _limited(self, value: Value, ends: Sequence[str]) -> str:
        """A call of the connection, which counts what the map limits on purpose."""
        *_, maximum = ends
        minimum = ends[0] if len(ends) > 1 else f"-{maximum}"
        clamp = self._body.limit_of(Clamp.name).path
        field = python_literal(self._target_paths[0])
        return call(f"{clamp}.within", field, value.code, minimum, maximum)

    def _results(self, code: str, kinds: list[str], values: list[Value]) -> list[Value]:
        """The results of a call; several get a local name each."""
        first = replace(values[0], limits=None, listed=(), known=())
        if len(kinds) == 1:
            return [replace(first, code=code, kind=kinds[0], is_computed=True)]
        places = [
            self._body.local_names.claim(snake_case(name.rpartition(".")[2]))
            for name in _names_for(kinds, self._target_paths)
        ]
        self._body.store(code, ", ".join(places))
        pairs = zip(places, kinds, strict=True)
        return [replace(first, code=place, kind=kind, is_computed=False) for place, kind in pairs]

    def _look_up(self, conversion: Any, values: list[Value], *, is_last: bool) -> Value:
        (value,) = values
        kind = self._target.kind(self._target_paths[0]) if is_last else REAL
        listed = self._target.listed(self._target_paths[0]) if is_last else ()
        table = look_up(conversion.table, value, kind, listed, to_ros=self._to_ros)
        name = self._surroundings.constant(*table.constant)
        code = call(f"conversions.{LookUp.name}", value.code, name)
        limits = (table.known[0], table.known[-1]) if table.known else None
        conditions, limit = value.conditions, value.limit
        return Value(
            code, kind, conditions, limits=limits, limit=limit, known=table.known, is_computed=True
        )

    def _expression(self, conversion: Any, values: list[Value], paths: list[str]) -> Value:
        expression = parse_expression(conversion.expression or "")
        names = source_names(paths)
        codes: dict[int, str] = {}
        used = [each.name for each in occurrences(expression)]
        for index in dict.fromkeys(names[name] for name in used):
            times = sum(names[name] == index for name in used)
            codes[index] = self._plain(values[index], paths[index], times)
        sources = {name: codes[names[name]] for name in used}
        code = ExpressionStatements(self._body, sources).code(expression)
        return Value(code, REAL, values[0].conditions, limit=values[0].limit, is_computed=True)

    def _plain(self, value: Value, path: str, times: int) -> str:
        """The value as Python text that stands some times in an expression."""
        if value.kind not in NUMBERS:
            raise AssignmentError(f"{path}: an expression needs numbers")
        value = _real(value)
        if len(value.code) <= _SHORT and (times == 1 or not value.is_computed):
            return value.code
        return self._body.local(snake_case(path.rpartition(".")[2]), value.code)

    def _user(self, conversion: Any, values: list[Value], *, is_last: bool) -> list[Value]:
        # A bool is an int, and the style allows none as a parameter.
        inputs = [
            "int" if value.kind == BOOLEAN else INPUT_TYPES.get(value.kind, "Any")
            for value in values
        ]
        kinds = [self._target.kind(path) for path in self._target_paths] if is_last else [REAL]
        outputs = [PYTHON_TYPES.get(kind, "Any") for kind in kinds]
        output = outputs[0] if len(outputs) == 1 else f"tuple[{', '.join(outputs)}]"
        method = self._surroundings.user_method(conversion.method or "", inputs, output)
        return self._results(call(method, *(each.code for each in values)), kinds, values)


def _real(value: Value) -> Value:
    """A number as Python's float: ROS takes no int for it, and products of int have no end."""
    if value.kind not in (INTEGER, BOOLEAN):
        return value
    return replace(value, code=call("float", value.code), kind=REAL, is_computed=True)


def _names_for(kinds: Sequence[str], paths: Sequence[str]) -> list[str]:
    """Names for several results: those of the targets when there are as many."""
    if len(paths) == len(kinds):
        return list(paths)
    return ["value"] * len(kinds)
