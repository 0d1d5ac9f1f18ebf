"""The peers that a connection sends to, and the control of them that commands need."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ...clients.control_state import ControlState
from ...clients.peer_search import PeerBinding
from ...services.definitions import Guard
from ..ends import parameters

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...base.address import JausAddress
    from ...clients.control_session import ControlSession
    from ...clients.peer_search import PeerSearch
    from ..ends.ends import Ends


class ControlledPeers:
    """Who gets the messages of a connection, and who of them obeys."""

    def __init__(self, peers: Sequence[JausAddress] | PeerSearch, control: Guard) -> None:
        """Meets nobody before `open`.

        Args:
            control: What they demand of a sender that they obey. Unless that is ANY, control of
                them is acquired and kept, and they are resumed for READY.
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

        self._binding.follow(ends.component.find_peers, begin, end)

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
            self._sessions[peer] = self._ends.component.control(
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
