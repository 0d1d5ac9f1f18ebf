"""Process of a guardian: watches one bridge, and says its stops when the bridge cannot.

It knows nothing of models, maps or messages. What may have to be said was handed over before, as
octets; it is said when the bridge is dead, or has not run its loop for longer than the patience of
a stop. Then, and never otherwise: a bridge that ends in good order has said its stops itself.
"""

from __future__ import annotations

import select
import signal
import socket
import struct
import sys
import time
from collections.abc import Callable
from typing import Any, TypeVar

from .page import Page, read_frame, steady_ns
from .rcl import Rcl, RclError
from .sayings import Cancel, Datagram, Stops, Told, Topic

POLL = 0.1  # seconds between two looks at the beat

GOAL_PATIENCE = 1.5
"""Seconds without a beat after which goals are cancelled: what is cancelled cannot be taken up."""

SAID_FOR = 1.0  # seconds for which stops are said to whoever is found, and goals are cancelled

SOUGHT_FOR = 5.0
"""Seconds for which whoever listens to a topic is looked for, where nobody was found before.

Participants of DDS find each other at once, or when one announces itself again, after 3 s.
"""

TIMES = 3  # how often each subscriber and each component is told, as the first message may get lost
AGAIN = 0.1  # seconds between these
_PAUSE = 0.002
_CANCEL = "action_msgs/srv/CancelGoal"
_STAMP = struct.Struct("<iI")
EXIT_OF_ROS = 3  # exit code of a guardian that cannot speak ROS

_ResultT = TypeVar("_ResultT")


