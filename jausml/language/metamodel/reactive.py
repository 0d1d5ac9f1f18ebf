"""Answers that note what they read, and are worked out again only when that has changed.

A change marks: those who read what changed have to be worked out again, those who asked them
perhaps. Who is asked makes sure, in the order in which it asked before. An answer that comes out as
it was stops the wave: who asked for it stays as it is.

An engine belongs to one thread at a time.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Iterator


class _State(IntEnum):
    CURRENT = 0
    UNSURE = 1
    """An answer that it asked for may change."""
    OUTDATED = 2
    CHECKED = 3
    """It is being found out whether an answer that it asked for has changed."""
    RUNNING = 4


# Members of an enumeration take longer to look up than all else of an answer that is known.
_CURRENT, _UNSURE, _OUTDATED, _CHECKED, _RUNNING = _State

Call = tuple[Any, ...]
"""A function and what it is called with, all of it hashable."""


class SelfAskingError(Exception):
    """An answer depends on itself."""

    def __init__(self, call: Call) -> None:
        name = getattr(call[0], "__qualname__", call[0])
        super().__init__(f"{name} asks for its own answer")


class Node:
    """A call: its answer, what it has read, whom it has asked (in order), and who asks for it."""

    __slots__ = ("asked", "call", "is_root", "read", "state", "users", "value")

    def __init__(self, call: Call) -> None:
        self.call = call
        self.value: Any = None
        self.state: _State = _OUTDATED
        self.is_root = False
        self.read: list[set[Node]] = []
        self.asked: dict[Node, None] = {}
        self.users: set[Node] = set()


class _Raised:
    """The answer of a call that failed, for all who ask."""

    __slots__ = ("error",)

    def __init__(self, error: Exception) -> None:
        self.error = error


class Answers:
    """The answers to calls, which hold to its end: nothing that they read changes meanwhile."""

    def __init__(self) -> None:
        self._known: dict[Call, Any] = {}

    def ask(self, call: Call) -> Any:
        """Returns the answer of a call, which raises what the call raises.

        `SelfAskingError`: it asks for its own answer.
        """
        value = self._known.get(call)
        if value is None and call not in self._known:
            self._known[call] = _RUNNING
            try:
                value = call[0](*call[1:])
            except Exception as error:
                value = _Raised(error)
            except BaseException:
                del self._known[call]
                raise
            self._known[call] = value
        if value is _RUNNING:
            raise SelfAskingError(call)
        if value.__class__ is _Raised:
            raise value.error.with_traceback(None)
        return value


class Engine:
    """The answers to calls, and what each has read and asked.

    Attributes:
        now: The node that runs.
        runs: How many nodes have run.
    """

    def __init__(self) -> None:
        self.now: Node | None = None
        self.runs = 0
        self._nodes: dict[Call, Node] = {}
        self._woken: dict[Node, None] = {}
        self._left: set[Node] = set()

    def __len__(self) -> int:
        """How many answers are remembered."""
        return len(self._nodes)

    def ask(self, call: Call) -> Any:
        """Returns the answer of a call, which raises what the call raises.

        `SelfAskingError`: it asks for its own answer.
        """
        node = self._nodes.get(call)
        if node is None:
            node = self._nodes[call] = Node(call)
        now = self.now
        if now is not None and node not in now.asked:
            now.asked[node] = None
            node.users.add(now)
        if node.state is _OUTDATED:
            self._run(node)
        elif node.state is not _CURRENT:
            self._refresh(node)
        value = node.value
        if value.__class__ is _Raised:
            raise value.error.with_traceback(None)
        return value

    def keep(self, call: Call) -> Node:
        """Has a call stay, of which `woken` tells when its answer may be another one."""
        node = self._nodes[call] = Node(call)
        node.is_root = True
        self._woken[node] = None
        return node

    def drop(self, node: Node) -> None:
        """Has a call that was to stay not stay."""
        self._woken.pop(node, None)
        self._cut(node)
        self._nodes.pop(node.call, None)

    def woken(self) -> Iterator[Node]:
        """Yields the nodes that stay and whose answers may have changed since they were asked."""
        while self._woken:
            node = next(iter(self._woken))
            yield node
            self._woken.pop(node, None)

    def touch(self, readers: Iterable[Node]) -> None:
        """Says that something has changed which nodes have read."""
        users: list[Node] = []
        for node in readers:
            node.state = _OUTDATED
            users += node.users
            if node.is_root:
                self._woken[node] = None
        while users:
            node = users.pop()
            if node.state is _CURRENT:
                node.state = _UNSURE
                users += node.users
                if node.is_root:
                    self._woken[node] = None

    def sweep(self) -> None:
        """Forgets answers that nobody asks for any more."""
        while self._left:
            node = self._left.pop()
            if not node.users and not node.is_root:
                self._cut(node)
                self._nodes.pop(node.call, None)

    def _refresh(self, node: Node) -> None:
        """Makes an answer current; not by recursion, for who asks whom may be a long chain."""
        pending = [(node, iter(node.asked))]
        try:
            while pending:
                top, rest = pending[-1]
                if top.state is _RUNNING:
                    raise SelfAskingError(top.call)
                if top.state is _OUTDATED:
                    self._run(top)
                    pending.pop()
                    continue
                top.state = _CHECKED
                other = next((each for each in rest if each.state is not _CURRENT), None)
                if other is None:
                    top.state = _CURRENT
                    pending.pop()
                elif other.state in (_CHECKED, _RUNNING):
                    top.state = _OUTDATED  # it fails if it still asks for its own answer
                else:
                    pending.append((other, iter(other.asked)))
        except BaseException:
            for each, _ in pending:
                if each.state is not _RUNNING:
                    each.state = _OUTDATED
            raise

    def _run(self, node: Node) -> None:
        self._cut(node)
        before, self.now = self.now, node
        self.runs += 1
        node.state = _RUNNING
        value: Any
        try:
            value = node.call[0](*node.call[1:])
        except Exception as error:
            value = _Raised(error)
        except BaseException:
            node.state = _OUTDATED
            raise
        finally:
            self.now = before
        node.state = _CURRENT
        if type(value) is not type(node.value) or value != node.value:
            node.value = value
            for user in node.users:
                if user.state is not _RUNNING:
                    user.state = _OUTDATED

    def _cut(self, node: Node) -> None:
        for readers in node.read:
            readers.discard(node)
        for other in node.asked:
            other.users.discard(node)
            if not other.users:
                self._left.add(other)
        node.read, node.asked = [], {}


class Watch(dict["Hashable", set[Node]]):
    """Who has read what of one element, or of something else that changes, by name."""

    __slots__ = ("engine",)

    def __init__(self, engine: Engine) -> None:
        super().__init__()
        self.engine = engine

    def note(self, name: Hashable) -> None:
        """Notes that the node that runs reads something."""
        now = self.engine.now
        if now is not None:
            readers = self.get(name)
            if readers is None:
                readers = self[name] = set()
            if now not in readers:
                readers.add(now)
                now.read.append(readers)

    def touch(self, name: Hashable) -> None:
        """Says that something has changed."""
        readers = self.get(name)
        if readers:
            self.engine.touch(tuple(readers))
