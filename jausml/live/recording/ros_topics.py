"""Subscriber of ROS topics for recordings, which takes serialized messages. Needs rclpy."""

from __future__ import annotations

import time
from collections import Counter
from threading import Event
from typing import TYPE_CHECKING, Any

from jausml.live.recording.mcap_files import NANO, RecordingError
from jausml.live.ros.node import QuietNode, RosFault, message_class
from jausml.live.ros.running import offered_profile

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence

    from jausml.live.recording.mcap_files import TrafficFilter

    Take = Callable[[str, str, bytes, int, int], None]
    """Takes topic, type, message, and when it was heard and published, in nanoseconds."""

_LOOK = 0.1  # seconds from one look for publishers to the next

# Seconds after which a node knows who publishes, after which publishers know a subscription, and
# for which both is waited at most. Where multicast does not pass, a participant of DDS hears of
# others only when they announce themselves again, every 3 seconds.
_KNOWN, _MATCHED, _PATIENCE = 3.2, 0.5, 6.0

_DEPTH = 1000


# A quality of service as rosbag2 writes it, since version 9 of its metadata.
_PROFILE = """\
- history: {history}
  depth: {depth}
  reliability: {reliability}
  durability: {durability}
  deadline:
    sec: {deadline[0]}
    nsec: {deadline[1]}
  lifespan:
    sec: {lifespan[0]}
    nsec: {lifespan[1]}
  liveliness: {liveliness}
  liveliness_lease_duration:
    sec: {liveliness_lease_duration[0]}
    nsec: {liveliness_lease_duration[1]}
  avoid_ros_namespace_conventions: {avoid_ros_namespace_conventions}
"""

_POLICIES = ("history", "reliability", "durability", "liveliness")
_DURATIONS = ("deadline", "lifespan", "liveliness_lease_duration")


def _offer(publishers: Sequence[Any]) -> dict[str, str]:
    """Returns the metadata that rosbag2 writes on the publishers of a topic."""
    profiles = [publisher.qos_profile for publisher in publishers]
    hashes = {
        str(publisher.topic_type_hash)
        for publisher in publishers
        if publisher.topic_type_hash.version > 0
    }
    return {
        "offered_qos_profiles": "".join(map(_profile_text, profiles)).rstrip("\n"),
        "topic_type_hash": hashes.pop() if len(hashes) == 1 else "",
    }


def _profile_text(profile: Any) -> str:
    durations = {
        duration: divmod(getattr(profile, duration).nanoseconds, NANO) for duration in _DURATIONS
    }
    avoids = "true" if profile.avoid_ros_namespace_conventions else "false"
    return _PROFILE.format(
        depth=profile.depth,
        avoid_ros_namespace_conventions=avoids,
        **{policy: getattr(profile, policy).name.lower() for policy in _POLICIES},
        **durations,
    )


def _drop(*_: object) -> None:
    """Nobody takes messages yet."""


