"""Assignments of attribute maps as straight-line Python statements.

An expression carries the kind of its value, so that the store at the end knows what is left to do:
a real for a ROS float, a limit for a scaled JAUS field, and so on. Text of the model enters the
statements only as literals and as names that were found in the model's types.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from jausml.generation.literals import LINE_WIDTH, printable, python_literal, python_string
from jausml.generators.common.guards import CURRENT_COMMAND, may_set_limits
from jausml.generators.common.jaus_fields import (
    BITS,
    INTEGER,
    OCTETS,
    REAL,
    TEXT,
    JausField,
    Limits,
    jaus_field,
)
from jausml.generators.common.layout import Call, statement
from jausml.generators.common.ros_fields import INTEGER_RANGES, RosField, ros_field

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.generators.common.messages import MessageView

BOOLEAN, QUATERNION, TIME = "boolean", "quaternion", "time"
MARGIN = 8
CONVERSION = "http://www.jausml.org/bridge/conversion"

_SINGLE = (-3.4028234663852886e38, 3.4028234663852886e38)
_DOUBLE = (-1.7976931348623157e308, 1.7976931348623157e308)
_COUNTED_BY_32_BITS = 2**32 - 1
_POLICIES = {
    "clamp": "clamp",
    "dropField": "drop_field",
    "dropMessage": "drop_message",
    "error": "error",
}
_STEP = " " * 4
_TIMESTAMP = ("milliseconds", "seconds", "minutes", "hour", "day")
_RESULTS = {
    "number": REAL,
    "geometry_msgs/Quaternion": QUATERNION,
    "builtin_interfaces/Time": TIME,
    "TimeStamp": BITS,
}
_ROS_KINDS = {
    "geometry_msgs/Quaternion": QUATERNION,
    "builtin_interfaces/Time": TIME,
    "bool": BOOLEAN,
    "string": TEXT,
    "wstring": TEXT,
    "float32": REAL,
    "float64": REAL,
    **dict.fromkeys(INTEGER_RANGES, INTEGER),
}
_NUMBERS = {REAL, INTEGER, BOOLEAN}


class AssignmentError(ValueError):
    """An assignment whose value does not fit its target."""


@dataclass(frozen=True)
class Value:
    """A value on its way to the target.

    Attributes:
        code: Python expression.
        kind: Kind of the value.
        guards: Python paths that must not be None.
        units: Unit of the source; empty when unknown.
        limits: Least and greatest value of a number that is not converted, when they are known.
        limit: Python path of what keeps the value within its target; empty for constants.
    """

    code: str | Call
    kind: str
    guards: tuple[str, ...] = ()
    units: str = ""
    limits: tuple[float, float] | None = None
    limit: str = ""


@dataclass
class Body:
    """Statements of a method, and the runtime names that they use.

    Attributes:
        owner: Python path of the connection, e.g. `self.speed`.
        policy: Out-of-range policy of the connection, as a literal of the metamodel.
        lines: Lines, indented for a method.
        names: Names of the runtime, as (module, name).
    """

    owner: str = ""
    policy: str = "clamp"
    lines: list[str] = field(default_factory=list)
    names: set[tuple[str, str]] = field(default_factory=set)
    _required: set[str] = field(default_factory=set)

    @property
    def text(self) -> str:
        """All statements; the first line is not indented here."""
        return "\n".join(self.lines).lstrip()

    def use(self, module: str, name: str) -> str:
        """Notes that a runtime name is used, and returns it."""
        self.names.add((module, name))
        return name

    def limit(self, assignment: Any) -> str:
        """Returns the Python path of what keeps the value of an assignment within its target."""
        own = assignment.outOfRange.name
        return f"{self.owner}.{_POLICIES[self.policy if own == 'asConnection' else own]}"

    def add(self, statement: str, depth: int = 0) -> None:
        """Adds the lines of a statement."""
        margin = " " * (MARGIN + 4 * depth)
        self.lines += [margin + line for line in statement.split("\n")]

    def store(self, code: str | Call, place: str = "", units: str = "", depth: int = 0) -> None:
        """Adds an assignment to a place, or a call; a unit becomes a comment."""
        before = f"{place} = " if place else ""
        column = MARGIN + 4 * depth
        text = statement(code, before, column)
        comment = f"  # {' '.join(printable(units).split())}" if units else ""
        if comment and column + len(text.rpartition("\n")[2] + comment) > LINE_WIDTH:
            self.add(comment.strip(), depth)
        else:
            text += comment
        self.add(text, depth)

    def require(self, source: JausField) -> None:
        """Adds the refusal of messages that lack a field."""
        for path in source.may_be_absent:
            if path not in self._required:
                self._required.add(path)
                error = self.use("bridge_statistics", "AbsentFieldError")
                self.add(f"if source.{path} is None:")
                self.add(f"raise {error}({python_string(source.path)})", depth=1)

    def guard(self, paths: Sequence[str]) -> int:
        """Adds the condition that fields are there; returns the depth of what follows."""
        tests = [f"source.{path} is not None" for path in paths if path not in self._required]
        if not tests:
            return 0
        line = f"if {' and '.join(tests)}:"
        if MARGIN + len(line) > LINE_WIDTH:
            inner = [f"{_STEP}{'and ' if i else ''}{test}" for i, test in enumerate(tests)]
            line = "\n".join(["if (", *inner, "):"])
        if self._last_guard() != line:
            self.add(line)
        return 1

    def _last_guard(self) -> str:
        """The condition that still holds for a statement added now at depth 1."""
        inner = " " * (MARGIN + 4)
        for index in range(len(self.lines) - 1, -1, -1):
            if not self.lines[index].startswith((inner, " " * MARGIN + ")")):
                line = self.lines[index].strip()
                return line if index < len(self.lines) - 1 and line.endswith(":") else ""
        return ""


# ---------------------------------------------------------------- to ROS


def to_ros(connection: Any, message: MessageView, owner: str, class_name: str) -> Body:
    """Returns the statements that make `target` (ROS) from `source` (JAUS).

    Args:
        connection: The `bridge.Connection`, whose map has the assignments.
        message: Its JAUS message.
        owner: Python path of the connection.
        class_name: Name of the ROS message class in the module.

    Raises:
        AssignmentError: A value does not fit its target.
        PathError: A path leads nowhere.
    """
    body, attribute_map = Body(owner, connection.outOfRange.name), connection.map
    if may_set_limits(attribute_map.message):
        _refuse_limits(body, attribute_map)
    for assignment in attribute_map.toRos:
        if _needs_its_sources(assignment):
            for path in _paths(assignment.source):
                body.require(jaus_field(message, path))
    body.add(f"target = {class_name}()")
    for assignment in attribute_map.toRos:
        kind = assignment.eClass.name
        if kind == "Ignore":
            continue
        target = ros_field(attribute_map.type, assignment.target)
        if kind == "FieldAssignment":
            limit = body.limit(assignment)
            sources = [jaus_field(message, path) for path in _paths(assignment.source)]
            values = [_from_jaus(source, limit) for source in sources]
            _store_ros(body, target, _converted(body, assignment, values))
        elif kind == "ConstantAssignment":
            _store_ros(body, target, ros_constant(target, assignment.value))
        else:
            _store_ros(body, target, Value("self.now()", TIME))
    return body


def _refuse_limits(body: Body, attribute_map: Any) -> None:
    """Adds the refusal of limits, which a topic would carry as if they were the command.

    Where the map carries the CommandType as well, the ROS side can tell them apart.
    """
    carried = {
        path
        for assignment in attribute_map.toRos
        if assignment.eClass.name == "FieldAssignment"
        for path in _paths(assignment.source)
    }
    if "CommandType" not in carried:
        error = body.use("conversions", "ConversionError")
        body.add(f"if source.command_type != {CURRENT_COMMAND}:")
        body.add(f'raise {error}("a limit, not the current command")', depth=1)


def ros_constants(message_type: Any, class_name: str, assignments: Iterable[Any]) -> Body:
    """Returns the statements that make `target` (ROS) of constants."""
    body = Body()
    body.add(f"target = {class_name}()")
    for assignment in assignments:
        target = ros_field(message_type, assignment.target)
        _store_ros(body, target, ros_constant(target, assignment.value))
    return body


def ros_constant(target: RosField, text: str) -> Value:
    """Returns a constant as the target's type needs it.

    Raises:
        AssignmentError: The text is no such value.
    """
    kind = ros_kind(target)
    limits = INTEGER_RANGES.get(target.type, (-math.inf, math.inf))
    return Value(_literal(kind, text, limits, target.path), kind, limits=limits)


def _store_ros(body: Body, target: RosField, value: Value) -> None:
    depth = body.guard(value.guards)
    place, wanted = f"target.{target.path}", ros_kind(target)
    if wanted in {QUATERNION, TIME} and value.kind == wanted:
        setter = body.use("bridge_values", f"set_{wanted}")
        body.store(Call(setter, (place, value.code)), depth=depth)
        return
    if wanted == INTEGER and value.kind in _NUMBERS:
        code = _integer(value, target.path, INTEGER_RANGES[target.type])
    elif wanted == REAL and value.kind in {INTEGER, BOOLEAN}:
        code = Call("float", (value.code,))
    elif wanted == value.kind == REAL and target.type == "float32":
        code = _single(value, target.path)
    elif wanted == value.kind == TEXT and value.limit and target.bound:
        code = _limited(f"{value.limit}.text", value.code, target.path, (0, target.bound))
    elif wanted == BOOLEAN and value.kind in {INTEGER, REAL}:
        code = Call("bool", (value.code,))
    elif wanted == value.kind:
        code = value.code
    else:
        raise AssignmentError(f"{value.kind} does not fit {target.path} ({target.type})")
    body.store(code, place, value.units, depth)


def ros_kind(target: RosField) -> str:
    """Returns the kind of value that a ROS field holds."""
    if target.is_array:
        return OCTETS if target.type in {"uint8", "byte"} else f"array of {target.type}"
    return _ROS_KINDS.get(target.type, target.type)


# ---------------------------------------------------------------- to JAUS


def to_jaus(connection: Any, message: MessageView, owner: str) -> Body:
    """Returns the statements that make `target` (JAUS) from `source` (ROS).

    Args:
        connection: The `bridge.Connection`, whose map has the assignments.
        message: Its JAUS message.
        owner: Python path of the connection.

    Raises:
        AssignmentError: A value does not fit its target.
        PathError: A path leads nowhere.
    """
    body, made = Body(owner, connection.outOfRange.name), set[str]()
    attribute_map = connection.map
    body.add(f"target = {message.class_name}()")
    for assignment in attribute_map.toJaus:
        kind = assignment.eClass.name
        if kind == "Ignore":
            continue
        target = jaus_field(message, assignment.target)
        _make_containers(body, target, made)
        if kind == "FieldAssignment":
            sources = [ros_field(attribute_map.type, path) for path in _paths(assignment.source)]
            limit = body.limit(assignment)
            values = [_from_ros(source, limit) for source in sources]
            _store_jaus(body, target, _converted(body, assignment, values))
        elif kind == "ConstantAssignment":
            _store_constant(body, target, assignment.value)
        else:
            _store_jaus(body, target, _stamp(body))
    return body


def jaus_constants(message: MessageView, assignments: Iterable[Any]) -> Body:
    """Returns the statements that make `target` (JAUS) of constants."""
    body, made = Body(), set[str]()
    body.add(f"target = {message.class_name}()")
    for assignment in assignments:
        target = jaus_field(message, assignment.target)
        _make_containers(body, target, made)
        _store_constant(body, target, assignment.value)
    return body


def _store_constant(body: Body, target: JausField, text: str) -> None:
    literal = _literal(target.kind, text, target.limits, target.path)
    body.store(literal, f"target.{target.attribute}", target.units)


def _make_containers(body: Body, target: JausField, made: set[str]) -> None:
    for path, container in target.containers:
        if path not in made:
            made.add(path)
            body.add(f"target.{path} = {container}()")


def _store_jaus(body: Body, target: JausField, value: Value) -> None:
    code = value.code
    if target.kind == INTEGER and value.kind in _NUMBERS:
        code = (
            _listed(value, target) if target.values else _integer(value, target.path, target.limits)
        )
    elif target.kind == REAL and value.kind in _NUMBERS:
        code = value.code if value.kind == REAL else Call("float", (value.code,))
        if value.limits is None or not _within(value.limits, target.limits):
            code = _real(value.limit, code, target.path, target.limits)
    elif target.kind == BITS and value.kind == BITS:
        if target.sub_fields != _TIMESTAMP:
            raise AssignmentError(f"{target.path} is no TimeStamp")
        code = Call(target.class_name, (f"*{value.code}",))
    elif target.kind == value.kind == TEXT:
        code = _limited(f"{value.limit}.text", value.code, target.path, target.limits)
    elif target.kind == value.kind == OCTETS:
        code = _octets(value, target)
    elif target.kind != value.kind:
        raise AssignmentError(f"{value.kind} does not fit {target.path}")
    body.store(code, f"target.{target.attribute}", target.units)


# ---------------------------------------------------------------- values


def _from_jaus(source: JausField, limit: str) -> Value:
    code: str | Call = f"source.{source.attribute}"
    limits = source.brought if source.kind == INTEGER else source.limits
    if source.kind == REAL and not source.is_scaled:
        # The codec hands on what a peer sends; only here is it known what becomes of the rest.
        code = _real(limit, code, source.path, source.limits)
    return Value(code, source.kind, source.may_be_absent, source.units, limits, limit)


def _from_ros(source: RosField, limit: str) -> Value:
    limits = None if source.is_array else INTEGER_RANGES.get(source.type)
    return Value(f"source.{source.path}", ros_kind(source), limits=limits, limit=limit)


def _converted(body: Body, assignment: Any, values: Sequence[Value]) -> Value:
    """The sources through the conversions in order; the first conversion takes them all."""
    guards = tuple(dict.fromkeys(path for value in values for path in value.guards))
    value = replace(values[0], guards=guards)
    inputs = tuple(each.code for each in values)
    for conversion in assignment.conversions:
        function = body.use("conversions", conversion.kind.name)
        arguments = [python_literal(float(each)) for each in conversion.arguments]
        if function == "timestamp_to_time":
            arguments.append("near=self.now()")
        code = Call(function, (*inputs, *arguments))
        value = replace(value, code=code, kind=_result(conversion.kind), limits=None)
        inputs = (code,)
    if len(inputs) > 1:
        raise AssignmentError(f"{assignment.source}: several sources need a conversion")
    return value


def _stamp(body: Body) -> Value:
    function = body.use("conversions", "time_to_timestamp")
    return Value(Call(function, ("self.now()",)), BITS)


def _result(literal: Any) -> str:
    """The kind that a literal of ConversionKind yields, as bridge.ecore annotates it."""
    return _RESULTS[dict(literal.getEAnnotation(CONVERSION).details)["output"]]


def _needs_its_sources(assignment: Any) -> bool:
    is_field = assignment.eClass.name == "FieldAssignment"
    return bool(is_field and assignment.whenAbsent.name == "dropMessage")


def _paths(text: str) -> list[str]:
    return [path.strip() for path in text.split(",")]


def _integer(value: Value, name: str, limits: Limits) -> str | Call:
    if value.kind == INTEGER and value.limits is not None and _within(value.limits, limits):
        return value.code
    return _limited(f"{value.limit}.integer", value.code, name, (int(limits[0]), int(limits[1])))


def _listed(value: Value, target: JausField) -> Call:
    ranges = repr(target.values)
    return Call(f"{value.limit}.listed", (python_string(target.path), value.code, ranges))


def _real(limit: str, code: str | Call, name: str, limits: Limits) -> Call:
    if limits == _DOUBLE:
        return _limited(f"{limit}.finite", code, name, ())
    if limits == _SINGLE:
        return _limited(f"{limit}.single", code, name, ())
    return _limited(limit, code, name, limits)


def _single(value: Value, name: str) -> str | Call:
    if value.limits is not None and _within(value.limits, _SINGLE):
        return value.code
    return _limited(f"{value.limit}.single", value.code, name, ())


def _octets(value: Value, target: JausField) -> Call:
    code = Call("bytes", (value.code,))
    lower, upper = target.limits
    if lower == 0 and upper >= _COUNTED_BY_32_BITS:
        return code
    return _limited(f"{value.limit}.octets", code, target.path, target.limits)


def _within(inner: Limits, outer: Limits) -> bool:
    return outer[0] <= inner[0] <= inner[1] <= outer[1]


def _limited(function: str, code: str | Call, name: str, limits: tuple[float, ...]) -> Call:
    return Call(function, (python_string(name), code, *map(python_literal, limits)))


def _literal(kind: str, text: str, limits: tuple[float, float], place: str) -> str:
    if kind in {REAL, INTEGER}:
        try:
            number = float(text) if kind == REAL else int(text, 0)
        except ValueError as error:
            raise AssignmentError(f"{text!a} is no number ({place})") from error
        if not limits[0] <= number <= limits[1]:
            raise AssignmentError(f"{text!a} is out of the range of {place}")
        return python_literal(number)
    if kind == BOOLEAN and text in {"true", "false"}:
        return python_literal(text == "true")
    if kind == TEXT:
        return python_string(text)
    raise AssignmentError(f"{text!a} does not fit {place}")
