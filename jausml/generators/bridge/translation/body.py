"""The statements of a method while they are written."""

from __future__ import annotations

import re
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml.generators.bridge.translation.values import Limit
from jausml.generators.python.names import Scope
from jausml.generators.python.statements import Assign, Do, If, Raise, Statement, call, rendered

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.generators.python.codec.jaus_fields import Condition
    from jausml.metamodel.classes import bridge

_POLICIES = {
    "clamp": "clamp",
    "dropField": "drop_field",
    "dropMessage": "drop_message",
    "error": "error",
}
# Functions and modules that the module of a bridge imports; no local hides them.
IMPORTED = frozenset({"arithmetic", "by_name", "conversions", "set_quaternion", "set_time"})
OWN_NAMES = IMPORTED | {"self", "source", "target"}


@dataclass
class Body:
    """Statements of a method.

    Attributes:
        owner: Python path of the connection, e.g. `self.speed`.
        policy: Out-of-range policy of the connection, as a literal of the metamodel.
        statements: The statements of the present block.
        local_names: Names of local variables.
    """

    owner: str = ""
    policy: str = "clamp"
    statements: list[Statement] = field(default_factory=list)
    local_names: Scope = field(default_factory=lambda: Scope(OWN_NAMES))
    _required: list[str] = field(default_factory=list)
    _names: dict[str, str] = field(default_factory=dict)

    @property
    def lines(self) -> tuple[str, ...]:
        """The lines of all statements."""
        return tuple(rendered(self.statements))

    def tried(self) -> Body:
        """Returns the body of a block in this one that may be given up without a trace."""
        return replace(self.deeper(), local_names=self.local_names.copy(), _names=dict(self._names))

    def deeper(self) -> Body:
        """Returns the body of a block in this one, whose statements are added when complete."""
        return replace(self, statements=[], _required=list(self._required))

    def limit(self, assignment: bridge.FieldAssignment) -> Limit:
        """Returns what keeps the value of an assignment within its target."""
        own = assignment.outOfRange.name
        if own != "asConnection":
            return self.limit_of(own)
        limit = self.limit_of(self.policy)
        if self.policy == "clamp":
            return replace(limit, identifiers=self.limit_of("dropMessage").path)
        return limit

    def limit_of(self, policy: str) -> Limit:
        """Returns the limit of a policy, which is a literal of the metamodel."""
        return Limit(f"{self.owner}.{_POLICIES[policy]}", drops_field=policy == "dropField")

    @property
    def whole_limit(self) -> Limit:
        """The limit of what is no field that could be dropped alone."""
        return self.limit_of("dropMessage" if self.policy == "dropField" else self.policy)

    # -- statements ------------------------------------------------------------------------------

    def add(self, *statements: Statement) -> None:
        """Adds statements."""
        self.statements += statements

    def store(self, code: str, place: str, remark: str = "") -> None:
        """Adds an assignment to a place; a remark becomes a comment."""
        self.add(Assign(place, code, remark))

    def do(self, expression: str) -> None:
        """Adds an expression for what it does."""
        self.add(Do(expression))

    def local(self, name: str, code: str) -> str:
        """Gives a value a local name, which is returned.

        Args:
            name: What it should be called.
            code: The value.
        """
        claimed = self.local_names.claim(name)
        self.store(code, claimed)
        return claimed

    def name_of(self, place: str) -> str:
        """Returns the name of a local variable for an element of a list, always the same."""
        if place not in self._names:
            words = re.sub(r"\[([0-9]+)\]$", r"_\1", place.rpartition(".")[2])
            self._names[place] = self.local_names.claim(words)
        return self._names[place]

    # -- blocks ----------------------------------------------------------------------------------

    @contextmanager
    def inside(self, test: str) -> Iterator[None]:
        """Puts what is added meanwhile under a condition.

        A condition that the statement before has too is not said again.
        """
        outer, known = self.statements, len(self._required)
        last = outer[-1] if outer else None
        again = isinstance(last, If) and last.test == test and not last.otherwise
        self.statements = list(last.body) if isinstance(last, If) and again else []
        yield
        block = If(test, tuple(self.statements))
        self.statements = outer
        if again:
            outer.pop()
        outer.append(block)
        del self._required[known:]

    @contextmanager
    def given(self, conditions: Sequence[Condition]) -> Iterator[None]:
        """Puts what is added meanwhile under the condition that values are there."""
        wanted = [each for each in conditions if each.holds not in self._required]
        names = [index for index, each in enumerate(wanted) if each.is_name]
        if names:
            first = names[0]
            with self.given(wanted[:first]):
                self._name(wanted[first])
                with self.given(wanted[first + 1 :]):
                    yield
        elif wanted:
            with self.inside(" and ".join(each.holds for each in wanted)):
                yield
        else:
            yield

    def _name(self, condition: Condition) -> None:
        """Gives a name in the present block, once."""
        assignment = Assign(condition.name, condition.place)
        if assignment not in self.statements:
            self.add(assignment)

    def require(self, conditions: Sequence[Condition], path: str) -> None:
        """Adds the refusal of messages that lack a field.

        Args:
            conditions: What holds when it is there.
            path: Path of the field.
        """
        for condition in conditions:
            if condition.holds not in self._required:
                self._required.append(condition.holds)
                if condition.is_name:
                    self._name(condition)
                else:
                    self.refuse(condition.fails, "AbsentFieldError", path)

    def refuse(self, test: str, error: str, text: str) -> None:
        """Adds the raise of an error under a condition.

        Args:
            test: The condition.
            error: Class of the error.
            text: What is wrong.
        """
        self.add(If(test, (Raise(call(error, python_string(text))),)))