class RosTopics:
    """A node that subscribes to all selected topics, with the offered quality of service.

    Attributes:
        heard: Subscriptions by topic.
        missing: Topics whose type is not installed, with the type.
        mixed: Topics that are published as several types, with these; of one, if any, it hears.
        wanted: Full names of the topics to record, None for all of the selection.
        lost: Numbers of lost messages by topic, by gaps of their sequence numbers.
        offers: Metadata of rosbag2 on the publishers by topic.
        early: Numbers of messages by topic that were published before the first one that came, by
            its sequence number; only of topics that appeared after the beginning.
    """

    def __init__(self, selection: TrafficFilter) -> None:
        """Listens from `open` on."""
        self.lost: Counter[str] = Counter()
        self.early: Counter[str] = Counter()
        self.heard: dict[str, Any] = {}
        self.missing: dict[str, str] = {}
        self.mixed: dict[str, list[str]] = {}
        self.offers: dict[str, dict[str, str]] = {}
        self.wanted: frozenset[str] | None = None
        self._selection = selection
        self._latched: set[str] = set()
        self._known: set[str] = set()
        self._repeats = False
        self._take: Take = _drop
        self._quiet = QuietNode("record")
        self._opened = self._subscribed = 0.0
        self._is_settled = Event()

    def open(self) -> None:
        """Creates the node (`RecordingError`: there is no ROS)."""
        try:
            self._quiet.open()
        except RosFault as error:
            raise RecordingError(str(error)) from error
        self._opened = time.monotonic()

    def begin(self, wanted: Collection[str] | None, take: Take) -> None:
        """Searches for publishers from now on; returns when it has subscribed to present ones."""
        if wanted is not None:
            self.wanted = frozenset(filter(self._selection.wants_topic, wanted))
        self._take = take
        self._quiet.node.create_timer(_LOOK, self._look)
        self._quiet.spin()
        self._is_settled.wait(_PATIENCE)

    def unpublished(self) -> list[str]:
        """Returns the wanted topics without a known publisher, which it still waits for."""
        known = {*self.heard, *self.missing, *self.mixed}
        return sorted((self.wanted or frozenset()) - known)

    def repeat_latched(self) -> None:
        """Subscribes anew to latched topics, so that their latest messages come again.

        So each of several files has them. Any thread may call it.
        """
        self._repeats = True

    def stop(self) -> None:
        """Ends the node."""
        self._quiet.close()

    def _look(self) -> None:
        if self._repeats:
            self._repeats = False
            for topic in self._latched:  # who subscribes anew is sent them by the middleware
                self._quiet.node.destroy_subscription(self.heard.pop(topic))
            self._latched.clear()
        for topic, kind in self._published():
            if topic not in self.heard and topic not in self.missing:
                self._subscribe(topic, kind)
        now = time.monotonic()
        if now - self._opened > _KNOWN and now - self._subscribed > _MATCHED:
            self._is_settled.set()

    def _published(self) -> Iterator[tuple[str, str]]:
        for topic, all_kinds in self._quiet.node.get_topic_names_and_types():
            if not self._wants(topic):
                continue
            kinds = all_kinds if len(all_kinds) == 1 else self._published_kinds(topic)
            if len(kinds) > 1:
                self.mixed[topic] = kinds
            elif kinds:
                yield topic, kinds[0]

    def _published_kinds(self, topic: str) -> list[str]:
        """Returns the types of the publishers of a topic, without those of its subscribers."""
        publishers = self._quiet.node.get_publishers_info_by_topic(topic)
        return sorted({publisher.topic_type for publisher in publishers})

    def _wants(self, topic: str) -> bool:
        if self.wanted is not None:
            return topic in self.wanted
        return self._selection.wants_topic(topic)

    def _subscribe(self, topic: str, kind: str) -> None:
        from jausml.runtime.bridge.ros.parameters import qos_of  # noqa: PLC0415

        publishers = self._quiet.node.get_publishers_info_by_topic(topic)
        offered = [qos_of(publisher.qos_profile) for publisher in publishers]
        if not offered:
            return  # only subscribers have the topic
        cls = message_class(kind)
        if cls is None:
            self.missing[topic] = kind
            return
        self.offers[topic] = _offer(publishers)
        asked = offered_profile(offered, _DEPTH)
        if qos_of(asked).durability == "transient_local":
            self._latched.add(topic)
        is_late = self._is_settled.is_set() and topic not in self._known
        self._known.add(topic)
        self.heard[topic] = self._quiet.node.create_subscription(
            cls, topic, self._noting(topic, kind, is_late=is_late), asked, raw=True
        )
        self._subscribed = time.monotonic()

    def _noting(self, topic: str, kind: str, *, is_late: bool) -> Callable[[bytes, Any], None]:
        """Returns the callback of a topic, which counts lost messages."""
        expected = None

        def note(data: bytes, info: Any) -> None:
            nonlocal expected
            number = info.get("publication_sequence_number")
            if number is not None:
                # A message does not name its publisher: gaps count for a single publisher only.
                gap = number - (1 if expected is None else expected)
                is_told = expected is not None or is_late
                if gap > 0 and is_told and self._quiet.node.count_publishers(topic) == 1:
                    (self.early if expected is None else self.lost)[topic] += gap
                expected = number + 1
            self._take(topic, kind, bytes(data), time.time_ns(), info["source_timestamp"])

        return note
