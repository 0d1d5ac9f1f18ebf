"""Control of the peers of a connection, and stops that are sent again until they arrive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from ...base.address import JausAddress
from ...base.quirks import Quirk
from ...clients.control_session import ControlClient, ControlSession
from ...clients.control_state import ControlState
from ...clients.peer_binding import PeerBinding, Search
from ...services.definitions import Guard
from ..ends import parameters
from ..ends.ends import Ends


class ControlledPeers:
    """The peers that get the messages of a connection, and which of them obey."""

    def __init__(self, peers: Sequence[JausAddress] | Search, control: Guard) -> None:
        """Contacts no peer before `open`.

        Args:
            control: Guard of the peers for their senders. Unless that is ANY, control
                is acquired and kept; for READY the peers are also resumed.
        """
        self._binding = PeerBinding(peers)
        self._control = control
        self._sessions: dict[JausAddress, ControlSession] = {}
        self._changed: Callable[[JausAddress], None]
        self._ends: Ends

    @property
    def present(self) -> tuple[JausAddress, ...]:
        """The peers that are named, or that a search has found."""
        return self._binding.present

    def open(
        self,
        ends: Ends,
        connection: str,
        *,
        join: Callable[[JausAddress], None],
        leave: Callable[[JausAddress], None],
        changed: Callable[[JausAddress], None],
    ) -> None:
        """Finds the peers and starts to acquire control.

        Args:
            join: Called with each peer that is there from now on.
            leave: Called with each peer that has gone.
            changed: Called with a peer of which the control has changed.
        """
        self._ends, self._changed = ends, changed
        self._binding = parameters.peers(ends.ros, connection, self._binding)

        def begin(peer: JausAddress) -> None:
            self._join(peer)
            join(peer)

        def end(peer: JausAddress) -> None:
            self._leave(peer)
            leave(peer)

        self._binding.follow(ends.component, begin, end)

    @property
    def demands_control(self) -> bool:
        """Whether the peers obey only their controller."""
        return self._control is not Guard.ANY

    def obeys(self, peer: JausAddress) -> bool:
        """Returns whether a peer obeys; always if it demands no control."""
        if self._control is Guard.ANY:
            return True
        session = self._sessions.get(peer)
        if session is None:
            return False
        if session.state is ControlState.CONTROLLED:
            # A peer that is not Ready obeys only commands that do not demand Ready.
            return self._control is Guard.CONTROLLED
        return session.state is ControlState.READY

    def reason(self, peer: JausAddress) -> str:
        """Returns why a peer does not obey, in words."""
        session = self._sessions.get(peer)
        reason = session.reason if session is not None else ""
        return reason or "it is not controlled"

    def lacking(self) -> str:
        """Returns which peer is searched for and not found; empty when none is lacking."""
        return str(self._binding.search) if self._binding.is_lacking else ""

    def describe(self) -> list[tuple[str, str]]:
        """Returns names and states of the peers, for diagnostics; also why one refuses."""
        states = {peer: _described(session) for peer, session in self._sessions.items()}
        named = [(f"peer {peer}", states.get(peer, "addressed")) for peer in self.present]
        return [*self._binding.describe(), *named]

    def _join(self, peer: JausAddress) -> None:
        if self._control is not Guard.ANY:
            self._sessions[peer] = self._ends.component.part(ControlClient).control(
                peer,
                authority=self._ends.settings.authority,
                resume=self._control is Guard.READY,
                on_change=partial(self._control_changed, peer),
            )

    def _control_changed(self, peer: JausAddress, _state: ControlState) -> None:
        self._changed(peer)

    def _leave(self, peer: JausAddress) -> None:
        session = self._sessions.pop(peer, None)
        if session is not None:
            session.release()


def _described(session: ControlSession) -> str:
    state = session.state.name.lower()
    return f"{state}: {session.reason}" if session.state is ControlState.REFUSED else state


class RepeatedStops:
    """Repeats a stop until it is acknowledged, is not due any more, or its peer does not obey.

    A radio link may fail for longer than the transport repeats a message, and be back before
    control is lost: the peer would follow the command before the stop for ever.
    """

    def __init__(
        self,
        peers: ControlledPeers,
        is_due: Callable[[JausAddress], bool],
        send: Callable[[JausAddress], object],
    ) -> None:
        """Repeats nothing before `open`.

        Args:
            is_due: Returns whether the stop is still the last command to a peer.
            send: Sends the stop to a peer; the outcome is to be reported to `sent`.
        """
        self._peers = peers
        self._is_due = is_due
        self._send = send
        self._waiting: set[JausAddress] = set()
        self._has_ended = False
        self._ends: Ends

    def open(self, ends: Ends) -> None:
        """Begins anew, as if no stop had been sent."""
        self._ends = ends
        self._waiting.clear()
        self._has_ended = False

    def end(self) -> None:
        """Repeats nothing from now on: the bridge ends."""
        self._has_ended = True

    def has_arrived(self, peer: JausAddress, acknowledged: bool) -> bool:  # noqa: FBT001 - a fact
        """Returns whether a message counts as arrived: also at peers that never acknowledge."""
        quirks = self._ends.component.transport.quirks
        return acknowledged or quirks.has(peer, Quirk.NO_ACKNOWLEDGEMENTS)

    def sent(self, peer: JausAddress, arrived: bool) -> None:  # noqa: FBT001 - a fact
        """Takes the outcome of a stop, and schedules a repetition if it did not arrive."""
        # One repetition at a time for each peer.
        if arrived or self._has_ended or peer in self._waiting:
            return
        settings = self._ends.settings.component
        # Slower where no loss of control ends the repetition.
        is_bounded = self._peers.demands_control
        pause = settings.retry_min if is_bounded else settings.watch_interval
        self._waiting.add(peer)
        self._ends.loop.call_later(pause, partial(self._repeat, peer))

    def changed(self, peer: JausAddress) -> None:
        """Sends the stop to a peer that obeys again, which has missed it while it was away."""
        peers = self._peers
        is_obeyed = peer in peers.present and peers.obeys(peer)
        if is_obeyed and not self._has_ended and self._is_due(peer):
            self._send(peer)

    def _repeat(self, peer: JausAddress) -> None:
        self._waiting.discard(peer)
        self.changed(peer)
