"""Kinds of steps that the checks of several services declare; see `step`."""

from __future__ import annotations

from jausml.live.peers.conformance.check import step
from jausml.live.peers.conformance.session import Session
from jausml.runtime.messages import RejectControl

A, B = 0, 1
"""Our clients."""

needs = step(Session.authority)
take = step(Session.take)
ready = step(Session.make_ready)
send = step(Session.send)


@step
def since_1_1(session: Session, service: str, reason: str) -> None:
    """Skips the check where a core service is older than AS5710A."""
    session.skip_unless(not session.is_v1_0(service), reason)


@step
def rejected(session: Session, client: int, expected: int = 0) -> None:
    """A client is told that it has no control, with a code."""
    code = session.client(client).expect(RejectControl, session.latest).response_code
    session.require(
        code == expected,
        f"{session.latest} is answered with RejectControl {code} instead of {expected}",
    )
