"""Questions to one component that wait for their answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..messages import RequestControl
from .presence import QUICK_TRIES

if TYPE_CHECKING:
    from ..base.address import JausAddress
    from ..services.host import Host
    from ..wire.message import Message
    from .presence import Presence


class Questions:
    """Questions to a target by their kind: which are open, and how often each was asked in vain."""

    def __init__(self, component: Host, target: JausAddress, presence: Presence) -> None:
        self._component = component
        self._target = target
        self._presence = presence
        self._open: set[type[Message]] = set()
        self._tries: dict[type[Message], int] = {}

    @property
    def urgent(self) -> list[type[Message]]:
        """The open questions that were not asked in vain too often."""
        return [kind for kind in self._open if self.are_worth(kind)]

    def are_worth(self, kind: type[Message]) -> bool:
        """Return whether a question was not asked in vain too often."""
        return self._tries.get(kind, 0) < QUICK_TRIES

    def ask(self, question: Message) -> None:
        """Send a question; it is open until it is answered or closed."""
        kind = type(question)
        self._open.add(kind)
        self._tries[kind] = self._tries.get(kind, 0) + 1
        self.send(question)

    def answered(self, kind: type[Message]) -> bool:
        """Take a question off the list; return whether it was the last one that is worth asking.

        One that was asked in vain too often does not keep the others from their pace.
        """
        self._tries[kind] = 0
        if kind not in self._open:
            return False
        self._open.discard(kind)
        return not self.urgent

    def go_on(self, kind: type[Message]) -> None:
        """Keep a question open that was answered, though not as wanted."""
        self._tries[kind] = 0

    def close(self) -> None:
        """Wait for no answer any more."""
        self._open.clear()

    def forget(self) -> None:
        """Begin anew: nothing is open, and nothing was asked in vain."""
        self._open.clear()
        self._tries.clear()

    def send(self, message: Message) -> None:
        """Send a message.

        The transport repeats commands until they are acknowledged, as long as anyone may be there;
        of a question that is asked again and again, the first one. The others would wait for each
        other where the way is long.
        """
        is_first = self._tries.get(type(message), 0) <= 1
        is_command = not message.NAME.startswith("Query")
        acknowledge = is_command and is_first and self.are_hopeful
        self._component.send(message, self._target, acknowledge=acknowledge)

    @property
    def are_hopeful(self) -> bool:
        """Whether anybody may be there to acknowledge."""
        is_new = self._tries.get(RequestControl, 0) <= QUICK_TRIES
        return is_new or self._presence.heard_lately(self._target)
