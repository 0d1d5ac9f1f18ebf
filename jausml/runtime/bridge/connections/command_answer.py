"""Answers to queries for the last command that a connection has passed on."""

from __future__ import annotations

from ...base.address import JausAddress
from ...services.host import Host
from ...transports.delivery import MESSAGE_CODE_SIZE
from ...wire.message import Message
from .translations import Transcode


class CommandAnswer:
    """Keeps the last command that was passed on, and reports it until a stop is sent."""

    def __init__(
        self,
        query: type[Message],
        report: type[Message],
        *,
        same: tuple[str, ...] = (),
        has_empty: bool = False,
    ) -> None:
        """Keeps no command yet.

        Args:
            query: The query for the command.
            report: The report that answers it, with the same fields as the command.
            same: Fields of query and report that must be equal; otherwise there is no answer.
            has_empty: Whether a report without optional fields says that no command stands.
        """
        self._query, self._report, self._same, self._has_empty = query, report, same, has_empty
        self._payload: bytes | None = None

    def provide(self, component: Host) -> None:
        """Answers the query, and periodic events on it; events on every change are refused."""
        self._payload = None
        component.provide(self._query, self._report, self._answer, every_change=False)

    def forget(self) -> None:
        """Reports no command before the next one, since a stop was sent."""
        self._payload = None

    def remembering(self, transcode: Transcode) -> Transcode:
        """Returns a translation that also keeps each command that it passes on."""

        def remember(data: bytes, **joined: object) -> bytes | None:
            target = transcode(data, **joined)
            if target is not None:
                self._payload = data
            return target

        return remember

    def _answer(self, query: Message, _sender: JausAddress) -> Message | bytes | None:
        if self._payload is None:
            return self._report() if self._has_empty else None
        # A report has the fields of the command that it tells; only the code is another one.
        code = self._report.CODE.to_bytes(MESSAGE_CODE_SIZE, "little")
        payload = code + self._payload[MESSAGE_CODE_SIZE:]
        if self._same:
            report = self._report.decode(payload)
            if any(getattr(query, field) != getattr(report, field) for field in self._same):
                return None
        return payload
