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
    """Who gets the messages of a connection, and who of them obeys."""

    def __init__(self, peers: Sequence[JausAddress] | Search, control: Guard) -> None:
        """Meets nobody before `open`.

        Unless control, which they demand of a sender that they obey, is ANY, it is acquired and
        kept, and they are resumed for READY.
        """
        self._binding = PeerBinding(peers)
        self._control = control
        self._sessions: dict[JausAddress, ControlSession] = {}
        self._changed: Callable[[JausAddress], None]
        self._ends: Ends

    @property
    def present(self) -> tuple[JausAddress, ...]:
        """Those that are there: all that are named, or that were found."""
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
        """Meets the peers and starts to acquire control."""
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
        """Whether they obey only who controls them."""
        return self._control is not Guard.ANY

    def obeys(self, peer: JausAddress) -> bool:
        """Whether a peer listens; one that demands no control does always."""
        if self._control is Guard.ANY:
            return True
        session = self._sessions.get(peer)
        if session is None:
            return False
        if session.state is ControlState.CONTROLLED:
            # Without Ready it obeys only what does not demand it.
            return self._control is Guard.CONTROLLED
        return session.state is ControlState.READY

    def reason(self, peer: JausAddress) -> str:
        """Why a peer does not obey, in words."""
        session = self._sessions.get(peer)
        known = session.reason if session is not None else ""
        return known or "it is not controlled"

    def lacking(self) -> str:
        """What is searched for and not found, empty when nothing is lacking."""
        return str(self._binding.search) if self._binding.is_lacking else ""

    def describe(self) -> list[tuple[str, str]]:
        """Names and states of the peers, for diagnostics; why one refuses."""
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

        A stop is due while it is the last word to a peer and may not have arrived; what sends it
        tells `sent` what became of it.
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
        # One repetition at a time for each peer.
        if arrived or self._has_ended or peer in self._waiting:
            return
        settings = self._ends.settings.component
        is_bounded = self._peers.demands_control  # by the loss of control
        # Slower where no loss of control ends the repetition.
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
