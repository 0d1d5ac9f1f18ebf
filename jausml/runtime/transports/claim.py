"""Claim: what a component says of where it is before it has proved it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..base.address import JausAddress


class Claim:
    """What a component without proof has sent and got, at the one endpoint that it claims.

    Attributes:
        number: What it is to acknowledge; None while it has not been asked.
    """

    __slots__ = (
        *("asked", "asker", "held", "host", "number", "questions", "received", "sent", "wrong"),
    )

    def __init__(self, host: str) -> None:
        self.host = host
        self.received = self.sent = self.wrong = self.questions = 0
        self.number: int | None = None
        self.asked = float("-inf")
        self.asker: JausAddress | None = None
        self.held: list[bytes] = []
