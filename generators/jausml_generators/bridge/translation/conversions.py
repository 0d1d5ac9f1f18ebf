"""Values through the conversions of an assignment, in order, and the tables that look them up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from jausml.language.attributes.expressions import occurrences, parse_expression, source_names
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.steps import RESULT
from jausml.language.semantics.conversions import authored, conversion_of, numbers
from jausml.language.semantics.conversions.conversion import MAXIMUM
from jausml_generators.bridge.translation import expressions
from jausml_generators.bridge.translation.body import Body
from jausml_generators.bridge.translation.expressions import (
    BITS,
    BOOLEAN,
    INTEGER,
    OCTETS,
    QUATERNION,
    REAL,
    TEXT,
    TIME,
    Authored,
    Cast,
    Constant,
    Convert,
    Expression,
    Limit,
    Negative,
    Now,
    Operand,
    Read,
    Setting,
    UserCall,
)
from jausml_generators.bridge.translation.places import Local, Place
from jausml_generators.bridge.translation.printing import literal
from jausml_generators.bridge.translation.steps import Let
from jausml_generators.bridge.translation.surroundings import Surroundings
from jausml_generators.bridge.translation.targets import Target
from jausml_generators.bridge.translation.values import (
    INPUT_TYPES,
    NUMBERS,
    PYTHON_TYPES,
    UNLIMITED,
    AssignmentError,
    Value,
    constant,
)
from jausml_generators.python.names import snake_case

_RESULTS = {
    "number": REAL,
    "geometry_msgs/Quaternion": QUATERNION,
    "builtin_interfaces/Time": TIME,
    "TimeStamp": BITS,
    "text": TEXT,
    "octets": OCTETS,
}


class Chain:
    """The conversions of one assignment."""

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
            source_paths: Their paths, by which expressions name them.
        """
        current, paths = list(values), list(source_paths)
        if not self._keeps_integers(conversions):
            current = [_real(value) for value in current]
        for position, conversion in enumerate(conversions):
            is_last = position == len(conversions) - 1
            current = self._convert(conversion, current, paths, is_last=is_last)
            # What comes behind works on the result.
            paths = [RESULT]
        if len(current) != len(self._target_paths):
            raise AssignmentError(
                f"{', '.join(self._target_paths)}: {len(current)} values for"
                f" {len(self._target_paths)} targets"
            )
        return current

    def scaled(self, values: Sequence[Value], step: tuple[float, float] | None) -> list[Value]:
        """Returns the values in the unit of the target.

        Args:
            step: Factor and offset between the units; None when they are the same.
        """
        if step is None:
            return list(values)
        factor, offset = step
        known, coefficients = (
            (numbers.Linear, (factor, offset)) if offset else (numbers.Scale, (factor,))
        )
        arguments = tuple(Constant(number, REAL) for number in coefficients)
        # The limits and known values were those before the scale, and prove nothing afterwards.
        return [
            replace(
                value,
                expression=Convert(known.name, (value.expression,), arguments),
                limits=None,
                known=(),
                is_computed=True,
            )
            for value in values
        ]

    def _keeps_integers(self, conversions: Sequence[Any]) -> bool:
        """Whether integers may stay what they are.

        So they may before what gives real numbers anyway, and where all of their digits go to other
        integers.
        """
        known = [conversion_of(conversion) for conversion in conversions]
        first = next((conversion for conversion in known if not conversion.changes_nothing), None)
        # What only copies, or gives reals whatever it is given, needs no integers made real.
        if first is None or not first.keeps_integers:
            return True
        kinds = {self._target.kind(path) for path in self._target_paths}
        return kinds == {INTEGER} and all(
            conversion.keeps_integers and conversion.keeps_size for conversion in known
        )

    # -- one conversion --------------------------------------------------------------------------

    def _convert(
        self, conversion: Any, values: list[Value], paths: list[str], *, is_last: bool
    ) -> list[Value]:
        match conversion_of(conversion):
            case authored.WithUnits():
                return values
            case authored.LookUp():
                return [self._look_up(conversion, values, is_last=is_last)]
            case authored.Expression():
                return [self._expression(conversion, values, paths)]
            case authored.User():
                return self._user(conversion, values, is_last=is_last)
        return self._call(conversion, values)

    def _call(self, conversion: Any, values: list[Value]) -> list[Value]:
        """The function of the runtime that has the name of the conversion."""
        known = conversion_of(conversion)
        if len(values) != len(known.inputs):
            raise AssignmentError(f"{known.name} does not take {len(values)} values")
        arguments: tuple[Expression, ...] = tuple(
            Constant(float(argument), REAL) for argument in conversion.arguments
        )
        if conversion.quantity is not None:
            is_maximum = MAXIMUM in known.arguments
            name = self._surroundings.quantity(conversion.quantity, is_maximum=is_maximum)
            arguments = (Setting(name),)
        kinds = [_RESULTS[output] for output in known.outputs]
        if isinstance(known, numbers.Clamp | numbers.Limit):
            return self._results(self._limited(values[0], arguments), kinds, values)
        inputs = tuple(value.expression for value in values)
        near = Now() if known.needs_clock else None
        return self._results(Convert(known.name, inputs, arguments, near, kinds[0]), kinds, values)

    def _limited(self, value: Value, ends: Sequence[Expression]) -> Expression:
        """The limit of the connection that counts what the map limits on purpose."""
        *_, maximum = ends
        minimum = ends[0] if len(ends) > 1 else _opposite(maximum)
        # The map limits this on purpose, whatever the connection does with what does not fit.
        owner, path = self._body.policies.owner, self._target_paths[0]
        return Limit(owner, "clamp", "within", path, value.expression, (minimum, maximum))

    def _results(
        self, expression: Expression, kinds: list[str], values: list[Value]
    ) -> list[Value]:
        """The results of a conversion; several get a variable each."""
        # What the source promised holds for its own value, not for the result.
        first = replace(values[0], limits=None, listed=(), known=())
        if len(kinds) == 1:
            return [replace(first, expression=expression, is_computed=True)]
        # A variable for each result, so that the conversion is computed once.
        locals_ = tuple(
            Local(snake_case(name.rpartition(".")[2]))
            for name in _names_for(kinds, self._target_paths)
        )
        self._body.add(Let(locals_, expression))
        return [
            replace(first, expression=Read(Place(local), kind), is_computed=False)
            for local, kind in zip(locals_, kinds, strict=True)
        ]

    def _look_up(self, conversion: Any, values: list[Value], *, is_last: bool) -> Value:
        (value,) = values
        kind = self._target.kind(self._target_paths[0]) if is_last else REAL
        listed = self._target.listed(self._target_paths[0]) if is_last else ()
        table = look_up(conversion.table, value, kind, listed, to_ros=self._to_ros)
        name = self._surroundings.constant(*table.constant)
        lookup = expressions.LookUp(value.expression, name, kind)
        limits = (table.known[0], table.known[-1]) if table.known else None
        return Value(
            lookup,
            value.conditions,
            limits=limits,
            policy=value.policy,
            known=table.known,
            is_computed=True,
        )

    def _expression(self, conversion: Any, values: list[Value], paths: list[str]) -> Value:
        expression = parse_expression(conversion.expression or "")
        names = source_names(paths)
        # Each source once, however often the expression names it, and in a stable order.
        used = dict.fromkeys(occurrence.name for occurrence in occurrences(expression))
        by_index = {
            at: self._operand(values[at], paths[at])
            for at in dict.fromkeys(names[name] for name in used)
        }
        operands = tuple((name, by_index[names[name]]) for name in used)
        formula = Authored(expression, operands)
        return Value(formula, values[0].conditions, policy=values[0].policy, is_computed=True)

    @staticmethod
    def _operand(value: Value, path: str) -> Operand:
        """A value as one that an expression names."""
        if value.kind not in NUMBERS:
            raise AssignmentError(f"{path}: an expression needs numbers")
        value = _real(value)
        return Operand(
            value.expression, snake_case(path.rpartition(".")[2]), is_computed=value.is_computed
        )

    def _user(self, conversion: Any, values: list[Value], *, is_last: bool) -> list[Value]:
        # A bool is an int, and the style allows none as a parameter.
        types = [
            "int" if value.kind == BOOLEAN else INPUT_TYPES.get(value.kind, "Any")
            for value in values
        ]
        # Only what the last conversion gives must have the type of the target.
        kinds = [self._target.kind(path) for path in self._target_paths] if is_last else [REAL]
        outputs = [PYTHON_TYPES.get(kind, "Any") for kind in kinds]
        output = outputs[0] if len(outputs) == 1 else f"tuple[{', '.join(outputs)}]"
        method = self._surroundings.user_method(conversion.method or "", types, output)
        inputs = tuple(value.expression for value in values)
        return self._results(UserCall(method, inputs, kinds[0]), kinds, values)


