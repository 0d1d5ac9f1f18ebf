"""Both sides of a running system into one file, and the JAUS side beside it as a capture."""

from __future__ import annotations

import time
from collections import Counter
from contextlib import contextmanager
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING, Any

from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import bridge, system
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.live.recording.captured import CapturedMessages, JausWriter
from jausml.live.recording.schemas import installed_definition, modelled_definition

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from jausml.language.metamodel.classes import ros
    from jausml.language.model import Model
    from jausml.live.messages import Catalogue
    from jausml.live.recording.files import RecordingFiles
    from jausml.live.recording.mcap_files import TrafficFilter
    from jausml.live.traffic.captures import CapturedFrame
    from jausml.live.traffic.frames import Datagram

CALLS = "/_service_event"
"""What follows the name of a service in the topic of its calls, where it is introspected."""

DIAGNOSTICS = "/diagnostics"
"""Where bridges tell how they are, with the accounts of connections and peers."""

_ACTION = ("/_action/feedback", "/_action/status")


def topics_of(model: Model) -> dict[str, ros.MessageType | None]:
    """Returns the topics of a model, each with its type.

    So are those on which services and actions are seen, and those on which bridges tell what
    became of all messages. Their types are known where they are installed alone, and are none of
    the model.
    """
    found: dict[str, ros.MessageType | None] = {}
    for whole in model.instances(system.System, library=False):
        for end in endpoints([*whole.bridges, *whole.nodes]):
            found[end.topic] = end.type
        for owner in whole.bridges:
            found.update((each, None) for each in (DIAGNOSTICS, *_seen_calls(owner)))
    return found


def _seen_calls(owner: bridge.Bridge) -> Iterator[str]:
    """Yields the topics on which others see what services and actions of a bridge do."""
    for call in owner.serviceConnections:
        if call.service is not None:
            yield _full(owner, call.service) + CALLS
    for action in owner.actionConnections:
        if action.action is not None:
            yield from (_full(owner, action.action) + each for each in _ACTION)


def _full(owner: bridge.Bridge, name: str) -> str:
    return resolve_topic(name, owner.namespace or "", owner.name or "")


class Recorder:
    """What comes from both sides, each on its thread, and a third that gives it to the disk.

    Attributes:
        fault: Why files cannot be written any more; None while they can.
        lost: How many frames and messages came after that.
        reached: When the disk had all that had come, by the clock; None for never.
    """

    def __init__(
        self,
        parts: RecordingFiles,
        catalogue: Catalogue,
        types: Mapping[str, ros.MessageType | None],
        selection: TrafficFilter,
    ) -> None:
        """Has recorded nothing yet."""
        self.captured = CapturedMessages()
        self.topics: Counter[str] = Counter()
        self.jaus = JausWriter(catalogue)
        self.undefined: set[str] = set()
        self.fault: OSError | None = None
        self.lost = 0
        self.reached: float | None = None
        self._parts = parts
        self._selection = selection
        self._types = types
        self._installation = Installation()
        self._known: dict[tuple[str, str], str] = {}
        self._lock = Lock()

    @contextmanager
    def kept(self, period: float, begun: Callable[[], None]) -> Iterator[None]:
        """Gives the disk what has come, again and again, and ends the files."""
        ended = Event()
        keeper = Thread(target=self._keep, args=(period, ended, begun), daemon=True)
        keeper.start()
        try:
            yield
        finally:
            ended.set()
            keeper.join()
            self._write(self._parts.current.close)
            if self.fault is not None:
                self._parts.current.give_up()

    def take_frame(self, frame: CapturedFrame, datagram: Datagram | None) -> None:
        """Writes a frame, and what it says.

        Args:
            datagram: The datagram that it completes; None for a part of one.
        """
        if datagram is not None and not self._selection.wants(datagram):
            return
        self._write(self._write_frame, frame, datagram)

    def take_topic(self, topic: str, kind: str, data: bytes, heard: int, published: int) -> None:
        """Writes a message of ROS."""
        self._write(self._write_topic, topic, kind, data, heard, published or heard)

    def _write_frame(self, frame: CapturedFrame, datagram: Datagram | None) -> None:
        self._parts.current.capture.write(frame)
        if datagram is not None:
            for message, packet in self.captured.read([datagram]):
                self.jaus.write(self._parts.current.file, message, packet)

    def _write_topic(self, topic: str, kind: str, data: bytes, heard: int, published: int) -> None:
        definition = self._definition(topic, kind)
        if definition:
            file = self._parts.current.file
            file.write(file.ros_channel(topic, kind, definition), heard, data, published)
            self.topics[topic] += 1

    def _write(self, do: Callable[..., None], *arguments: Any) -> None:
        """Does something with the files, alone; what they do not take any more is counted."""
        with self._lock:
            if self.fault is not None:
                self.lost += 1
                return
            try:
                do(*arguments)
            except OSError as error:
                self.fault = error
                self.lost += 1

    def _keep(self, period: float, ended: Event, begun: Callable[[], None]) -> None:
        while not ended.wait(period) and self.fault is None:
            now = time.time()
            self._write(self._parts.current.flush)
            try:
                self._parts.current.sync()  # that may take long, and nobody has to wait for it
            except OSError as error:
                self.fault = error
            else:
                self.reached = now
                self._write(self._turn, begun)

    def _turn(self, begun: Callable[[], None]) -> None:
        if self._parts.turn():
            begun()

    def _definition(self, topic: str, kind: str) -> str:
        """Returns the definition of the type of a topic, empty where nobody has one."""
        key = (topic, kind)
        if key not in self._known:
            found = installed_definition(kind, self._installation)
            modelled = self._types.get(topic)
            if not found and modelled is not None:
                found = modelled_definition(modelled)
            self._known[key] = found
            if not self._known[key]:
                self.undefined.add(topic)
        return self._known[key]
