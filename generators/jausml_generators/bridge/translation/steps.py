"""Typed steps of translations, a closed set that printers print, and how they are made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge
from jausml_generators.bridge.translation.expressions import Expression, Read
from jausml_generators.bridge.translation.places import Condition, Local, Named, Place, Way
from jausml_generators.bridge.translation.values import Policy
from jausml_generators.python.names import snake_case


@dataclass(frozen=True)
class Let:
    """Gives a variable a value, or several variables the results of a conversion."""

    locals: tuple[Local, ...]
    value: Expression


@dataclass(frozen=True)
class Write:
    """Gives a place a value."""

    place: Place
    value: Expression
    remark: str = ""


@dataclass(frozen=True)
class Keep:
    """Keeps a value for later messages in an attribute of the bridge."""

    name: str
    value: Expression


@dataclass(frozen=True)
class Append:
    """Adds an element to a list."""

    place: Place
    value: Expression


@dataclass(frozen=True)
class Require:
    """Refuses the message unless a condition holds.

    Attributes:
        texts: What the error is given.
    """

    condition: Condition
    error: str
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Choose:
    """Steps that are executed only where conditions hold.

    Attributes:
        conditions: Alternatives, one of which suffices; all conditions within it must hold.
    """

    conditions: tuple[tuple[Condition, ...], ...]
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class WhereKept:
    """Steps that are executed only if an attribute of the bridge has a kept value."""

    name: str
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Octets:
    """Elements of a list that are single octets on both sides.

    Attributes:
        record: Class of the records of JAUS that are made; empty where numbers of ROS are.
    """

    record: str


@dataclass(frozen=True)
class Each:
    """The elements of a list, made from those of another.

    Attributes:
        items: The list that is read; `item` is its present element, `index` the number of it.
        needs_index: Whether a step uses `index`.
        element: The variable for the element that is made.
        new: An element without values; None where the steps make it.
        steps: What is executed for each element.
        place: The list that is made.
        starts_empty: Whether the list must be made empty before elements are added: a new message
            has none, or one with elements.
        is_assigned_at_end: Whether the list must be complete before it is put in its place.
        octets: How octets are copied where the elements of both lists are octets; None for others.
    """

    items: Expression
    item: Local
    index: Local
    needs_index: bool
    element: Local
    new: Expression | None
    steps: tuple[Step, ...]
    place: Place
    starts_empty: bool = False
    is_assigned_at_end: bool = False
    octets: Octets | None = None


Step: TypeAlias = Let | Write | Keep | Append | Require | Choose | WhereKept | Each


def gives(steps: tuple[Step, ...], place: Place) -> bool:
    """Tells whether steps set a place under all conditions."""
    return any(isinstance(step, Write) and step.place == place for step in steps)


@dataclass
class Body:
    """Steps of a translation.

    Attributes:
        owner: Attribute of the bridge that is the connection, e.g. `speed`.
        policy: Out-of-range policy of the connection, as a literal of the metamodel.
    """

    owner: str = ""
    policy: str = "clamp"
    steps: list[Step] = field(default_factory=list)
    _required: list[Way] = field(default_factory=list)
    _locals: dict[Place, Local] = field(default_factory=dict)

    def deeper(self) -> Body:
        """Returns the body of a block in this one, whose steps are added when complete."""
        # What is required inside holds there only, so the list is copied.
        return replace(self, steps=[], _required=list(self._required))

    def policy_of(self, assignment: bridge.FieldAssignment, *, of_a_place: bool) -> Policy:
        """Returns the policy for a value of an assignment that does not fit its target.

        Args:
            of_a_place: Whether it is a coordinate: the nearest one is another place.
        """
        own = assignment.outOfRange.name
        if own != "asConnection":
            return self.named_policy(own)
        if self.policy != "clamp":
            return self.named_policy(self.policy)
        # The nearest latitude is a wrong place, not a rough one: better no message.
        if of_a_place:
            return self.named_policy("dropMessage")
        # Cut off, a number of an entity would name another one.
        return replace(self.named_policy(self.policy), identifiers="drop_message")

    def named_policy(self, name: str) -> Policy:
        """Returns a policy by its literal of the metamodel."""
        return Policy(self.owner, snake_case(name))

    @property
    def whole_policy(self) -> Policy:
        """The policy of what is no field that could be dropped alone."""
        # A whole list or text cannot be left out of what needs it.
        return self.named_policy("dropMessage" if self.policy == "dropField" else self.policy)

    # -- steps -----------------------------------------------------------------------------------

    def add(self, *steps: Step) -> None:
        """Adds steps."""
        self.steps += steps

    def local(self, hint: str, value: Expression) -> Local:
        """Gives a value a variable, which is returned."""
        local = Local(hint)
        self.add(Let((local,), value))
        return local

    def local_of(self, place: Place) -> Local:
        """Returns the variable for an element of a list, always the same."""
        if place not in self._locals:
            self._locals[place] = Local(place.last)
        return self._locals[place]

    # -- blocks ----------------------------------------------------------------------------------

    @contextmanager
    def where(self, *alternatives: tuple[Condition, ...]) -> Iterator[None]:
        """Puts the steps that are added meanwhile under conditions.

        Steps under the conditions of the block before become a part of that block.

        Args:
            alternatives: One of them suffices; all conditions within it must hold.
        """
        outer, known = self.steps, len(self._required)
        last = outer[-1] if outer else None
        # One block for several assignments under one condition, as a person would write it.
        again = isinstance(last, Choose) and last.conditions == alternatives
        self.steps = list(last.steps) if isinstance(last, Choose) and again else []
        yield
        block = Choose(alternatives, tuple(self.steps))
        self.steps = outer
        if again:
            outer.pop()
        outer.append(block)
        # What the block required does not hold behind it.
        del self._required[known:]

    @contextmanager
    def under(self, requirements: Sequence[Way]) -> Iterator[None]:
        """Puts the steps that are added meanwhile under the condition that values are there."""
        pending: list[Condition] = []
        with ExitStack() as blocks:
            for requirement in requirements:
                if requirement in self._required:
                    continue
                if not isinstance(requirement, Named):
                    pending.append(requirement)
                    continue
                # Conditions before the variable stand around it, those behind it may use it.
                if pending:
                    blocks.enter_context(self.where(tuple(pending)))
                    pending = []
                self._name(requirement)
            if pending:
                blocks.enter_context(self.where(tuple(pending)))
            yield

    def _name(self, named: Named) -> None:
        """Assigns a found value to a variable in the present block, once."""
        step = Let((named.local,), Read(named.place))
        if step not in self.steps:
            self.add(step)

    def require(self, requirements: Sequence[Way], path: str) -> None:
        """Adds the refusal of messages that lack a field."""
        for requirement in requirements:
            if requirement in self._required:
                continue
            self._required.append(requirement)
            if isinstance(requirement, Named):
                self._name(requirement)
            else:
                self.add(Require(requirement, "AbsentFieldError", (path,)))


def conditions(requirements: Sequence[Way]) -> tuple[Condition, ...]:
    """Returns the conditions alone."""
    return tuple(condition for condition in requirements if not isinstance(condition, Named))
