"""The account of every peer in `/diagnostics`: what it sent, and what became of that."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from ...component.accounts import accounts_of
from .diagnostics import ConnectionStatus

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ...component.accounts import Accountable
    from ...transports.delivery import PeerTraffic

LATELY = 10.0
"""Seconds over which the share of lost packets is told."""

MUCH = 0.05
"""Share of lost packets from which on a status warns."""

FEWEST_LOST = 3
"""Lost packets below which no status warns."""


class Accounting:
    """Makes the statuses of peers. All of it runs on the loop.

    It reads what the transport and the component count anyway, when a status is wanted. It warns of
    a peer of which more than 5 % were lost lately, if that is exact: of one that may number for all
    whom it talks to, what it sent to others looks lost.
    """

    def __init__(self, component: Accountable) -> None:
        self._component = component
        self._told: dict[JausAddress, deque[tuple[float, int, int]]] = {}

    def statuses(self, now: float) -> list[ConnectionStatus]:
        """Returns a status for each peer that something came from, or was sent to."""
        own = str(self._component.address)
        accounts = accounts_of(self._component)
        peers = [each.traffic.peer for each in accounts]
        self._told = {each: self._told.get(each, deque()) for each in peers}
        return [
            ConnectionStatus(
                f"account of {each.traffic.peer}",
                *self._lately(each.traffic, now),
                own,
                tuple(each.told()),
            )
            for each in accounts
        ]

    def _lately(self, traffic: PeerTraffic, now: float) -> tuple[str, str]:
        """Returns a level, and which share of what a peer sent lately was lost."""
        told = self._told[traffic.peer]
        while len(told) > 1 and told[1][0] <= now - LATELY:
            told.popleft()
        came, lost = told[0][1:] if told else (0, 0)
        told.append((now, traffic.came, traffic.lost))
        came, lost = traffic.came - came, traffic.lost - lost
        if came <= 0:
            return "ok", "nothing came lately"
        if lost <= 0:
            return "ok", "nothing was lost lately"
        share = lost / (came + lost)
        text = f"{100 * share:.1f} % were lost on the way lately"
        if not traffic.is_exact:
            return "ok", f"{text}, at most"
        return "warning" if share > MUCH and lost >= FEWEST_LOST else "ok", text
