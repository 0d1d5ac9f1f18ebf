"""Process of a guardian: watches one bridge, and sends its stops when the bridge cannot.

It has no model, maps or messages: the bridge registers stops in advance, as octets. They are sent
if the bridge has died, or has not run its loop for longer than the patience of a stop. A bridge
that ends in good order has sent its stops itself.
"""

from __future__ import annotations

import select
import signal
import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from .page import Page, read_frame, steady_ns
from .rcl import Rcl, RclError
from .sayings import Announcement, Cancellation, Datagram, Stops, Topic

POLL = 0.1  # seconds between two checks of the beat
GOAL_PATIENCE = 1.5  # seconds without a beat after which goals are cancelled, which is final
SENDING_TIME = 1.0  # seconds for which stops are published and goals are cancelled
# Seconds for which subscribers of a topic are searched for, if there were none: participants of DDS
# find each other at once, or after 3 s with the next announcement.
SEARCH_TIME = 5.0
REPETITIONS = 3  # of a stop to each subscriber and component, as messages may be lost
INTERVAL = 0.1  # seconds between repetitions
_PAUSE = 0.002
_CANCEL = "action_msgs/srv/CancelGoal"
_STAMP = struct.Struct("<iI")
EXIT_OF_ROS = 3  # exit code of a guardian that cannot join ROS

_ResultT = TypeVar("_ResultT")


