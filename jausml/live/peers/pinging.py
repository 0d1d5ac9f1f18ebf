"""Round trips to a component, by a question that it answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.live.peers.spread import spread_of
from jausml.runtime.messages import (
    QueryControl,
    QueryHeartbeatPulse,
    QueryIdentification,
    QueryStatus,
    ReportControl,
    ReportHeartbeatPulse,
    ReportIdentification,
    ReportStatus,
)
from jausml.runtime.services.definitions import Scope

if TYPE_CHECKING:
    from jausml.live.peers.asking import Asker
    from jausml.live.peers.spread import Spread
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.wire.message import Message

QUESTIONS: dict[str, tuple[Message, type[Message]]] = {
    "heartbeat": (QueryHeartbeatPulse(), ReportHeartbeatPulse),
    "identification": (QueryIdentification(query_type=Scope.COMPONENT), ReportIdentification),
    "status": (QueryStatus(), ReportStatus),
    "control": (QueryControl(), ReportControl),
}
"""Questions of the core services by name, and their answers; the shortest first.

No service is in every component: Liveness has the heartbeat, Discovery the identification,
Management the status, Access Control the control.
"""


@dataclass
class Pings:
    """What became of the questions to a component.

    Attributes:
        round_trips: Seconds until each answer, in order; None for one that did not come in time.
    """

    round_trips: list[float | None] = field(default_factory=list)

    @property
    def sent(self) -> int:
        """How often was asked."""
        return len(self.round_trips)

    @property
    def answered(self) -> int:
        """How many answers came."""
        return sum(each is not None for each in self.round_trips)

    @property
    def loss(self) -> float:
        """Share of the questions without an answer, 0 to 1."""
        return 1 - self.answered / self.sent if self.sent else 0.0

    @property
    def spread(self) -> Spread | None:
        """How the round trips were spread; None without an answer."""
        return spread_of(each for each in self.round_trips if each is not None)


def answered_question(asker: Asker, target: JausAddress) -> str | None:
    """Returns the name of the first of QUESTIONS that a component answers; None without any."""
    index = asker.first_answered(target, list(QUESTIONS.values()))
    return None if index is None else list(QUESTIONS)[index]
