"""A capture becomes an MCAP file: topics by the maps of a model, and JAUS messages where wanted."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from jausml.live.recording.captured import CapturedMessages

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.live.recording.captured import JausMessage, JausWriter
    from jausml.live.recording.mcap_files import McapFile
    from jausml.live.recording.translating import Translator
    from jausml.live.traffic.frames import Datagram


class CaptureReplay:
    """The way of a capture into a file."""

    def __init__(
        self, translator: Translator, file: McapFile, jaus: JausWriter | None = None
    ) -> None:
        """Has read nothing yet.

        Args:
            jaus: What writes the JAUS messages too; None leaves them out.
        """
        self.captured = CapturedMessages()
        self.topics: Counter[str] = Counter()
        self.sources: dict[str, set[str]] = {}
        self._translator = translator
        self._file = file
        self._jaus = jaus

    def run(self, datagrams: Iterable[Datagram]) -> None:
        """Writes what becomes of datagrams."""
        for found in self._translator.translate(self._messages(datagrams)):
            for topic in found.route.topics:
                channel = self._file.ros_channel(topic.name, topic.type, topic.definition)
                self._file.write(channel, found.time, found.data)
                self.topics[topic.name] += 1
                self.sources.setdefault(topic.name, set()).add(found.source)

    def _messages(self, datagrams: Iterable[Datagram]) -> Iterator[JausMessage]:
        for message, packet in self.captured.read(datagrams):
            if self._jaus is not None:
                self._jaus.write(self._file, message, packet)
            yield message
