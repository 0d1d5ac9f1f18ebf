"""The statements of a method while they are written."""

from __future__ import annotations

import re
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH, printable, python_string
from jausml.generators.common import runtime
from jausml.generators.python.codec.values import MAXIMUM_COMPLEXITY
from jausml.generators.python.layout import Call, statement
from jausml.generators.python.names import Scope

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.generators.python.codec.jaus_fields import Condition
    from jausml.metamodel.classes import bridge

MARGIN = 8

_POLICIES = {
    "clamp": "clamp",
    "dropField": "drop_field",
    "dropMessage": "drop_message",
    "error": "error",
}
_STEP = " " * 4


def _local_names() -> Scope:
    return Scope(frozenset({"self", "source", "target"}))


def _split_call(test: str, before: str, room: int) -> str:
    """A test whose arguments get lines of their own, if it is a call."""
    function, bracket, arguments = test.partition("(")
    if not bracket or not arguments.endswith(")"):
        return f"{before}{test}"
    inner = arguments[:-1]
    if len(inner) > room - len(_STEP):
        inner = ",".join(["", *inner.split(", ")])[1:].replace(",", f",\n{_STEP}") + ","
    return f"{before}{function}(\n{_STEP}{inner}\n)"


def _split_index(text: str, room: int) -> str:
    """An assignment of an element of a list, with the index or all of it on a line of its own."""
    head, _, index = text.rpartition("[")
    if len(head) < room:
        return f"{head}[\n{_STEP}{index[:-1]}\n]"
    place, _, code = text.partition(" = ")
    return f"{place} = (\n{_STEP}{code}\n)"