def _real(value: Value) -> Value:
    """A number as a real: ROS takes no integer for it, and products of integers have no end."""
    if value.kind not in (INTEGER, BOOLEAN):
        return value
    return replace(value, expression=Cast(value.expression, REAL), is_computed=True)


def _opposite(value: Expression) -> Expression:
    if isinstance(value, Constant):
        return Constant(-float(value.value), REAL)
    return Negative(value)


def _names_for(kinds: Sequence[str], paths: Sequence[str]) -> list[str]:
    """Names for several results: those of the targets when there are as many."""
    if len(paths) == len(kinds):
        return list(paths)
    return ["value"] * len(kinds)


@dataclass(frozen=True)
class Table:
    """A table in one direction.

    Attributes:
        known: All integers that it yields; empty when it yields others.
    """

    constant: tuple[str, str, Sequence[str], str, str]
    known: tuple[int, ...]


def look_up(
    table: bridge.ValueTable,
    value: Value,
    kind: str,
    listed: Sequence[tuple[str, str]],
    *,
    to_ros: bool,
) -> Table:
    """Returns a table as the dictionary that a look_up needs.

    Args:
        value: What is looked up; its kind is that of the keys.
        listed: Names and values of what is found, as its field names them.
    """
    pairs: dict[str, Constant] = {}
    for entry in table.entries:
        texts = (entry.jaus, entry.ros) if to_ros else (entry.ros, entry.jaus)
        key = _constant(str(texts[0] or ""), value.kind, value.listed, table.name)
        result = _constant(str(texts[1] or ""), kind, listed, table.name)
        # The first entry of a key counts, so that tables read from top to bottom.
        pairs.setdefault(literal(key), result)
    ends = "JAUS to ROS" if to_ros else "ROS to JAUS"
    about = f"Table {table.name}, {ends}."
    annotation = f"dict[{_type(value.kind)}, {_type(kind)}]"
    items = [f"{text}: {literal(output)}" for text, output in pairs.items()]
    name = f"{table.name} to {'ros' if to_ros else 'jaus'}"
    known: tuple[int, ...] = ()
    if kind == INTEGER:
        # With all results known, a limit at the target may prove unnecessary.
        known = tuple(sorted({int(output.value or 0) for output in pairs.values()}))
    return Table((name, annotation, items, "{}", about), known)


def _constant(text: str, kind: str, listed: Sequence[tuple[str, str]], table: str) -> Constant:
    """A value of a table; names of values come before the values themselves."""
    try:
        return constant(kind, text, UNLIMITED, f"table {table}", listed)
    except AssignmentError:
        # true and false are 1 and 0 where JAUS has no bool.
        if kind == INTEGER and text in {"true", "false"}:
            return Constant(int(text == "true"), kind)
        if kind == BOOLEAN and text in {"0", "1"}:
            return Constant(text == "1", kind)
        raise


def _type(kind: str) -> str:
    return PYTHON_TYPES.get(kind, "Any")
