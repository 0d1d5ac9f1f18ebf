"""Lists of one side as lists of the other, element by element."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from jausml.generation.literals import python_string
from jausml.generators.bridge.translation.sources import COUNT, INDEX, Counters
from jausml.generators.bridge.translation.values import NO_LIMIT, AssignmentError
from jausml.generators.python.codec.jaus_fields import joined, there
from jausml.generators.python.statements import Assign, Do, For, assigns, call
from jausml.semantics.conversions import conversion_of
from jausml.semantics.conversions.authored import User

if TYPE_CHECKING:
    from jausml.generators.bridge.translation.sources import Many
    from jausml.generators.bridge.translation.targets import ManyTarget
    from jausml.generators.bridge.translation.translation import Translation
from jausml.generators.python.codec.jaus_fields import Condition
from jausml.metamodel.classes import bridge


def add_list(translation: Translation, assignment: bridge.ListAssignment) -> None:
    """Adds the statements that fill a list of the target.

    Args:
        translation: The translation that the assignment belongs to.
        assignment: The `bridge.ListAssignment`.

    Raises:
        AssignmentError: A value does not fit its target.
        PathError: A path leads nowhere.
    """
    _ListStatements(translation, assignment).add()


@dataclass(frozen=True)
class _Items:
    """What a loop goes over.

    Attributes:
        code: The elements, as Python text.
        name: Python text that is as long as the elements.
        counts: Fewest and most elements.
        may_be_none: Whether an element may be None, where its name was missing.
    """

    code: str
    name: str
    counts: tuple[float, float]
    may_be_none: bool = False


class _ListStatements:
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
        found: ManyTarget = target.many(path, *names)
        return found

    def add(self) -> None:
        """Adds all statements."""
        self._outer.target.prepare(self._body, self._assignment.target.strip())
        with self._body.given(self._all_conditions()):
            items = self._converted()
            items = self._named(items)
            items = self._counted(items)
            self._fill(items)

    def _all_conditions(self) -> tuple[Condition, ...]:
        others = [self._outer.source.value(path, NO_LIMIT) for path in self._paths[1:]]
        conditions = [*self._many.conditions, *(c for each in others for c in each.conditions)]
        return joined(conditions)

    # -- what is gone through --------------------------------------------------------------------

    def _converted(self) -> _Items:
        """The elements after the conversions of the list as a whole."""
        code = self._many.code
        inputs: tuple[str, ...] = (
            code,
            *(self._outer.source.value(path, NO_LIMIT).code for path in self._paths[1:]),
        )
        for conversion in self._assignment.conversions:
            known = conversion_of(conversion)
            if isinstance(known, User):
                types = ("Any",) * len(inputs)
                method = conversion.method or ""
                code = call(self._outer.surroundings.user_method(method, types, "Any"), *inputs)
            elif not known.changes_nothing:
                code = call(f"conversions.{known.name}", *inputs)
            inputs = (code,)
        if len(inputs) > 1:
            raise AssignmentError(f"{self._assignment.source}: several sources need a conversion")
        if code != self._many.code:
            code = self._body.local("items", code)
        return _Items(code, code, self._many.counts)

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
        key_list = self._outer.source.many(keys).code
        code = call("by_name", constant, key_list, items.name)
        counts = (len(names), len(names))
        return _Items(self._body.local("items", code), constant, counts, may_be_none=True)

    def _named_in_ros(
        self, items: _Items, keys: str, constant: str, count: int, *, must: bool
    ) -> _Items:
        if must:
            test = f"len({items.name}) < len({constant})"
            self._body.refuse(test, "AbsentFieldError", self._many.path)
        local = self._body.local("items", f"{items.name}[: len({constant})]")
        target: Any = self._outer.target
        place = target.field(keys).place
        self._body.store(f"list({constant}[: len({local})])", place)
        return _Items(local, local, (count if must else 0, count))

    def _counted(self, items: _Items) -> _Items:
        """The elements, when they are as many as the target carries."""
        wanted = self._target.counts
        if wanted is None:
            return items
        if wanted[0] <= items.counts[0] and items.counts[1] <= wanted[1]:
            return items
        sized = f"{self._body.whole_limit.path}.sized"
        numbers = (str(wanted[0]), str(wanted[1]))
        code = call(sized, python_string(self._target.path), items.code, *numbers)
        return replace(items, code=code)

    # -- what is made of it ----------------------------------------------------------------------

    def _fill(self, items: _Items) -> None:
        item = self._body.local_names.claim("item")
        index = self._body.local_names.claim("index")
        counters = Counters({INDEX: index, COUNT: f"len({items.name})"})
        conditions: tuple[Condition, ...] = ()
        if items.may_be_none:
            conditions = (there(item),)
        source: Any = self._outer.source
        inner_source = source.element(self._many, item, counters, conditions)
        if self._single(items):
            target: Any = self._outer.target
            inner = replace(
                self._outer, source=inner_source, target=target.element(self._target, "element")
            )
            if self._comprehend(inner, items, item, counters):
                return
        self._loop(items, item, inner_source, counters)

    def _single(self, items: _Items) -> bool:
        """Whether the element is one value, that of the only assignment."""
        (first, *others) = self._assignment.assignments
        return bool(
            not others
            and isinstance(first, (bridge.FieldAssignment, bridge.MessageAssignment))
            and first.target.strip() == "."
            and not items.may_be_none
        )

    def _comprehend(self, inner: Translation, items: _Items, item: str, counters: Counters) -> bool:
        """Adds the list as a comprehension; tells whether its elements are that simple."""
        (assignment,) = self._assignment.assignments
        trial = self._body.tried()
        trial_translation = replace(inner, body=trial)
        if not isinstance(assignment, bridge.FieldAssignment):
            return False
        values = trial_translation.values_of(assignment)
        if any(value.conditions for value in values):
            return False
        (result,) = trial_translation.results_of(assignment, values)
        kind = inner.target.kind(".")
        is_simple = not trial.statements and kind not in {"quaternion", "time"}
        if not is_simple or result.limit.drops_field:
            return False
        field: Any = inner.target
        if getattr(field.field("."), "index", None) is not None:
            return False
        element = inner.target.fitted(".", result).code
        variable = f"{counters.codes[INDEX]}, {item}" if INDEX in counters.used else item
        code = self._iterated(items, counters)
        made = f"[{element} for {variable} in {code}]"
        self._body.store(call("list", code) if element == item else made, self._target.place)
        return True

    @staticmethod
    def _iterated(items: _Items, counters: Counters) -> str:
        """What is gone through, with the indices when they are asked for."""
        return call("enumerate", items.code) if INDEX in counters.used else items.code

    def _loop(self, items: _Items, item: str, source: Any, counters: Counters) -> None:
        element = self._body.local_names.claim("element")
        inner_body = self._body.deeper()
        target: Any = self._outer.target
        inner = replace(
            self._outer,
            body=inner_body,
            source=source,
            target=target.element(self._target, element),
        )
        if items.may_be_none and self._assignment.whenAbsent.name == "dropMessage":
            inner_body.require(source.conditions, self._many.path)
        inner.require(self._assignment.assignments)
        inner.add(self._assignment.assignments)
        made = inner_body.statements
        new = self._target.new_element
        if new is not None and not assigns(made, element):
            made = [Assign(element, new), *made]
        place = self._target.place
        if self._target.fresh and self._outer.to_ros:
            place = self._body.local("elements", "[]")
        elif self._target.fresh:
            self._body.store("[]", place)
        variable = f"{counters.codes[INDEX]}, {item}" if INDEX in counters.used else item
        append = Do(call(f"{place}.append", element))
        self._body.add(For(variable, self._iterated(items, counters), (*made, append)))
        if place != self._target.place:
            self._body.store(place, self._target.place)
