"""What a connection asks of JAUS peers by events and queries, and what it answers to theirs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from ...clients.event_client import EventClient
from ...clients.peer_binding import PeerBinding
from ...clients.query import QueryClient
from ...services.definitions import Guard
from ...transports.delivery import MESSAGE_CODE_SIZE
from ..ends import parameters
from ..ends.ends import Taker
from ..ends.simulation import real_rate
from .translations import Joined

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...base.address import JausAddress
    from ...clients.event_subscription import EventSubscription
    from ...services.host import Host
    from ...wire.message import Message
    from ..ends.ends import Ends
    from .connection import Take
    from .translations import Transcode


class EventRequests:
    """The AS5710 events of a report, one of each peer.

    Attributes:
        rate: Reports each second; None means one on every change.
    """

    def __init__(
        self, ends: Ends, query: Message, message: type[Message], take: Take, rate: float | None
    ) -> None:
        """Asks nobody yet.

        Args:
            message: The report.
        """
        self.rate = rate
        self._ends = ends
        self._query = query
        self._message = message
        self._take = take
        self._events: dict[JausAddress, EventSubscription] = {}
        self._lost = self._late = 0
        # Peers have real time: another pace of the simulation is another rate for them.
        if rate is not None and ends.simulation is not None:
            ends.simulation.clock.follow_ratio(self._ask_anew)

    def begin(self, peer: JausAddress) -> None:
        """Asks a peer for the event."""
        self._events[peer] = self._ends.component.part(EventClient).subscribe(
            peer, self._query, self._message, self._take, rate=self._real_rate, payloads=True
        )

    def end(self, peer: JausAddress) -> None:
        """Asks a peer no more."""
        self._end(self._events.pop(peer))

    @property
    def lost(self) -> int:
        """Reports that did not arrive."""
        return self._lost + sum(event.lost for event in self._events.values())

    @property
    def late(self) -> int:
        """Reports that came after newer ones."""
        return self._late + sum(event.late for event in self._events.values())

    def set_rate(self, hertz: float) -> None:
        """Has the events of all peers come at another rate."""
        with self._ends.loop.lock:
            self.rate = hertz
            self._ask_anew()

    def state_of(self, peer: JausAddress) -> str:
        """How it stands with a peer, for diagnostics."""
        event = self._events.get(peer)
        return "confirmed" if event is not None and event.active else "asked"

    def _ask_anew(self) -> None:
        """Has the events of all peers come at the present rate."""
        if self._events:
            former, self._events = self._events, {}
            # The new event is asked for before the former one ends, so that reports go on.
            for peer, event in former.items():
                self.begin(peer)
                self._end(event)

    def _end(self, event: EventSubscription) -> None:
        self._lost, self._late = self._lost + event.lost, self._late + event.late
        event.cancel()

    @property
    def _real_rate(self) -> float | None:
        """The rate that peers are asked for, whose clock is not that of a simulation."""
        simulation = self._ends.simulation
        if simulation is None or self.rate is None:
            return self.rate
        return real_rate(self.rate, simulation.clock.ratio)


class QueryRequests:
    """Queries for a report, one in each period to each peer.

    Attributes:
        rate: Queries each second.
    """

    def __init__(
        self, ends: Ends, query: Message, message: type[Message], take: Take, rate: float
    ) -> None:
        self.rate = rate
        self._ends = ends
        self._query = query
        self._message = message
        self._take = take
        self._peers: PeerBinding
        self._component: Host
        self._next = 0.0
        self._unanswered: set[JausAddress] = set()
        self._silent: set[JausAddress] = set()

    def start(self, peers: PeerBinding) -> None:
        """Asks whoever is there, from the next turn of the loop on."""
        self._peers = peers
        self._component = self._ends.component
        self._next = self._ends.clock.now()
        self._ends.loop.call_soon(self._ask)

    def set_rate(self, hertz: float) -> None:
        """Asks at another rate from the next query on."""
        self.rate = hertz

    def is_silent(self, peer: JausAddress) -> bool:
        """Whether a peer did not answer lately."""
        return peer in self._silent

    def _ask(self) -> None:
        if not self._component.running:
            return  # the bridge was closed; opened again, it has other queries
        clock = self._ends.clock
        # Absolute times, so that the rate does not drift; a late loop does not catch up.
        self._next = max(self._next + 1 / self.rate, clock.now())
        clock.call_at(self._next, self._ask)
        for peer in self._peers.present:
            (self._silent.add if peer in self._unanswered else self._silent.discard)(peer)
            self._unanswered.discard(peer)
            # Repetition is the next period's; a late answer counts as an answer.
            self._component.part(QueryClient).ask(
                peer,
                self._query,
                self._message,
                self._take,
                on_failure=partial(self._unanswered.add, peer),
                timeout=1 / self.rate,
                retries=0,
                payloads=True,
            )


@dataclass(frozen=True)
class CommandAnswer:
    """How a command is told.

    Attributes:
        same: Attributes of the query that say which command is meant.
        has_empty: Whether a report without any field can say that nothing is commanded.
    """

    query: type[Message]
    report: type[Message]
    same: tuple[str, ...] = ()
    has_empty: bool = False


class CommandMemory:
    """Remembers the last command that was passed on, and tells it until a stop is sent."""

    def __init__(self, answer: CommandAnswer) -> None:
        self._answer = answer
        self._payload: bytes | None = None

    def provide(self, component: Host) -> None:
        """Answers the query, and periodic events on it; nobody watches for changes."""
        self._payload = None
        answer = self._answer
        component.provide(answer.query, answer.report, self._report, every_change=False)

    def forget(self) -> None:
        """Tells nothing before the next command, since a stop stands."""
        self._payload = None

    def remembering(self, transcode: Transcode) -> Transcode:
        """Returns a translation of commands, of which those that it passes on are remembered."""

        def remember(data: bytes, **joined: object) -> bytes | None:
            target = transcode(data, **joined)
            if target is not None:
                self._payload = data
            return target

        return remember

    def _report(self, query: Message, _sender: JausAddress) -> Message | bytes | None:
        answer = self._answer
        if self._payload is None:
            return answer.report() if answer.has_empty else None
        # A report has the fields of the command that it tells; only the code is another one.
        code = answer.report.CODE.to_bytes(MESSAGE_CODE_SIZE, "little")
        payload = code + self._payload[MESSAGE_CODE_SIZE:]
        if answer.same:
            report = answer.report.decode(payload)
            if any(getattr(query, field) != getattr(report, field) for field in answer.same):
                return None
        return payload


@dataclass(frozen=True)
class ReportJoin:
    """What the model says about a joined report.

    Attributes:
        query: The query whose answer is the report; None takes reports that are sent unasked.
        rate: Reports each second that are asked for, 0 for the frequency of the bridge; None means
            one on every change.
        is_asked: Whether a query asks for each report, instead of an event.
        peers: JAUS components that send it; none means those of the connection.
        freshness: Seconds after which the latest report is stale.
        drop: Whether a main message is dropped when there is nothing fresh. Otherwise its
            translation is given None.
    """

    name: str
    message: type[Message]
    query: Message | None = None
    rate: float | None = None
    is_asked: bool = False
    peers: Sequence[JausAddress] = ()
    freshness: float = 1.0
    drop: bool = False


class JoinedReport(Joined):
    """The latest of the reports of whoever sends it."""

    def __init__(self, join: ReportJoin) -> None:
        super().__init__(join.name, freshness=join.freshness, drop=join.drop)
        self.join = join
        self._peers = PeerBinding(join.peers)

    def open(
        self,
        ends: Ends,
        connection: str,
        peers: PeerBinding,
        refuse: Callable[[bytes, Any], None],
    ) -> None:
        """Asks for the reports, or listens."""
        join, owner = self.join, f"{connection}.{self.name}"
        usual = join.rate or (None if join.rate is None else ends.settings.frequency)
        self.begin(ends, owner, join.message.decode)
        if join.peers:
            self._peers = parameters.peers(ends.ros, owner, self._peers)
        else:
            self._peers = PeerBinding(peers.search or peers.present)
        if join.query is None:
            senders = None if self._peers.is_anybody else self._peers
            ends.shared_messages.accept(join.message, Taker(self.keep, senders, refuse), Guard.ANY)
            self._peers.follow(ends.component, _nothing, _nothing)
        elif join.is_asked and usual is not None:
            asked = QueryRequests(ends, join.query, join.message, self.keep, usual)
            asked.rate = ends.ros.parameter(parameters.RATE.of(usual, owner), asked.set_rate)
            self._peers.follow(ends.component, _nothing, _nothing)
            asked.start(self._peers)
        else:
            events = EventRequests(ends, join.query, join.message, self.keep, usual)
            if usual is not None:
                rate = parameters.RATE.of(usual, owner)
                events.rate = ends.ros.parameter(rate, events.set_rate)
            self._peers.follow(ends.component, events.begin, events.end)


def _nothing(_peer: JausAddress) -> None:
    """Nothing is to be done about a peer that is met or gone."""
