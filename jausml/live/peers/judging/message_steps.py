"""Steps with messages of the catalogue, by their names, and what their fields must be."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING, Any

from jausml.live.messages.codec import PRESENCE
from jausml.live.peers.conformance.check import Step, step
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.conformance.steps import ask
from jausml.live.peers.entry_messages import EntryMessage, message_class

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session
    from jausml.live.peers.conformance.steps import Judgement

PRESENCE_VECTOR = "PresenceVector"
_DAY = 86400.0


@dataclass(frozen=True, slots=True)
class Topic:
    """What a service is asked for: QueryNAME and ReportNAME.

    Attributes:
        presence: Presence vector of the query; None when it has none.
    """

    service: str
    name: str
    presence: int | None = None

    def query(self, session: Session) -> EntryMessage:
        """Returns the query."""
        fields: dict[str, Any] = {}
        if self.presence is not None:
            fields = {PRESENCE_VECTOR: self.presence}
        return made(session, self.service, f"Query{self.name}", **fields)

    def report(self, session: Session) -> type[EntryMessage]:
        """Returns the class of the report."""
        return message_class(session.catalogue.message(f"Report{self.name}", self.service))


def made(session: Session, service: str, name: str, **fields: Any) -> EntryMessage:
    """Returns a message of a service; the record of its body need not be named."""
    entry = session.catalogue.message(name, service)
    return message_class(entry)(entry.completed(fields) if fields else {})


def told(message: EntryMessage) -> dict[str, Any]:
    """Returns the fields of a message of one record that are present."""
    (record,) = message.fields.values()
    return {name: value for name, value in record.items() if name != PRESENCE}


def asks(client: int, topic: Topic, *judgements: Judgement[EntryMessage]) -> Step:
    """A client asks for something, and the report is as it should be."""

    def run(session: Session) -> None:
        ask(client, topic.query, topic.report(session), *judgements)(session)

    return run


def holds(*names: str) -> Judgement[EntryMessage]:
    """Fails unless a report has these fields."""

    def judge(_: Session, found: EntryMessage, what: str) -> None:
        lacking = [each for each in names if each not in told(found)]
        if lacking:
            raise CheckFailed(f"{what} lacks {', '.join(lacking)}")

    return judge


@step
def goes_on(session: Session, client: int, topic: Topic, seconds: float, fastest: float) -> None:
    """Time stamps of two reports differ by about the time between them, and no position jumps.

    Args:
        fastest: Metres per second that are not believed.
    """
    before, then = _report(session, client, topic), session.probe.now()
    session.probe.wait(lambda: False, seconds)
    after = _report(session, client, topic)
    elapsed = session.probe.now() - then
    passed = (_seconds(after) - _seconds(before)) % _DAY
    if not 0 < passed <= 2 * elapsed:
        raise CheckFailed(
            f"the time stamps of two reports {elapsed:.1f} s apart differ by {passed:.3f} s"
        )
    if {"X", "Y"} <= after.keys() & before.keys():
        speed = hypot(after["X"] - before["X"], after["Y"] - before["Y"]) / passed
        session.require(speed < fastest, f"the position changes by {speed:.1f} m/s")


def _report(session: Session, client: int, topic: Topic) -> dict[str, Any]:
    found = session.client(client).ask(topic.query(session), topic.report(session))
    holds("TimeStamp")(session, found, found.NAME)
    return told(found)


def _seconds(report: dict[str, Any]) -> float:
    stamp = report["TimeStamp"]
    hours = 60 * (60 * stamp["Hour"] + stamp["Minutes"]) + stamp["Seconds"]
    return float(hours + stamp["Milliseconds"] / 1000)
