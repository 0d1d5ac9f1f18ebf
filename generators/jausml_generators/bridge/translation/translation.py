"""Turns the assignments of a map into typed steps: fields, constants and the clock."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import TypeAlias

from jausml.language.attributes.expressions import (
    FUNCTIONS,
    Conditional,
    Number,
    Operation,
    Variable,
    operations,
    parse_expression,
)
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.semantics.assignments.frames import is_coordinate
from jausml.language.semantics.assignments.steps import knows_unknown
from jausml.language.semantics.assignments.units import attribute_measure, result_measure
from jausml.language.semantics.conversions import UnitEffect, conversion_of
from jausml.language.semantics.conversions.authored import Expression as AuthoredExpression
from jausml.language.semantics.conversions.definition import Definition
from jausml.language.semantics.conversions.times import TimeToTimestamp
from jausml.language.semantics.paths.scopes import expanded, place
from jausml_generators.bridge.translation.body import Body
from jausml_generators.bridge.translation.conversions import Chain
from jausml_generators.bridge.translation.expressions import (
    BITS,
    REAL,
    TEXT,
    Authored,
    Convert,
    Either,
    Expression,
    Limit,
    Now,
    Operand,
    Read,
    Setting,
    marker_value,
)
from jausml_generators.bridge.translation.places import (
    HasValue,
    PathError,
    Place,
    Requirement,
    only_conditions,
    without_implied,
)
from jausml_generators.bridge.translation.policies import NO_POLICY, Policy
from jausml_generators.bridge.translation.ros_fields import ros_field
from jausml_generators.bridge.translation.sources import JausSource, RosSource
from jausml_generators.bridge.translation.steps import Keep, Require, WhereKept
from jausml_generators.bridge.translation.surroundings import Surroundings
from jausml_generators.bridge.translation.targets import JausTarget, RosTarget
from jausml_generators.bridge.translation.values import (
    UNLIMITED,
    AssignmentError,
    Value,
    constant,
    ros_kind,
)
from jausml_generators.python.names import snake_case


def paths_of(text: str) -> list[str]:
    """Returns the paths of a source or target."""
    return [path.strip() for path in text.split(",")]


Frames: TypeAlias = "Mapping[str, str]"
"""Names of frames by the path that they are set at."""


def frames_of(attribute_map: bridge.AttributeMap) -> Frames:
    """Returns the names of frames that a map sets, which nothing but a parameter tells apart."""
    return {str(frame.target): str(frame.value) for frame in frame_assignments(attribute_map)}


def frame_assignments(attribute_map: bridge.AttributeMap) -> list[bridge.ConstantAssignment]:
    """Returns the assignments that set names of frames.

    Paths in lists may be those of the message: a map with lists has none.
    """
    assignments = list(attribute_map.toRos)
    if any(isinstance(assignment, bridge.ListAssignment) for assignment in assignments):
        return []
    return [
        assignment
        for assignment in assignments
        if isinstance(assignment, bridge.ConstantAssignment)
        and _is_frame(str(assignment.target), _kind(attribute_map.type, str(assignment.target)))
    ]


def _kind(message_type: ros.MessageType, path: str) -> str:
    """Returns the kind of value at the end of a path; none where it leads nowhere."""
    try:
        return ros_kind(ros_field(message_type, path))
    except PathError:
        return ""


_RESULT = "=result"
"""How an expression of a choice calls what conversions made; no name of a model has the sign."""


def _is_marker(requirement: Requirement) -> bool:
    return isinstance(requirement, HasValue)


def is_total(conversion: bridge.Conversion) -> bool:
    """Whether a conversion has a result for each number."""
    meaning = conversion_of(conversion)
    if isinstance(meaning, AuthoredExpression):
        expression = parse_expression(conversion.expression or "")
        return operations(expression).isdisjoint({"/", "^", *FUNCTIONS})
    return isinstance(meaning.definition, Definition) and not meaning.definition.refused


def _is_frame(path: str, kind: str) -> bool:
    return kind == TEXT and path.endswith("frame_id")


@dataclass(frozen=True)
class Translation(ABC):
    """Assignments of a map in one direction, or of a list in it."""

    body: Body
    surroundings: Surroundings
    map: bridge.AttributeMap
    source: JausSource | RosSource
    target: JausTarget | RosTarget
    name: str
    nested_method: Callable[[Translation, bridge.AttributeMap], str]

    @property
    def to_ros(self) -> bool:
        """Whether the target is of ROS."""
        # Targets of JAUS have a message, those of ROS a type.
        return not hasattr(self.target, "message")

    def require(self, assignments: Iterable[bridge.Assignment]) -> None:
        """Adds the refusal of messages that lack what the assignments cannot do without."""
        for assignment in self._expanded(assignments):
            if not isinstance(assignment, (bridge.FieldAssignment, bridge.ListAssignment)):
                continue
            if assignment.whenAbsent.name != "dropMessage":
                continue
            paths = paths_of(assignment.source)
            if isinstance(assignment, bridge.ListAssignment):
                # The first path is the list; those behind it are single values.
                many = self.source.many(paths.pop(0))
                self.body.require(many.conditions, many.path)
            for path in paths:
                self.body.require(self.source.value(path, NO_POLICY).conditions, path)

    def add(self, assignments: Iterable[bridge.Assignment]) -> None:
        """Adds the statements of assignments."""
        for assignment in self._expanded(assignments):
            match assignment:
                case bridge.FieldAssignment():
                    self._field(assignment)
                case bridge.ConstantAssignment():
                    self._constant(assignment)
                case bridge.ClockAssignment():
                    self._clock(assignment)
                case bridge.ListAssignment():
                    self.add_list(assignment)
                case bridge.MessageAssignment():
                    self.add_message(assignment)

    def _expanded(self, assignments: Iterable[bridge.Assignment]) -> Iterator[bridge.Assignment]:
        for assignment in assignments:
            placed = place(self.map, assignment, to_ros=self.to_ros)
            yield from expanded([assignment], placed.scope) if placed is not None else ()

    def say_unset(self, assignments: Iterable[bridge.Assignment]) -> None:
        """Sets the fields without an assignment to the values that say that they have none."""
        taken = [
            path
            for assignment in assignments
            if not isinstance(assignment, bridge.Ignore)
            for path in paths_of(str(assignment.target))
        ]
        for path in self.target.unset(taken):
            self._store_constant(path, self.target.unknown(path))

    @abstractmethod
    def add_list(self, assignment: bridge.ListAssignment) -> None:
        """Adds the statements that fill a list of the target."""

    @abstractmethod
    def add_message(self, assignment: bridge.MessageAssignment) -> None:
        """Adds the statements that translate a message inside a message."""

    # -- constants and the clock -----------------------------------------------------------------

    def _constant(self, assignment: bridge.ConstantAssignment) -> None:
        self.target.prepare(self.body, assignment.target)
        self._store_constant(assignment.target, assignment.value)

    def _store_constant(self, path: str, text: str) -> None:
        value = self.target.constant(path, text).expression
        if self.to_ros and _is_frame(path, value.kind):
            value = Setting(self.surroundings.frame(self.name, path, text), TEXT)
        self.target.put(self.body, path, value)

    def _clock(self, assignment: bridge.ClockAssignment) -> None:
        self.target.prepare(self.body, assignment.target)
        self._store_now(assignment.target)

    def _store_now(self, path: str) -> None:
        now: Expression = Now()
        if not self.to_ros:
            now = Convert(TimeToTimestamp.name, (now,), kind=BITS)
        self.target.put(self.body, path, self.target.fitted(path, Value(now)))

    # -- fields ----------------------------------------------------------------------------------

    def values_of(self, assignment: bridge.FieldAssignment) -> list[Value]:
        """Returns the values of the sources of an assignment, with what they need to be there."""
        policy = self._policy_of(assignment)
        values = [self.source.value(path, policy) for path in paths_of(assignment.source)]
        if not knows_unknown(assignment):
            return values
        return [
            replace(
                value,
                conditions=tuple(
                    condition for condition in value.conditions if not _is_marker(condition)
                ),
            )
            for value in values
        ]

    def _policy_of(self, assignment: bridge.FieldAssignment) -> Policy:
        placed = place(self.map, assignment, to_ros=self.to_ros)
        targets = placed.target_attributes if placed is not None else []
        return self.body.policies.of(assignment, of_a_place=any(map(is_coordinate, targets)))

    def results_of(
        self, assignment: bridge.FieldAssignment, values: Sequence[Value]
    ) -> list[Value]:
        """Returns the values for the targets of an assignment, in the unit of the targets."""
        targets, to_ros = paths_of(assignment.target), self.to_ros
        chain = Chain(self.body, self.surroundings, self.target, targets, to_ros=to_ros)
        results = chain.apply(assignment.conversions, values, paths_of(assignment.source))
        step = self.surroundings.unit_step(self.map, assignment, to_ros=to_ros)
        return chain.scaled(results, step)

    def _field(self, assignment: bridge.FieldAssignment) -> None:
        targets = paths_of(assignment.target)
        for path in targets:
            self.target.prepare(self.body, path)
        values = self.values_of(assignment)
        policy = assignment.whenAbsent.name
        if policy == "useDefault" and len(values) > 1:
            self._field_of_some(assignment)
            return
        requirements = without_implied(
            condition for value in values for condition in value.conditions
        )
        chosen = self._chosen(assignment, values, requirements) if policy == "useDefault" else None
        if chosen is not None:
            self._put(assignment, [chosen])
            return
        if requirements:
            self._store_absent(assignment, policy)
        if policy == "lastValue" and requirements:
            self._field_with_memory(assignment, values, requirements)
            return
        with self.body.under(requirements):
            self._store(assignment, values)

    def _chosen(
        self,
        assignment: bridge.FieldAssignment,
        values: Sequence[Value],
        requirements: Sequence[Requirement],
    ) -> Value | None:
        """Returns one value for both cases, so that a list is translated as a whole.

        Returns:
            None where a conversion could refuse what a marker stands for, and outside of lists.
        """
        is_element = (
            self.source.top is not None
            and bool(requirements)
            and all(map(_is_marker, requirements))
        )
        if not is_element or not all(map(is_total, assignment.conversions)):
            return None
        marks = [mark for mark in requirements if isinstance(mark, HasValue)]
        asked = dict(operand for mark in marks for operand in mark.operands)
        is_clear = all(
            asked[name] == marker_operand
            for mark in marks
            for name, marker_operand in mark.operands
        )
        if not is_clear:
            return None
        value, *more = self.results_of(assignment, [replace(values[0], conditions=())])
        if more or value.kind != REAL:
            return None
        condition = reduce(lambda a, b: Operation("or", (a, b)), (mark.marker for mark in marks))
        default = Number(float(assignment.defaultValue or 0))
        expression = Conditional(condition, default, Variable(_RESULT))
        operands: dict[str, Expression] = {}
        operands.update(
            (name, marker_value(marker_operand)) for name, marker_operand in asked.items()
        )
        operands[_RESULT] = value.expression
        named_operands = tuple(
            (name, Operand(operand_value, name, is_computed=False))
            for name, operand_value in operands.items()
        )
        return replace(value, expression=Authored(expression, named_operands), is_computed=True)

    def _store_absent(self, assignment: bridge.FieldAssignment, policy: str) -> None:
        """Sets the targets to their values for absent sources."""
        for path in paths_of(assignment.target):
            if policy == "useDefault":
                self._store_constant(path, assignment.defaultValue or "")
            elif policy == "receptionTime":
                self._store_now(path)
            elif policy in {"unstated", "lastValue"} and (text := self.target.unknown(path)):
                self._store_constant(path, text)

    def _field_of_some(self, assignment: bridge.FieldAssignment) -> None:
        """Several sources, of which the absent ones count as the default value."""
        source, policy = self.source.inlined(), self._policy_of(assignment)
        values = [source.value(path, policy) for path in paths_of(assignment.source)]
        tests = [only_conditions(value.conditions) for value in values]
        if all(tests):
            self._store_absent(assignment, "unstated")
            with self.body.where(*dict.fromkeys(tests)):
                self._store(assignment, [self._or_default(assignment, value) for value in values])
        else:
            self._store(assignment, [self._or_default(assignment, value) for value in values])

    def _or_default(self, assignment: bridge.FieldAssignment, value: Value) -> Value:
        if not value.conditions:
            return value
        text, target = assignment.defaultValue or "", assignment.target
        default = constant(value.kind, text, UNLIMITED, target, value.listed)
        either = Either(only_conditions(value.conditions), value.expression, default)
        local = self.body.local(_hint(value.expression), either)
        return replace(value, expression=Read(Place(local), value.kind), conditions=())

    def _field_with_memory(
        self,
        assignment: bridge.FieldAssignment,
        values: Sequence[Value],
        requirements: Sequence[Requirement],
    ) -> None:
        """Keeps what the last message with the sources gave, and stores that."""
        targets = paths_of(assignment.target)
        kept = [
            Setting(
                self.surroundings.memory(
                    f"{self.name}_{snake_case(path.replace('.', '_'))}",
                    self.target.value_type(path),
                ),
                self.target.kind(path),
            )
            for path in targets
        ]
        with self.body.under(requirements):
            for path, setting, value in zip(
                targets, kept, self.results_of(assignment, values), strict=True
            ):
                self.body.add(Keep(setting.name, self.target.fitted(path, value)))
        for path, setting in zip(targets, kept, strict=True):
            inner = self.body.deeper()
            self.target.put(inner, path, setting)
            self.body.add(WhereKept(setting.name, tuple(inner.steps)))

    def _store(self, assignment: bridge.FieldAssignment, values: Sequence[Value]) -> None:
        self._put(assignment, self.results_of(assignment, values))

    def _put(self, assignment: bridge.FieldAssignment, results: Sequence[Value]) -> None:
        remark = self._unit_remark(assignment)
        # A conversion may make another quantity of the source, in a unit that nobody states.
        effects = [conversion_of(conversion).units for conversion in assignment.conversions]
        keeps_units = all(effect is UnitEffect.SAME for effect in effects)
        for path, value in zip(paths_of(assignment.target), results, strict=True):
            words = remark or (value.units if self.to_ros and keeps_units else "")
            self.target.put(self.body, path, self.target.fitted(path, value), words)
            self._refuse_unlimited(path, value.policy)

    def _refuse_unlimited(self, path: str, policy: Policy) -> None:
        """Adds the refusal of a value that would mark the quantity as unlimited in the target."""
        word = {"clamp": "not_clampable"}.get(policy.name, policy.name)
        for has_value in self.target.unlimited(path):
            texts = (path, "the value would say that nothing limits it", word)
            self.body.add(Require(has_value, "OutOfRangeError", texts))

    def _unit_remark(self, assignment: bridge.FieldAssignment) -> str:
        """Both units, where the units of source and target differ."""
        if self.surroundings.unit_step(self.map, assignment, to_ros=self.to_ros) is None:
            return ""
        placed = place(self.map, assignment, to_ros=self.to_ros)
        if placed is None:
            raise AssignmentError(f"{assignment.target}: its map does not have it")
        source_unit = getattr(result_measure(placed), "text", "")
        wanted = [attribute_measure(attribute) for _, attribute in placed.targets]
        return f"{source_unit} to {next(measure.text for measure in wanted if measure is not None)}"


def _hint(value: Expression) -> str:
    """Returns the hint for a variable that takes a value: the name of what it reads."""
    while isinstance(value, Limit):
        value = value.value
    if not isinstance(value, Read):
        return "value"
    place = value.place
    return snake_case(str(place.steps[-1] if place.steps else place.last))
