"""Recordings of ROS, read: MCAP files, and bags of rosbag2 in any storage."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from jausml import installing
from jausml.live.recording.mcap_files import WHOLE, McapRecording, RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.recording.mcap_files import Found, TimeSpan

MCAP, SQLITE = ".mcap", ".db3"
_CDR = "cdr"
_METADATA = "metadata.yaml"
_NUMBERS = re.compile("[0-9]+")


@dataclass(frozen=True)
class RosMessage:
    """A message of ROS of a recording."""

    topic: str
    type: str
    time: int
    data: bytes


def is_bag(path: str) -> bool:
    """Returns whether a path is that of a recording of ROS, by its name or as a folder."""
    return path.endswith((MCAP, SQLITE)) or Path(path).is_dir()


class Bag:
    """A recording.

    Attributes:
        others: How many messages are not of ROS, by the encoding that they have.
        fault: Why reading ended before the end, once all was read; empty for a whole recording.
        reached: Time of the latest message so far, in nanoseconds since 1970; None for none.
    """

    def __init__(self, path: str, span: TimeSpan = WHOLE) -> None:
        """Names a recording.

        Args:
            path: An MCAP file, or a bag of rosbag2: its folder, or the file of its storage. In a
                folder that has no metadata yet, since its recorder was cut off, all MCAP files.
        """
        self.others: Counter[str] = Counter()
        self.fault = ""
        self.reached: int | None = None
        self._path = path
        self._span = span

    def length(self) -> float | None:
        """Returns the seconds from the first message to the last of the part, None if unknown."""
        if not self._path.endswith(MCAP):
            return None
        try:
            return McapRecording(self._path, self._span).length()
        except (ImportError, RecordingError):
            return None  # who reads it is told

    def messages(self) -> Iterator[RosMessage]:
        """Yields messages of ROS in the order of their times, of a file that was cut off all."""
        self.others.clear()
        self.fault = ""
        files = _mcap_files(self._path)
        read = partial(self._mcap, files) if files else self._bag
        try:
            yield from read()
        except ImportError as error:
            raise RecordingError(
                f"{error.name} is missing: {installing.command('record')}"
            ) from error
        except RecordingError:
            raise
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error
        except Exception as error:  # the libraries raise anything on bytes that are no recording
            reason = str(error) or type(error).__name__
            raise RecordingError(f"{self._path} cannot be read: {reason}") from error

    def _mcap(self, paths: list[str]) -> Iterator[RosMessage]:
        found = self._span.of(self._found(paths), lambda each: each[2].log_time)
        for schema, channel, message in found:
            if schema is None or channel.message_encoding != _CDR:
                self.others[channel.message_encoding] += 1
                continue
            yield RosMessage(channel.topic, schema.name, message.log_time, message.data)

    def _found(self, paths: list[str]) -> Iterator[Found]:
        """Yields what stands in files, one after the other."""
        for path in paths:
            recording = McapRecording(path)
            try:
                for each in recording.messages():
                    self.reached = recording.reached
                    yield each
                self.fault = recording.fault or self.fault
            except RecordingError as error:
                if self.reached is None and path == paths[-1]:
                    raise
                self.fault = str(error)

    def _bag(self) -> Iterator[RosMessage]:
        from rosbags.rosbag2 import Reader  # noqa: PLC0415 - an extra

        with Reader(self._path) as reader:
            for connection, time, data in self._span.of(reader.messages(), lambda each: each[1]):
                yield RosMessage(connection.topic, connection.msgtype, time, bytes(data))


def _mcap_files(path: str) -> list[str]:
    """Returns the MCAP files that are read without what rosbag2 tells of them; none for a bag."""
    if path.endswith(MCAP) and not Path(path).is_dir():
        return [path]
    if not Path(path).is_dir() or (Path(path) / _METADATA).exists():
        return []
    found = [str(each) for each in Path(path).glob("*" + MCAP)]
    return sorted(found, key=lambda each: [int(number) for number in _NUMBERS.findall(each)])