@dataclass
class Body:
    """Statements of a method, and the runtime names that they use.

    Attributes:
        owner: Python path of the connection, e.g. `self.speed`.
        policy: Out-of-range policy of the connection, as a literal of the metamodel.
        lines: Lines, indented for a method.
        names: Names of the runtime, as (module, name).
        depth: How deep in loops and conditions the next statement stands.
        local_names: Names of local variables.
    """

    owner: str = ""
    policy: str = "clamp"
    lines: list[str] = field(default_factory=list)
    names: set[tuple[str, str]] = field(default_factory=set)
    depth: int = 0
    local_names: Scope = field(default_factory=_local_names)
    _required: list[str] = field(default_factory=list)
    _names: dict[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """All statements; the first line is not indented here."""
        return "\n".join(self.lines).lstrip()

    @property
    def column(self) -> int:
        """Column of the next statement."""
        return MARGIN + len(_STEP) * self.depth

    def tried(self) -> Body:
        """Returns the body of a block in this one that may be given up without a trace."""
        return replace(self.deeper(), local_names=self.local_names.copy(), _names=dict(self._names))

    def deeper(self) -> Body:
        """Returns the body of a block in this one, whose lines are added when it is complete."""
        return Body(
            self.owner,
            self.policy,
            names=self.names,
            depth=self.depth + 1,
            local_names=self.local_names,
            _required=list(self._required),
            _names=self._names,
        )

    def use(self, module: str, name: str) -> str:
        """Notes that a runtime name is used, and returns it."""
        self.names.add((module, name))
        return name

    @property
    def is_complex(self) -> bool:
        """Whether it has more branches than the style allows without a word."""
        heads = (line.lstrip().startswith(("if ", "for ")) for line in self.lines)
        return sum(heads) + 1 > MAXIMUM_COMPLEXITY

    def limit(self, assignment: bridge.FieldAssignment) -> str:
        """Returns the Python path of what keeps the value of an assignment within its target."""
        own = assignment.outOfRange.name
        return self.limit_of(self.policy if own == "asConnection" else own)

    def limit_of(self, policy: str) -> str:
        """Returns the Python path of the limit of a policy, which is a literal of the metamodel."""
        return f"{self.owner}.{_POLICIES[policy]}"

    # -- statements ------------------------------------------------------------------------------

    def add(self, text: str) -> None:
        """Adds the lines of a statement."""
        margin = " " * self.column
        self.lines += [margin + line for line in text.split("\n")]

    def store(self, code: str | Call, place: str = "", remark: str = "") -> None:
        """Adds an assignment to a place, or a call; a remark becomes a comment."""
        before = f"{place} = " if place else ""
        text = statement(code, before, self.column)
        comment = f"  # {' '.join(printable(remark).split())}" if remark else ""
        if comment and self.column + len(text.rpartition("\n")[2] + comment) > LINE_WIDTH:
            self.add(comment.strip())
        else:
            text += comment
        self.add(text)

    def local(self, name: str, code: str | Call) -> str:
        """Gives a value a local name, which is returned.

        Args:
            name: What it should be called.
            code: The value.
        """
        claimed = self.local_names.claim(name)
        self.store(code, claimed)
        return claimed

    # -- blocks ----------------------------------------------------------------------------------

    @contextmanager
    def inside(self, head: str) -> Iterator[None]:
        """Adds the head of a block, and puts what is added meanwhile into it."""
        known = len(self._required)
        self.add(head)
        self.depth += 1
        yield
        self.depth -= 1
        del self._required[known:]

    @contextmanager
    def given(self, conditions: Sequence[Condition]) -> Iterator[None]:
        """Adds the condition that values are there, and puts what is added meanwhile below it.

        A condition that the statement before has too is not said again.
        """
        wanted = [each for each in conditions if each.holds not in self._required]
        names = [index for index, each in enumerate(wanted) if each.is_name]
        if names:
            first = names[0]
            with self.given(wanted[:first]):
                self._name(wanted[first])
                with self.given(wanted[first + 1 :]):
                    yield
            return
        tests = [each.holds for each in wanted]
        if not tests:
            yield
            return
        head = self.condition(tests)
        if self._last_head() == head:
            self.depth += 1
            yield
            self.depth -= 1
            return
        with self.inside(head):
            yield

    def _name(self, name: Condition) -> None:
        """Gives a name in the present block, once."""
        margin = " " * self.column
        for line in reversed(self.lines):
            if line == f"{margin}{name.holds}":
                return
            if not line.startswith(margin):
                break
        text = name.holds
        if self.column + len(text) > LINE_WIDTH:
            text = _split_index(text, LINE_WIDTH - self.column)
        self.add(text)

    def name_of(self, place: str) -> str:
        """Returns the name of a local variable for an element of a list, always the same."""
        if place not in self._names:
            words = re.sub(r"\[([0-9]+)\]$", r"_\1", place.rpartition(".")[2])
            self._names[place] = self.local_names.claim(words)
        return self._names[place]

    def condition(self, tests: Sequence[str], word: str = "and") -> str:
        """Returns the head of a block that needs some tests to hold."""
        line = f"if {f' {word} '.join(tests)}:"
        if self.column + len(line) <= LINE_WIDTH:
            return line
        room = LINE_WIDTH - self.column
        if len(tests) == 1:
            return f"{_split_call(tests[0], 'if ', room)}:"
        lines = []
        for position, test in enumerate(tests):
            start = f"{_STEP}{word} " if position else _STEP
            text = f"{start}{test}"
            if self.column + len(text) > LINE_WIDTH:
                text = _split_call(test, start, room - len(_STEP)).replace("\n", f"\n{_STEP}")
            lines.append(text)
        return "\n".join(["if (", *lines, "):"])

    def fail(self, error: str, text: str) -> None:
        """Adds the raise of an error.

        Args:
            error: Its class.
            text: What is wrong.
        """
        self.add(statement(Call(error, (python_string(text),)), "raise ", self.column))

    def stores(self, place: str) -> bool:
        """Tells whether a statement gives a place a value whatever holds."""
        start = f"{' ' * self.column}{place} = "
        return any(line.startswith(start) for line in self.lines)

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
                    continue
                error = self.use(runtime.FACE, "AbsentFieldError")
                with self.inside(self.condition([condition.fails])):
                    self.fail(error, path)

    def _last_head(self) -> str:
        """The condition that still holds for a statement added now, one step deeper."""
        margin = " " * self.column
        inner = margin + _STEP
        for index in range(len(self.lines) - 1, -1, -1):
            if not self.lines[index].startswith((inner, f"{margin})")):
                if not self.lines[index].startswith(f"{margin}if "):
                    return ""
                head = [self.lines[index]]
                if head[0].endswith("("):
                    closing = self.lines.index(f"{margin}):", index)
                    head = self.lines[index : closing + 1]
                is_block = index + len(head) < len(self.lines)
                return "\n".join(line[len(margin) :] for line in head) if is_block else ""
        return ""
