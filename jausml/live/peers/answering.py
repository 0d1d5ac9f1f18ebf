"""What a component of ours gives and takes: answers to queries, and commands of others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.live.peers.entry_messages import EntryMessage, message_class
from jausml.live.peers.query_client import QueryClient
from jausml.runtime.services.definitions import Guard

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.messages import MessageEntry
    from jausml.runtime.base.address import JausAddress

Reply = tuple[str, dict[str, Any]]
"""A message by its name, and its fields."""


class AnsweringClient(QueryClient):
    """Answers others, beside asking them."""

    def provide(
        self,
        query: MessageEntry,
        report: MessageEntry,
        give: Callable[[], dict[str, Any] | None],
    ) -> None:
        """Answers a query, and events on it.

        Args:
            give: Returns the fields of the present report; None when there is none now.
        """
        made = message_class(report)

        def provided(_query: EntryMessage, _sender: JausAddress) -> EntryMessage | None:
            fields = give()
            if fields is None:
                return None
            if not isinstance(fields, dict):
                raise TypeError(f"the answer to {query.name} is {fields!r}, not a dict of fields")
            return made(report.completed(fields))

        self._component.provide(message_class(query), made, provided)

    def report_changed(self, report: MessageEntry) -> None:
        """Sends a report to who wants it at every change."""
        self._component.report_changed(message_class(report))

    def obey(
        self,
        entry: MessageEntry,
        take: Callable[[MessageEntry, dict[str, Any], JausAddress], Reply | None],
    ) -> None:
        """Has a function take a message; commands come from the controller in Ready alone.

        Args:
            take: Takes the message, its fields and its sender, on another thread; returns what is
                sent back, if anything.

        Raises:
            ValueError: Something takes it already.
        """

        def taken(message: EntryMessage, sender: JausAddress) -> None:
            reply = take(entry, message.fields, sender)
            if reply is not None:
                name, fields = reply
                self._component.send(self.message(self.find(self.own, name), fields), sender)

        self._component.handle(
            message_class(entry), taken, when=Guard.READY if entry.is_command else Guard.ANY
        )