class Guardian:
    """One guardian of one bridge."""

    def __init__(
        self, channel: socket.socket, page: Page, death: int, name: str, bridge: int
    ) -> None:
        """Watches nothing before `run`.

        Args:
            death: Descriptor of the process that the bridge is, which it opened itself: it may be
                gone before this one runs.
            name: What the bridge is, as people are told.
        """
        self._channel = channel
        self._page = page
        self._name = name
        self._bridge = bridge
        self._stops: dict[int, Stops] = {}
        self._goals: dict[bytes, str] = {}
        self._said: set[int] = set()
        self._missed = 0  # the beat after which they were said
        self._numbered: dict[int, tuple[int, list[bytes]]] = {}
        self._are_goals_said = False
        self._ros: Rcl | None = None
        self._cancel: Any = None
        self._complaints: set[str] = set()
        self._is_over = False
        self._death = death

    def run(self) -> None:
        """Watches until the bridge ends or says that nothing is left to do."""
        try:
            self._watch()
        finally:
            if self._ros is not None:
                self._ros.close()

    def _watch(self) -> None:
        poll = select.poll()
        poll.register(self._channel, select.POLLIN)
        poll.register(self._death, select.POLLIN)
        last, was_halted = steady_ns(), False
        while not self._is_over:
            ready = {descriptor for descriptor, _ in poll.poll(POLL * 1000)}
            now = steady_ns()
            # Who was halted itself, with the bridge perhaps, looks again before it judges; once, as
            # a slow machine must not keep it from that.
            was_halted, last = now - last > 4 * POLL * 1e9 and not was_halted, now
            if self._death in ready:
                # What the bridge has sent last may be a stop, or its goodbye.
                self._read()
                if not self._is_over:
                    # Without patience: a dead bridge will not say its stops any more.
                    self._say(list(self._armed()), goals=True, why="has died")
                return
            if ready:
                self._read()
            if not was_halted:
                self._judge()

    # ------------------------------------------------------------------ what is handed over

    def _read(self) -> None:
        """Reads all that was handed over; what was sent first is there whatever happened next."""
        while not self._is_over and select.select([self._channel], [], [], 0)[0]:
            content = read_frame(self._channel)
            if content is None:  # the bridge is gone, which its process id tells as well
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
                asked = [
                    self._tried(topic["topic"], self._topic, topic) for topic in content["topics"]
                ]
                topics = [topic for topic in asked if topic is not None]
                datagrams = [_datagram(datagram) for datagram in content["datagrams"]]
                refused = len(asked) - len(topics)
                self._stops[content["number"]] = Stops(
                    content["patience"], topics, datagrams, refused
                )
            case "goal":
                if self._cancel is None:
                    library = content["library"]
                    self._cancel = self._tried(_CANCEL, self._support, library, _CANCEL)
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

    def _tried(
        self, subject: str, function: Callable[..., _ResultT], *arguments: Any
    ) -> _ResultT | None:
        """Returns what a function does; None where ROS refuses: all else is to be stopped."""
        try:
            return function(*arguments)
        except RclError as error:
            # It may be tried again soon, and again.
            complaint = f"{subject} cannot be stopped: {error}"
            if complaint not in self._complaints:
                self._complaints.add(complaint)
                _log(complaint)
            return None

    def _topic(self, content: dict[str, Any]) -> Topic:
        support = self._support(content["library"], content["type"])
        data = bytearray.fromhex(content["data"])
        return Topic(content["topic"], support, content["qos"], data, content["stamps"])

    def _support(self, library: str, name: str) -> Any:
        if self._ros is None:
            raise RclError("nothing is known of ROS")
        # A service has no publisher that could prove the library.
        support = self._ros.type(library, *name.split("/"))
        if "/msg/" in name:
            self._ros.check(support)
        return support

    # ------------------------------------------------------------------ when to speak

    def _armed(self) -> list[int]:
        return [number for number in self._stops if self._page.armed[number]]

    def _age(self) -> float:
        """Seconds since the bridge was there; very long before anything was in motion."""
        return _seconds_since(self._page.beat)

    def _judge(self) -> None:
        """Says what is due as the bridge does not run its loop."""
        if self._page.beat != self._missed:
            # It has turned since, however shortly: if it stands still now, that is another time.
            self._said.clear()
            self._are_goals_said = False
        age = self._age()
        due = [number for number in self._armed() if age > self._stops[number].patience]
        # Said once, until the bridge was back: it may stand still for long.
        due = [number for number in due if number not in self._said]
        goals = bool(self._goals) and age > GOAL_PATIENCE and not self._are_goals_said
        if due or goals:
            self._say(due, goals=goals, why="does not run its loop")

    def _say(self, numbers: list[int], *, goals: bool, why: str) -> None:
        """Says stops and cancels goals, until all were told or the bridge is back."""
        # First the mark, then the look at the beat: the bridge does it the other way round, so
        # that one of both always sees the other.
        self._page.taken += 1
        is_halted, beat = not _is_ready(self._death), self._page.beat
        # Back since it was judged: it sees the mark, and says its own stop.
        if is_halted and _seconds_since(beat) <= POLL * 2:
            return
        self._missed = beat
        self._said.update(numbers)
        self._are_goals_said = self._are_goals_said or goals
        stops = [self._stops[number] for number in numbers]
        count = sum(len(stop.topics) + len(stop.datagrams) for stop in stops)
        wanted = dict(self._goals) if goals else {}
        if not (count or wanted):
            return
        _log(f"the {self._name} (process {self._bridge}) {why}: {count} stops, {len(wanted)} goals")
        datagrams = [datagram for stop in stops for datagram in stop.datagrams]
        topics = [topic for stop in stops for topic in stop.topics]
        self._tell(datagrams, topics, wanted, is_halted=is_halted)

    # ------------------------------------------------------------------ speaking

    def _tell(
        self,
        datagrams: list[Datagram],
        topics: list[Topic],
        goals: dict[bytes, str],
        *,
        is_halted: bool,
    ) -> None:
        self._number(datagrams)
        begun = time.monotonic()
        sent = 0
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as outlet:
            # Datagrams first: for topics, subscribers have to be found, which takes time.
            self._send(outlet, datagrams)
            sent = 1
            asked = [self._tried(topic.name, self._topic_state, topic) for topic in topics]
            announcements = [announcement for announcement in asked if announcement is not None]
            cancels = [
                Cancel(canceller, goal, service)
                for goal, service in goals.items()
                if (canceller := self._tried(service, self._canceller, service)) is not None
            ]
            while (past := time.monotonic() - begun) < SOUGHT_FOR:
                if sent < TIMES and past >= sent * AGAIN:
                    self._send(outlet, datagrams)
                    sent += 1
                # After the first while, only where nobody has heard it so far.
                wanting = [
                    announcement
                    for announcement in announcements
                    if past < SAID_FOR
                    or self._tried(announcement.topic.name, self._is_sought, announcement)
                ]
                for announcement in wanting:
                    self._tried(announcement.topic.name, self._publish, announcement)
                if not (wanting or cancels or sent < TIMES):
                    break
                cancels = [
                    cancel
                    for cancel in cancels
                    if not self._tried(cancel.service, self._is_cancelled, cancel)
                ]
                if is_halted and self._age() <= POLL * 2:
                    break  # the bridge lives, and from here on its word counts
                time.sleep(_PAUSE)
        for announcement in announcements:
            self._tried(announcement.topic.name, self._known_ros.destroy, announcement.publisher)

    def _number(self, datagrams: list[Datagram]) -> None:
        """Numbers datagrams from where the bridge has counted to: those of one way differently."""
        for datagram in datagrams:
            first, content = self._page.numbers[datagram.slot], bytes(datagram.data[:-2])
            begun, contents = self._numbered.get(datagram.slot, (first, []))
            contents = contents if begun == first else []
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

    def _topic_state(self, topic: Topic) -> Told:
        ros = self._known_ros
        # With ours, which the graph may show later: it is nobody else who has begun to speak.
        rivals = ros.publishers(topic.name) + 1
        return Told(ros.publisher(topic.name, topic.support, topic.qos), topic, rivals)

    def _is_sought(self, announcement: Told) -> bool:
        """Whether somebody may still be found who listens, and nobody else has begun to speak."""
        # With more publishers than at first, somebody else has begun to speak.
        return (
            not announcement.times
            and self._known_ros.publishers(announcement.topic.name) <= announcement.rivals
        )

    def _canceller(self, service: str) -> Any:
        if self._cancel is None:
            raise RclError("nothing is known of its cancelling")
        return self._known_ros.canceller(service, self._cancel)

    def _is_cancelled(self, wanted: Cancel) -> bool:
        """Asks once more; for a while, as the server may not have found the asker yet."""
        now = time.monotonic()
        if now - wanted.last >= AGAIN and self._known_ros.cancel(wanted.canceller, wanted.goal):
            wanted.first, wanted.last = wanted.first or now, now
        return wanted.first > 0 and now - wanted.first >= SAID_FOR

    def _publish(self, announcement: Told) -> None:
        """Publishes a stop once more if a subscriber may not have it."""
        subscriber_count = self._known_ros.subscribers(announcement.publisher)
        # Nothing tells which subscribers have it: when their number changes, one may not.
        times, now = announcement.times.get(subscriber_count, 0), time.monotonic()
        if not subscriber_count or times >= TIMES or (times and now - announcement.last < AGAIN):
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
    # It ends with its bridge, by itself: signals of a terminal or a service manager are for that.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    with socket.socket(fileno=int(channel)) as own:
        try:
            Guardian(own, Page.at(int(page)), int(death), name, int(bridge)).run()
        except RclError as error:
            _log(f"cannot speak ROS: {error}")
            return EXIT_OF_ROS
    return 0
