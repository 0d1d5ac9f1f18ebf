"""A recording of which any moment is looked at: messages of topics before and between times."""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import ExitStack, closing
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

from jausml.language.model.inputs import open_input
from jausml.live.recording.mcap_files import RecordingError, copied, need_library
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.recording.ros_values import RosReader

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from mcap.reader import SeekingReader
    from mcap.records import Schema

    from jausml.live.recording.mcap_files import Found

_NANO = 10**9
_BEFORE = -1.0
"""Seconds since the beginning, before all messages."""

JAUS_TOPICS = "/jaus/"
"""How the topics of JAUS messages begin (`jausml record`)."""


class SeekableRecording:
    """An MCAP file of which messages are found by their times, in seconds since its beginning.

    What is read of a file without an index, or of one that is damaged, is copied into a temporary
    file that has one. Its methods may be called by any thread. Another process may read it, and
    send it here to be opened.

    Attributes:
        fault: What of the file cannot be read; empty for a whole one.
        duration: Seconds from the first message to the last.
        topics: How many messages there are of each topic.
    """

    def __init__(self, path: str) -> None:
        """Names a file; `read` comes next, and then `open`."""
        self.fault, self.duration = "", 0.0
        self.topics: dict[str, int] = {}
        self._path = path
        self._copy = ""
        self._lock = Lock()
        self._file: SeekingReader | None = None
        self._closing = ExitStack()
        self._begin = 0
        self._readers: dict[tuple[str, bytes], RosReader | str] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Returns what is known of it; nothing is open where it arrives."""
        known = ("fault", "duration", "topics", "_path", "_copy", "_begin")
        return {name: getattr(self, name) for name in known}

    def __setstate__(self, known: dict[str, Any]) -> None:
        """Becomes one that was read elsewhere."""
        SeekableRecording.__init__(self, known["_path"])
        vars(self).update(known)

    def read(self) -> Iterator[tuple[float, float, Found]]:
        """Reads all of the file; yields how much of it is read, up to 1, and time and message.

        Raises:
            RecordingError: It cannot be opened, is no such file, or nothing of it can be read.
        """
        need_library()
        recording = McapRecording(self._path)
        length, first = recording.length(), None
        for found in recording.messages():
            time, topic = found[2].log_time, found[1].topic
            first = time if first is None else first
            self.topics[topic] = self.topics.get(topic, 0) + 1
            self.duration = max(self.duration, (time - first) / _NANO)  # in order, always
            yield min(1.0, self.duration / length) if length else 0.0, self.duration, found
        self._begin = first or 0
        if recording.fault:
            reached = f"it was read up to {self.duration:.3f} s"
            self.fault = f"the file is damaged: {recording.fault}; {reached}"
        if recording.fault or not recording.has_index():
            descriptor, self._copy = tempfile.mkstemp(".mcap")
            with os.fdopen(descriptor, "wb") as stream:
                copied(McapRecording(self._path).messages(), stream, ros_only=False)

    def open(self) -> None:
        """Opens what was read, in which messages are found from then on."""
        from mcap.reader import SeekingReader  # noqa: PLC0415 - an extra

        with ExitStack() as stack:
            if self._copy:
                stack.callback(Path(self._copy).unlink, missing_ok=True)
            self._file = SeekingReader(stack.enter_context(open_input(self._copy or self._path)))
            self._closing = stack.pop_all()

    def close(self) -> None:
        """Closes the file; nothing is found any more."""
        with self._lock:
            self._closing.close()
            self._file = None

    def last(self, topic: str, at: float) -> tuple[float, Found] | None:
        """Returns time and message of the latest of a topic up to a time, None before the first."""
        with closing(self._found(topic, _BEFORE, at, is_backward=True)) as found:
            return next(found, None)

    def between(self, topic: str, start: float, end: float) -> Iterator[tuple[float, Found]]:
        """Yields times and messages of a topic after one time up to another.

        Nothing else is found meanwhile: who asks goes through all of them at once.
        """
        return self._found(topic, start, end)

    def value_of(self, found: Found) -> dict[str, Any]:
        """Returns the fields of a message.

        Raises:
            RecordingError: They cannot be read.
        """
        schema, channel, message = found
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
        found = self._readers[key]
        if isinstance(found, str):
            raise RecordingError(found)
        return found

    def _found(
        self, topic: str, start: float, end: float, *, is_backward: bool = False
    ) -> Generator[tuple[float, Found], None, None]:
        with self._lock:
            if self._file is None:
                raise RecordingError("the recording is closed")
            found = self._file.iter_messages(
                topic,
                starting_after=self._nanoseconds(start),
                ending_at=self._nanoseconds(end),
                reverse=is_backward,
            )
            while True:
                try:
                    each = next(found, None)
                except Exception as error:  # the libraries raise anything on such bytes
                    raise RecordingError(f"{self._path} has changed since it was read") from error
                if each is None:
                    return
                yield (each[2].log_time - self._begin) / _NANO, each

    def _nanoseconds(self, since: float) -> int:
        return self._begin + round(since * _NANO)
