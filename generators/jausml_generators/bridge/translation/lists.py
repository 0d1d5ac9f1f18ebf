"""Lists of one side as lists of the other, element by element."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from jausml.generation.literals import python_string
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions import conversion_of
from jausml.language.semantics.conversions.authored import User
from jausml.language.semantics.paths.attributes import COUNT
from jausml_generators.bridge.translation.expressions import (
    INTEGER,
    LIST,
    ByName,
    Convert,
    Expression,
    FirstOf,
    Length,
    NamesOf,
    Read,
    UserCall,
)
from jausml_generators.bridge.translation.octet_lists import octets
from jausml_generators.bridge.translation.places import (
    AsLongAs,
    Local,
    Place,
    Requirement,
    There,
    without_implied,
)
from jausml_generators.bridge.translation.policies import NO_POLICY
from jausml_generators.bridge.translation.sources import INDEX, Counters, Many
from jausml_generators.bridge.translation.steps import Each, Octets, Require, Write, sets
from jausml_generators.bridge.translation.targets import ManyTarget
from jausml_generators.bridge.translation.translation import Translation
from jausml_generators.bridge.translation.values import AssignmentError


def add_list(translation: Translation, assignment: bridge.ListAssignment) -> None:
    """Adds the steps that fill a list of the target.

    Args:
        assignment: The `bridge.ListAssignment`.
    """
    _ListSteps(translation, assignment).add()


@dataclass(frozen=True)
class _Items:
    """The items of a loop.

    Attributes:
        may_be_none: Whether an element may be None, where its name was missing.
        is_put_together: Whether they were gathered by name, or by the user.
    """

    value: Expression
    like: Place
    counts: tuple[float, float]
    may_be_none: bool = False
    is_put_together: bool = False


class _ListSteps:
    def __init__(self, translation: Translation, assignment: bridge.ListAssignment) -> None:
        self._outer = translation
        self._body = translation.body
        self._assignment = assignment
        self._paths = [path.strip() for path in assignment.source.split(",")]
        self._many: Many = translation.source.many(self._paths[0])
        self._target: ManyTarget = self._target_list()

    def _target_list(self) -> ManyTarget:
        path = self._assignment.target.strip()
        target: Any = self._outer.target
        names: list[str | None] = []
        if self._outer.to_ros:
            inner = target.field(path).message_type
            names.append(None if inner is None else self._outer.surroundings.type_name(inner))
        target_list: ManyTarget = target.many(path, *names)
        return target_list

    def add(self) -> None:
        """Adds all statements."""
        self._outer.target.prepare(self._body, self._assignment.target.strip())
        with self._body.under(self._all_conditions()):
            items = self._converted()
            items = self._named(items)
            items = self._counted(items)
            self._fill(items)

    def _all_conditions(self) -> tuple[Requirement, ...]:
        others = [self._outer.source.value(path, NO_POLICY) for path in self._paths[1:]]
        conditions = [
            *self._many.conditions,
            *(condition for other in others for condition in other.conditions),
        ]
        return without_implied(conditions)

    # -- what is gone through --------------------------------------------------------------------

    def _converted(self) -> _Items:
        """The elements after the conversions of the list as a whole."""
        first = Read(self._many.place, LIST)
        expression: Expression = first
        policy = self._body.policies.of_wholes
        others = (self._outer.source.value(path, policy) for path in self._paths[1:])
        inputs: tuple[Expression, ...] = (first, *(other.expression for other in others))
        for conversion in self._assignment.conversions:
            known = conversion_of(conversion)
            if isinstance(known, User):
                types = ("Any",) * len(inputs)
                method = self._outer.surroundings.user_method(conversion.method or "", types, "Any")
                expression = UserCall(method, inputs, LIST)
            elif not known.changes_nothing:
                expression = Convert(known.name, inputs, kind=LIST)
            inputs = (expression,)
        if len(inputs) > 1:
            raise AssignmentError(f"{self._assignment.source}: several sources need a conversion")
        items = self._items(expression, self._many.counts)
        # A user may return what is no list of octets, so the short way by a table is closed.
        return replace(items, is_put_together=isinstance(expression, UserCall))

    def _items(self, value: Expression, counts: tuple[float, float]) -> _Items:
        """Elements by a variable, if they do not stand in one anyway."""
        if isinstance(value, Read):
            return _Items(value, value.place, counts)
        place = Place(self._body.local("items", value))
        return _Items(Read(place, LIST), place, counts)

    def _named(self, items: _Items) -> _Items:
        """The elements on the JAUS side in the order of their names."""
        keys = (self._assignment.keys or "").strip()
        names = [str(name) for name in self._assignment.names]
        if not keys:
            return items
        constant = self._outer.surroundings.constant(
            f"{self._assignment.target} names",
            "tuple[str, ...]",
            [python_string(name) for name in names],
            "()",
            f"Names of the elements of {self._many.path}.",
        )
        must = self._assignment.whenAbsent.name == "dropMessage"
        if self._outer.to_ros:
            return self._named_in_ros(items, keys, constant, len(names), must=must)
        key_list = Read(self._outer.source.many(keys).place, LIST)
        needed = self._many.path if must else ""
        is_outermost = isinstance(self._assignment.eContainer(), bridge.AttributeMap)
        # Memory of names across messages is for the list of the message, not for lists within it.
        owner = self._body.policies.owner if needed and is_outermost else ""
        local = self._body.local("items", ByName(constant, key_list, items.value, needed, owner))
        counts = (len(names), len(names))
        # A name may be missing in this message; its element is then None.
        return _Items(Read(Place(local), LIST), Place(constant), counts, may_be_none=True)

    def _named_in_ros(
        self, items: _Items, keys: str, constant: str, count: int, *, must: bool
    ) -> _Items:
        if must:
            whole = AsLongAs(items.like, constant)
            self._body.add(Require(whole, "AbsentFieldError", (self._many.path,)))
        place = Place(self._body.local("items", FirstOf(items.value, constant)))
        target: Any = self._outer.target
        self._body.add(Write(target.field(keys).place, NamesOf(constant, place)))
        counts = (count if must else 0, count)
        return _Items(Read(place, LIST), place, counts, is_put_together=True)

    def _counted(self, items: _Items) -> _Items:
        """The elements, when they are as many as the target carries."""
        wanted = self._target.counts
        if wanted is None:
            return items
        # The source never has more or fewer than the target carries: nothing needs a check.
        if wanted[0] <= items.counts[0] and items.counts[1] <= wanted[1]:
            return items
        limit = self._body.policies.of_wholes.limit("sized", items.value, self._target.path, wanted)
        return replace(items, value=limit)

    def _octets(self, items: _Items) -> Octets | None:
        """Returns the octets of the elements if both sides are octets, and nobody made the list."""
        if items.may_be_none or items.is_put_together:
            return None
        return octets(self._many.start, self._target.start)

    # -- what is made of it ----------------------------------------------------------------------

    def _fill(self, items: _Items) -> None:
        item, index, element = Local("item"), Local("index"), Local("element")
        counters = Counters({INDEX: Read(Place(index), INTEGER), COUNT: Length(items.like)})
        conditions: tuple[Requirement, ...] = (There(Place(item)),) if items.may_be_none else ()
        outer, body = self._outer, self._body.deeper()
        source: Any = outer.source
        target: Any = outer.target
        inner_source = source.element(self._many, item, counters, conditions)
        inner_target = target.element(self._target, element)
        inner = replace(outer, body=body, source=inner_source, target=inner_target)
        # Required inside the loop: only there is the element at hand.
        if items.may_be_none and self._assignment.whenAbsent.name == "dropMessage":
            body.require(conditions, self._many.path)
        inner.require(self._assignment.assignments)
        inner.say_unset(self._assignment.assignments)
        inner.add(self._assignment.assignments)
        steps = tuple(body.steps)
        self._body.add(
            Each(
                items.value,
                item,
                index,
                INDEX in counters.used,
                element,
                # Steps that always write the element need no empty one before.
                None if sets(steps, Place(element)) else self._target.new_element,
                steps,
                self._target.place,
                starts_empty=self._target.fresh,
                # A list of ROS is checked when it is assigned: all elements must be there by then.
                is_assigned_at_end=outer.to_ros,
                octets=self._octets(items),
            )
        )
