"""Connections that carry ROS topics to JAUS. They work on the thread that waits for ROS."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from ..clients.controlled_target import ControlState
from ..clients.peer_binding import PeerBinding
from ..services.definitions import Guard
from ..transports.packets.packet import Priority
from . import parameters
from .connection import NO_PEER, NOT_READY, Connection
from .joins import JoinedTopic

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Concatenate

    from ..base.address import JausAddress
    from ..clients.control_session import ControlSession
    from ..clients.peer_search import PeerSearch
    from ..wire.message import Message
    from .ends import Ends, ReportHolder
    from .joins import Join
    from .quality import TopicFault
    from .stops import Standing, StopReason
    from .topics import Topic

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")


class FromTopics(Connection[SourceT, TargetT]):
    """What the connections from ROS topics have in common: the topics."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        type: type[SourceT],  # noqa: A002 - the word of the model
        topics: Sequence[Topic],
        message: type[TargetT],
        joins: Sequence[Join] = (),
        **when_lost: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            name: Name of the connection in the model.
            translate: Makes the JAUS message, or None to pass nothing on. Joined topics give it
                their messages as keyword arguments.
            type: ROS type of the topics.
            topics: Topics that are subscribed to.
            message: JAUS message that is made.
            joins: Further topics whose latest message the translation needs.
            when_lost: What happens when the topics are lost: the parameters of `Connection`.
        """
        self._joined = tuple(map(JoinedTopic, joins))
        # Connections without joins do not pay for them.
        joining = partial(_translate_joined, translate, self._joined) if joins else translate
        super().__init__(name, joining, **when_lost)
        self._type = type
        self._topics = tuple(topics)
        self._message = message

    def open(self, ends: Ends) -> None:
        """Makes the subscriptions; no message is taken before the bridge runs."""
        super().open(ends)
        self._topics = parameters.topics(ends.ros, self.name, self._topics)
        for joined in self._joined:
            joined.open(ends, self.name)
        for topic in self._topics:
            ends.subscribe(self._type, topic, self.take)

    def topic_faults(self) -> Iterator[TopicFault]:
        """What is wrong with the topics, those of joins included."""
        for source in (self._topics, *(each.topics for each in self._joined)):
            for topic in source:
                yield from self._ends.ros.faults(topic, publishes=False)

    def describe_joins(self) -> list[tuple[str, str]]:
        """The joined topics and the age of their latest message."""
        return [
            (f"join {each.join.name} age (s)", "never" if each.age is None else f"{each.age:.3f}")
            for each in self._joined
        ]

    def _judge(self, rate: float, *, measured: bool, dropping: bool) -> tuple[str, str]:
        level, message = super()._judge(rate, measured=measured, dropping=dropping)
        stale = ", ".join(each.join.name for each in self._joined if each.is_stale)
        if level != "stale" and stale:
            return "warning", f"nothing fresh from {stale}"
        return level, message


def _translate_joined(
    translate: Callable[..., TargetT | None], joined: Sequence[JoinedTopic], source: Any
) -> TargetT | None:
    return translate(source, **{each.join.name: each.fresh() for each in joined})


class TopicsToMessage(FromTopics[SourceT, TargetT]):
    """Sends a JAUS message for each ROS message."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        peers: Sequence[JausAddress] | PeerSearch,
        control: Guard = Guard.ANY,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            name: Name of the connection in the model.
            translate: Makes the JAUS message, or None to pass nothing on.
            peers: JAUS components that receive it, or how they are found.
            control: What the peers demand of a sender that they obey. Unless that is ANY, control
                of them is acquired and kept, they are resumed for READY, and the message is sent
                to a peer only while it obeys.
            priority: Priority of the message (AS5669A).
            acknowledge: Whether each peer shall acknowledge it.
            options: The other parameters of `FromTopics`.
        """
        super().__init__(name, translate, **options)
        self._peers = PeerBinding(peers)
        self._control = control
        self._priority = priority
        self._acknowledge = acknowledge
        self._sessions: dict[JausAddress, ControlSession] = {}

    @property
    def peers(self) -> tuple[JausAddress, ...]:
        """JAUS components that receive it."""
        return self._peers.present

    def open(self, ends: Ends) -> None:
        """Makes the subscriptions and starts to acquire control."""
        super().open(ends)
        self._peers = parameters.peers(ends.ros, self.name, self._peers)
        self._peers.follow(ends.component.find_peers, self._join, self._leave)

    def _join(self, peer: JausAddress) -> None:
        if self._control is not Guard.ANY:
            self._sessions[peer] = self._ends.component.control(
                peer,
                authority=self._ends.settings.authority,
                resume=self._control is Guard.READY,
                on_change=partial(self._control_changed, peer),
            )

    def _leave(self, peer: JausAddress) -> None:
        session = self._sessions.pop(peer, None)
        if session is not None:
            session.release()

    def lacks_peers(self) -> str:
        """What is searched for and not found."""
        return str(self._peers.search) if self._peers.is_lacking else ""

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:  # noqa: ARG002
        """Stops what the bridge commands while it may not command."""
        return self.is_command and self.halt(standing.halt)

    def deliver(self, target: TargetT) -> bool:
        """Encodes once and sends to each peer that obeys; False when none does."""
        with self._ends.loop.lock:
            if self._halt is not None:  # since the message was taken; the stop is the last word
                self._refuse_halted(self._halt)
                return False
            if not self.peers:
                self.drop(NO_PEER)
                return False
            obeying = [peer for peer in self.peers if self._is_obeyed(peer)]
            for peer in self.peers:
                if peer not in obeying:
                    self.drop(NOT_READY, str(peer))
            return self._send(obeying, target, acknowledge=self._acknowledge)

    def deliver_stop(self, target: TargetT) -> bool:
        """Sends the stop to each peer that obeys, again until it is acknowledged.

        The others get it when they obey again.
        """
        obeying = [peer for peer in self.peers if self._is_obeyed(peer)]
        return self._send(obeying, target, acknowledge=True)

    def _send(self, peers: Sequence[JausAddress], target: TargetT, *, acknowledge: bool) -> bool:
        payload = target.encode()
        component = self._ends.component
        with component.loop.lock:
            for peer in peers:
                component.transport.send(
                    component.address,
                    peer,
                    payload,
                    priority=self._priority,
                    acknowledge=acknowledge,
                )
        return bool(peers)

    def _is_obeyed(self, peer: JausAddress) -> bool:
        """Whether a peer listens; one that demands no control does always."""
        if self._control is Guard.ANY:
            return True
        session = self._sessions.get(peer)
        return session is not None and self._obeys(session.state)

    def describe_peers(self) -> list[tuple[str, str]]:
        """The JAUS components and the state of their control."""
        states = {peer: session.state.name.lower() for peer, session in self._sessions.items()}
        named = [(f"peer {peer}", states.get(peer, "addressed")) for peer in self.peers]
        return [*self._peers.describe(), *named]

    def _control_changed(self, peer: JausAddress, state: ControlState) -> None:
        # A peer that was away when the topics fell silent has missed the safe value.
        if self._obeys(state) and self.is_silent:
            self.send_safe_value(partial(self._send, [peer], acknowledge=True))

    def _obeys(self, state: ControlState) -> bool:
        if state is ControlState.CONTROLLED:
            return self._control is Guard.CONTROLLED
        return state is ControlState.READY


class TopicsToReport(FromTopics[SourceT, TargetT]):
    """Serves the newest ROS message as a JAUS report, to queries and events alike."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        query: type[Message],
        freshness: float = 0.0,
        empty: Callable[[], TargetT] | None = None,
        silence_timeout: float = 0.0,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            name: Name of the connection in the model.
            translate: Makes the JAUS report, or None to keep the one before.
            query: The query that asks for the report.
            freshness: Seconds after which a message is too old to be reported; 0 means never.
            empty: Makes the report that says that there is no data, when its fields are optional.
            silence_timeout: Seconds without a message that count as silence; 0 means never.
            options: The other parameters of `FromTopics`.
        """
        super().__init__(name, translate, silence_timeout=silence_timeout or freshness, **options)
        self._query = query
        self._empty = empty
        self._present: TargetT | None = None
        self._report: ReportHolder

    def open(self, ends: Ends) -> None:
        """Offers the report, then makes the subscriptions."""
        super().open(ends)
        self._report = ends.report(self._query, self._message)

    def deliver(self, target: TargetT) -> bool:
        """Makes the message the present report and tells subscribers of changes."""
        target.encode()  # an unfit value is refused here, not at the next query
        with self._ends.loop.lock:
            self._put(target)
        return True

    def stop(self, reason: StopReason) -> bool:
        """Reports the safe value; without one, that there is no data.

        A number that is old is no report. Where the standard lets every field be absent, queries
        and events say so; else queries stay without an answer, and events pause.
        """
        stood = super().stop(reason)
        # Of several connections to one report, the one that spoke last has the word.
        if self._safe_value is None and self._report.value is self._present:
            self._put(self._empty() if self._empty is not None else None)
        return stood

    def _put(self, report: TargetT | None) -> None:
        self._present = self._report.value = report
        self._ends.component.report_changed(self._message)

    def describe_peers(self) -> list[tuple[str, str]]:
        """Reports go to whoever asks."""
        return [("peer", "any")]
