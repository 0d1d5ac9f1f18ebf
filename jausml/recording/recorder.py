"""Both sides of a running system into one file, and the JAUS side beside it as a capture."""

from __future__ import annotations

from collections import Counter
from threading import Lock
from typing import TYPE_CHECKING

from jausml.interfaces import Installation
from jausml.metamodel.classes import system
from jausml.recording.captured import CapturedMessages
from jausml.recording.definitions import installed_definition, modelled_definition
from jausml.recording.from_captures import JausWriter
from jausml.semantics.topics import endpoints

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue
    from jausml.live.traffic.frames import Datagram
    from jausml.model import Model
    from jausml.recording.mcap_writing import McapFile


def topics_of(model: Model) -> dict[str, str]:
    """Returns the topics of a model, each with the definition of its type.

    Args:
        model: The model.
    """
    found = {}
    for whole in (root for root in model.documents[0].roots if isinstance(root, system.System)):
        for end in endpoints([*whole.bridges, *whole.nodes]):
            found[end.topic] = modelled_definition(end.type)
    return found


class Recorder:
    """What comes from both sides, each on its thread.

    Attributes:
        captured: What was found on the side of JAUS.
        topics: How many messages each topic of ROS got.
        jaus: What writes the messages of JAUS.
        undefined: Topics whose type nobody defines here.
    """

    def __init__(self, file: McapFile, catalogue: Catalogue, definitions: dict[str, str]) -> None:
        """Has recorded nothing yet.

        Args:
            file: Where all goes.
            catalogue: What messages of JAUS there are.
            definitions: Definitions of the types of topics, for those that are not installed.
        """
        self.captured = CapturedMessages()
        self.topics: Counter[str] = Counter()
        self.jaus = JausWriter(file, catalogue)
        self.undefined: set[str] = set()
        self._file = file
        self._definitions = definitions
        self._installation = Installation()
        self._channels: dict[str, int | None] = {}
        self._lock = Lock()

    def take_datagram(self, datagram: Datagram) -> None:
        """Writes what a datagram says."""
        with self._lock:
            for message, packet in self.captured.read([datagram]):
                self.jaus.write(message, packet)

    def take_topic(self, topic: str, kind: str, data: bytes, heard: int, published: int) -> None:
        """Writes a message of ROS.

        Args:
            topic: Where it was published.
            kind: Full name of its type.
            data: It, serialized.
            heard: When it came, in nanoseconds since 1970.
            published: When it was sent, by the clock of who did.
        """
        with self._lock:
            if topic not in self._channels:
                self._channels[topic] = self._channel(topic, kind)
            channel = self._channels[topic]
            if channel is not None:
                self._file.write(channel, heard, data, published or heard)
                self.topics[topic] += 1

    def _channel(self, topic: str, kind: str) -> int | None:
        found = installed_definition(kind, self._installation) or self._definitions.get(topic, "")
        if not found:
            self.undefined.add(topic)
            return None
        return self._file.ros_channel(topic, kind, found)