class Guardian:
    """The guardian of one bridge."""

    def __init__(
        self, channel: socket.socket, page: Page, death: int, name: str, bridge: int
    ) -> None:
        """Watches nothing before `run`.

        Args:
            death: Descriptor of the process of the bridge, opened by the bridge, which may have
                died before this process runs.
            name: Kind of the bridge, for the log.
            bridge: Process id of the bridge.
        """
        self._channel = channel
        self._page = page
        self._name = name
        self._bridge = bridge
        self._stops: dict[int, Stops] = {}
        self._deliveries: list[Iterator[None]] = []  # under way; each step sends what is due
        self._goals: dict[bytes, str] = {}
        self._sent: set[int] = set()  # numbers of stops
        self._last_beat = 0  # before which they were sent
        self._numbered: dict[int, tuple[int, list[bytes]]] = {}
        self._are_goals_cancelled = False
        self._ros: Rcl | None = None
        self._cancel: Any = None
        self._complaints: set[str] = set()
        self._is_over = False
        self._death = death

    def run(self) -> None:
        """Watches until the bridge has died or ends the guardian."""
        try:
            self._watch()
            while self._deliveries and not self._is_over:
                self._go_on()
                time.sleep(_PAUSE)
        finally:
            if self._ros is not None:
                self._ros.close()

    def _watch(self) -> None:
        poll = select.poll()
        poll.register(self._channel, select.POLLIN)
        poll.register(self._death, select.POLLIN)
        last, was_halted = steady_ns(), False
        while not self._is_over:
            pause = _PAUSE if self._deliveries else POLL
            ready = {descriptor for descriptor, _ in poll.poll(pause * 1000)}
            now = steady_ns()
            # If this process stood still itself, maybe with the bridge, it checks the beat only in
            # the next turn; but not twice in a row, as on a slow machine.
            was_halted, last = now - last > 4 * POLL * 1e9 and not was_halted, now
            if self._death in ready:
                # The last frames may have a stop, or end the guardian.
                self._read()
                if not self._is_over:
                    # At once, as a dead bridge cannot send its stops any more.
                    self._send_stops(list(self._armed()), goals=True, why="has died")
                return
            if ready:
                self._read()
            if not was_halted:
                self._judge()
            self._go_on()

    def _go_on(self) -> None:
        """Goes on with all deliveries, none of which waits for another."""
        ended = object()
        self._deliveries = [
            delivery for delivery in self._deliveries if next(delivery, ended) is not ended
        ]

    # ------------------------------------------------------------------ frames

    def _read(self) -> None:
        """Reads all waiting frames."""
        while not self._is_over and select.select([self._channel], [], [], 0)[0]:
            content = read_frame(self._channel)
            if content is None:  # the bridge has died, which `_death` tells as well
                return
            self._take(content)

    def _take(self, content: dict[str, Any]) -> None:
        match content["kind"]:
            case "ros":
                self._ros = Rcl(
                    content["rcl"],
                    content["utilities"],
                    f"_guardian_{self._bridge}",
                    content["arguments"],
                )
            case "stops":
                attempts = [
                    self._attempt(topic["topic"], self._make_topic, topic)
                    for topic in content["topics"]
                ]
                topics = [topic for topic in attempts if topic is not None]
                datagrams = [_datagram(datagram) for datagram in content["datagrams"]]
                refused = len(attempts) - len(topics)
                self._stops[content["number"]] = Stops(
                    content["patience"], topics, datagrams, refused
                )
            case "goal":
                if self._cancel is None:
                    library = content["library"]
                    self._cancel = self._attempt(_CANCEL, self._load_support, library, _CANCEL)
                self._goals[bytes.fromhex(content["id"])] = content["service"]
            case "done":
                self._goals.pop(bytes.fromhex(content["id"]), None)
            case "nothing":
                self._stops.clear()
                self._goals.clear()
            case "bye":
                self._is_over = True
        refused = sum(stop.refused for stop in self._stops.values())
        self._page.refused = refused + (len(self._goals) if self._cancel is None else 0)

    def _attempt(
        self, subject: str, function: Callable[..., _ResultT], *arguments: Any
    ) -> _ResultT | None:
        """Returns the result of a function; None after an error of ROS, which is logged once."""
        try:
            return function(*arguments)
        except RclError as error:
            complaint = f"{subject} cannot be stopped: {error}"
            if complaint not in self._complaints:
                self._complaints.add(complaint)
                _log(complaint)
            return None

    def _make_topic(self, content: dict[str, Any]) -> Topic:
        support = self._load_support(content["library"], content["type"])
        data = bytearray.fromhex(content["data"])
        return Topic(content["topic"], support, content["qos"], data, content["stamps"])

    def _load_support(self, library: str, name: str) -> Any:
        if self._ros is None:
            raise RclError("nothing is known of ROS")
        support = self._ros.type(library, *name.split("/"))
        # The check needs a publisher, which a service does not have.
        if "/msg/" in name:
            self._ros.check(support)
        return support

    # ------------------------------------------------------------------ judging

    def _armed(self) -> list[int]:
        return [number for number in self._stops if self._page.armed[number]]

    def _age(self) -> float:
        """Returns the seconds since the last beat; very long before the first command."""
        return _seconds_since(self._page.beat)

    def _judge(self) -> None:
        """Sends the stops that are due as the bridge does not run its loop."""
        if self._page.beat != self._last_beat:
            # The bridge has run since: another standstill begins.
            self._sent.clear()
            self._are_goals_cancelled = False
        age = self._age()
        due = [number for number in self._armed() if age > self._stops[number].patience]
        # Once in each standstill.
        due = [number for number in due if number not in self._sent]
        goals = bool(self._goals) and age > GOAL_PATIENCE and not self._are_goals_cancelled
        if due or goals:
            self._send_stops(due, goals=goals, why="does not run its loop")

    def _send_stops(self, numbers: list[int], *, goals: bool, why: str) -> None:
        """Begins to send stops and cancel goals."""
        # First `taken`, then the beat: the bridge does it the other way round, so that at least
        # one of both notices the other.
        self._page.taken += 1
        is_halted, beat = not _is_ready(self._death), self._page.beat
        # The bridge is back: it notices `taken`, and sends its own stops.
        if is_halted and _seconds_since(beat) <= POLL * 2:
            return
        self._last_beat = beat
        self._sent.update(numbers)
        self._are_goals_cancelled = self._are_goals_cancelled or goals
        stops = [self._stops[number] for number in numbers]
        count = sum(len(stop.topics) + len(stop.datagrams) for stop in stops)
        cancelled = dict(self._goals) if goals else {}
        if not (count or cancelled):
            return
        amount = f"{count} stops, {len(cancelled)} goals"
        _log(f"the {self._name} (process {self._bridge}) {why}: {amount}")
        datagrams = [datagram for stop in stops for datagram in stop.datagrams]
        topics = [topic for stop in stops for topic in stop.topics]
        self._deliveries.append(self._deliver(datagrams, topics, cancelled, is_halted=is_halted))

    # ------------------------------------------------------------------ sending

    def _deliver(
        self,
        datagrams: list[Datagram],
        topics: list[Topic],
        goals: dict[bytes, str],
        *,
        is_halted: bool,
    ) -> Iterator[None]:
        """Sends stops and cancels goals, until all are delivered or the bridge is back."""
        self._number(datagrams)
        start = time.monotonic()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as outlet:
            # Datagrams first, as it takes time to find subscribers of topics.
            self._send(outlet, datagrams)
            sent = 1
            attempts = [self._attempt(topic.name, self._announce, topic) for topic in topics]
            announcements = [announcement for announcement in attempts if announcement is not None]
            cancellations = [
                Cancellation(canceller, goal, service)
                for goal, service in goals.items()
                if (canceller := self._attempt(service, self._canceller, service)) is not None
            ]
            while (elapsed := time.monotonic() - start) < SEARCH_TIME:
                if sent < REPETITIONS and elapsed >= sent * INTERVAL:
                    self._send(outlet, datagrams)
                    sent += 1
                # Later, only topics that had no subscriber so far.
                waiting = [
                    announcement
                    for announcement in announcements
                    if elapsed < SENDING_TIME
                    or self._attempt(announcement.topic.name, self._lacks_subscriber, announcement)
                ]
                for announcement in waiting:
                    self._attempt(announcement.topic.name, self._publish, announcement)
                if not (waiting or cancellations or sent < REPETITIONS):
                    break
                cancellations = [
                    cancellation
                    for cancellation in cancellations
                    if not self._attempt(cancellation.service, self._cancel_goal, cancellation)
                ]
                if is_halted and self._age() <= POLL * 2:
                    break  # the bridge is back, and sends its own stops and commands
                yield
        for announcement in announcements:
            self._attempt(announcement.topic.name, self._known_ros.destroy, announcement.publisher)

    def _number(self, datagrams: list[Datagram]) -> None:
        """Sets the sequence numbers of datagrams; those of one route with other content differ."""
        for datagram in datagrams:
            first, content = self._page.numbers[datagram.slot], bytes(datagram.data[:-2])
            start, contents = self._numbered.get(datagram.slot, (first, []))
            contents = contents if start == first else []
            self._numbered[datagram.slot] = first, contents
            if content not in contents:
                contents.append(content)
            # A datagram ends with its sequence number (AS5669A).
            datagram.data[-2:] = struct.pack("<H", (first + contents.index(content)) & 0xFFFF)

    def _send(self, outlet: socket.socket, datagrams: list[Datagram]) -> None:
        for datagram in datagrams:
            try:
                outlet.sendto(datagram.data, datagram.endpoint)
            except OSError as error:
                _log(f"the stop for {datagram.endpoint} cannot be sent: {error}")

    @property
    def _known_ros(self) -> Rcl:
        if self._ros is None:
            raise RclError("nothing is known of ROS")
        return self._ros

    def _announce(self, topic: Topic) -> Announcement:
        ros = self._known_ros
        # With our own publisher, which the graph may not show yet.
        rivals = ros.publishers(topic.name) + 1
        return Announcement(ros.publisher(topic.name, topic.support, topic.qos), topic, rivals)

    def _lacks_subscriber(self, announcement: Announcement) -> bool:
        """Returns whether a stop had no subscriber, and no other node has begun to publish."""
        return (
            not announcement.times
            and self._known_ros.publishers(announcement.topic.name) <= announcement.rivals
        )

    def _canceller(self, service: str) -> Any:
        if self._cancel is None:
            raise RclError("nothing is known of its cancelling")
        return self._known_ros.canceller(service, self._cancel)

    def _cancel_goal(self, cancellation: Cancellation) -> bool:
        """Requests a cancellation again; returns whether there were enough requests.

        They are repeated, as the server may not have found this client yet.
        """
        now, canceller = time.monotonic(), cancellation.canceller
        is_due = now - cancellation.last >= INTERVAL
        if is_due and self._known_ros.cancel(canceller, cancellation.goal):
            cancellation.first, cancellation.last = cancellation.first or now, now
        return cancellation.first > 0 and now - cancellation.first >= SENDING_TIME

    def _publish(self, announcement: Announcement) -> None:
        """Publishes a stop again if a subscriber may not have it."""
        subscriber_count = self._known_ros.subscribers(announcement.publisher)
        # Counted by the number of subscribers, as a new one does not have it.
        times, now = announcement.times.get(subscriber_count, 0), time.monotonic()
        if not subscriber_count or times >= REPETITIONS:
            return
        if times and now - announcement.last < INTERVAL:
            return
        topic = announcement.topic
        seconds, nanoseconds = divmod(self._page.simulated or time.time_ns(), 10**9)
        for offset in topic.stamps:
            _STAMP.pack_into(topic.data, offset, seconds, nanoseconds)
        self._known_ros.publish(announcement.publisher, bytes(topic.data))
        announcement.times[subscriber_count], announcement.last = times + 1, now


def _datagram(content: dict[str, Any]) -> Datagram:
    host, port = content["endpoint"]
    return Datagram(bytearray.fromhex(content["data"]), (host, port), content["slot"])


def _seconds_since(beat: int) -> float:
    return (steady_ns() - beat) / 1e9


def _is_ready(descriptor: int) -> bool:
    return bool(select.select([descriptor], [], [], 0)[0])


def _log(text: str) -> None:
    sys.stderr.write(f"WARNING jausml guardian: {text}\n")
    sys.stderr.flush()


def main(channel: str, page: str, death: str, name: str, bridge: str) -> int:
    """Guards one bridge; returns the exit code: 0, or `EXIT_OF_ROS`."""
    # It ends with its bridge; signals of a terminal or a service manager are for the bridge.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    with socket.socket(fileno=int(channel)) as own:
        try:
            Guardian(own, Page.at(int(page)), int(death), name, int(bridge)).run()
        except RclError as error:
            _log(f"cannot speak ROS: {error}")
            return EXIT_OF_ROS
    return 0
