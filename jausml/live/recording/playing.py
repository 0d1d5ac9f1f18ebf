"""Reader of a whole recording, with the time of each message since its beginning."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jausml.live.recording.mcap_files import NANO, RecordingError, need_library
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.recording.ros_values import RosReader

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mcap.records import Schema

    from jausml.live.recording.mcap_files import Found


JAUS_TOPICS = "/jaus/"  # how the topics of JAUS messages begin (`jausml record`)


class PlayedRecording:
    """An MCAP file, whose messages are read in their order.

    Attributes:
        fault: The parts that cannot be read, in words; empty for none.
        duration: Seconds from the first message to the last.
    """

    def __init__(self, path: str) -> None:
        """Opens nothing before `read`."""
        self.fault, self.duration = "", 0.0
        self._path = path
        self._readers: dict[tuple[str, bytes], RosReader | str] = {}

    def read(self) -> Iterator[tuple[float, float, Found]]:
        """Yields, for each message, the share of the file read, its time in seconds, and itself.

        Raises:
            RecordingError: It cannot be opened, is no MCAP file, or no part of it can be read.
        """
        need_library()
        recording = McapRecording(self._path)
        length, first = recording.length(), None
        for record in recording.messages():
            time = record[2].log_time
            first = time if first is None else first
            self.duration = max(self.duration, (time - first) / NANO)  # in order, always
            yield min(1.0, self.duration / length) if length else 0.0, self.duration, record
        if first is None:
            raise RecordingError(f"{self._path} has no messages")
        if recording.fault:
            reached = f"it was read up to {self.duration:.3f} s"
            self.fault = f"the file is damaged: {recording.fault}; {reached}"

    def value_of(self, record: Found) -> dict[str, Any]:
        """Returns the fields of a message.

        Raises:
            RecordingError: They cannot be decoded.
        """
        schema, channel, message = record
        if channel.message_encoding == "json":
            try:
                value = json.loads(message.data)
            except (ValueError, RecursionError) as error:
                raise RecordingError(f"a message of {channel.topic} is no JSON") from error
            return value if isinstance(value, dict) else {"value": value}
        if channel.message_encoding != "cdr" or schema is None:
            raise RecordingError(f"{channel.topic} is in {channel.message_encoding or 'no'} form")
        reader = self._reader(schema)
        return reader.read(message.data)

    def _reader(self, schema: Schema) -> RosReader:
        key = schema.name, schema.data
        if key not in self._readers:
            try:
                self._readers[key] = RosReader(schema.name, schema.data.decode("utf-8", "replace"))
            except RecordingError as error:
                self._readers[key] = str(error)
        reader = self._readers[key]
        if isinstance(reader, str):
            raise RecordingError(reader)
        return reader
