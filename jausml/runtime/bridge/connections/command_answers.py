"""The last command that a connection obeyed, as the answer to the query for it (AS5684)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...transports.delivery import MESSAGE_CODE_SIZE

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ...component.component import JausComponent
    from ...wire.message import Message
    from .transcoding import Transcode


@dataclass(frozen=True)
class CommandAnswer:
    """How a command is told.

    Attributes:
        same: Attributes of the query that say which command is meant.
        has_empty: Whether a report without any field can say that nothing is commanded.
    """

    query: type[Message]
    report: type[Message]
    same: tuple[str, ...] = ()
    has_empty: bool = False


class CommandMemory:
    """Remembers the last command that was passed on, and tells it while it stands."""

    def __init__(self, answer: CommandAnswer, stands: Callable[[], bool]) -> None:
        self._answer = answer
        self._stands = stands
        self._payload: bytes | None = None

    def provide(self, component: JausComponent) -> None:
        """Answers the query, and periodic events on it; nobody watches for changes."""
        self._payload = None
        answer = self._answer
        component.provide(answer.query, answer.report, self._report, every_change=False)

    def remembering(self, transcode: Transcode) -> Transcode:
        """Returns a translation of commands, of which those that it passes on are remembered."""

        def remember(data: bytes, **joined: object) -> bytes | None:
            target = transcode(data, **joined)
            if target is not None:
                self._payload = data
            return target

        return remember

    def _report(self, query: Message, _sender: JausAddress) -> Message | bytes | None:
        answer = self._answer
        if self._payload is None or not self._stands():
            return answer.report() if answer.has_empty else None
        code = answer.report.CODE.to_bytes(MESSAGE_CODE_SIZE, "little")
        payload = code + self._payload[MESSAGE_CODE_SIZE:]
        if answer.same:
            report = answer.report.decode(payload)
            if any(getattr(query, each) != getattr(report, each) for each in answer.same):
                return None
        return payload
