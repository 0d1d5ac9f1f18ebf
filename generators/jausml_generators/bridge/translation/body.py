"""Body of a translation, to which steps are added, under the conditions that they need."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace

from jausml_generators.bridge.translation.expressions import Expression, Read
from jausml_generators.bridge.translation.places import Condition, Local, Named, Place, Requirement
from jausml_generators.bridge.translation.policies import Policies
from jausml_generators.bridge.translation.steps import Choose, Let, Require, Step


@dataclass
class Body:
    """The steps of a translation so far.

    Attributes:
        policies: The policies of the connection.
    """

    policies: Policies
    steps: list[Step] = field(default_factory=list)
    _required: list[Requirement] = field(default_factory=list)
    _locals: dict[Place, Local] = field(default_factory=dict)

    def deeper(self) -> Body:
        """Returns the body of a block in this one, whose steps are added when complete."""
        # What is required inside holds there only, so the list is copied.
        return replace(self, steps=[], _required=list(self._required))

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
    def under(self, requirements: Sequence[Requirement]) -> Iterator[None]:
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

    def require(self, requirements: Sequence[Requirement], path: str) -> None:
        """Adds the refusal of messages that lack a field."""
        for requirement in requirements:
            if requirement in self._required:
                continue
            self._required.append(requirement)
            if isinstance(requirement, Named):
                self._name(requirement)
            else:
                self.add(Require(requirement, "AbsentFieldError", (path,)))
