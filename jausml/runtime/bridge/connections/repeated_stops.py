"""Stops for JAUS peers, sent again while they are lost on the way."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ...base.quirks import Quirk

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ..ends.ends import Ends
    from .controlled_peers import ControlledPeers


class RepeatedStops:
    """Has a stop sent again until it is known to have arrived, is not due, or is not obeyed.

    The radio may be away for longer than a message is repeated, and be back before control is
    lost: the peer would go on for ever with what was commanded before.
    """

    def __init__(
        self,
        peers: ControlledPeers,
        is_due: Callable[[JausAddress], bool],
        send: Callable[[JausAddress], object],
    ) -> None:
        """Repeats nothing before `open`.

        Args:
            is_due: Whether the last word to a peer is a stop, which may not have arrived.
            send: Sends the stop to a peer, and tells `sent` what became of it.
        """
        self._peers = peers
        self._is_due = is_due
        self._send = send
        self._waiting: set[JausAddress] = set()
        self._has_ended = False
        self._ends: Ends

    def open(self, ends: Ends) -> None:
        """Begins a life, in which no stop was sent yet."""
        self._ends = ends
        self._waiting.clear()
        self._has_ended = False

    def end(self) -> None:
        """Has nothing sent again from now on: the bridge ends."""
        self._has_ended = True

    def has_arrived(self, peer: JausAddress, acknowledged: bool) -> bool:  # noqa: FBT001 - a fact
        """Whether a message counts as arrived: some peers acknowledge nothing."""
        quirks = self._ends.component.transport.quirks
        return acknowledged or quirks.has(peer, Quirk.NO_ACKNOWLEDGEMENTS)

    def sent(self, peer: JausAddress, arrived: bool) -> None:  # noqa: FBT001 - a fact
        """Takes what became of a stop."""
        if arrived or self._has_ended or peer in self._waiting:
            return
        settings = self._ends.settings.component
        is_bounded = self._peers.demands_control  # by the loss of control
        pause = settings.retry_min if is_bounded else settings.watch_interval
        self._waiting.add(peer)
        self._ends.loop.call_later(pause, partial(self._again, peer))

    def changed(self, peer: JausAddress) -> None:
        """Sends the stop to a peer that obeys again, which has missed it while it was away."""
        peers = self._peers
        is_obeyed = peer in peers.present and peers.obeys(peer)
        if is_obeyed and not self._has_ended and self._is_due(peer):
            self._send(peer)

    def _again(self, peer: JausAddress) -> None:
        self._waiting.discard(peer)
        self.changed(peer)
