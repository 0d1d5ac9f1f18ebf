"""MCAP files, written: topics of ROS as rosbag2 has them, and JAUS messages as JSON."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias, TypeVar

from jausml import __version__, installing
from jausml.live.recording.mcap_records import END
from jausml.live.recording.schemas import schema_of
from jausml.live.traffic.observing import ends_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from mcap.records import Channel, Message, Schema

    from jausml.live.messages import MessageEntry
    from jausml.live.traffic.frames import Datagram

# A message with its channel, and the schema of that.
Found: TypeAlias = "tuple[Schema | None, Channel, Message]"

T = TypeVar("T")


@dataclass(frozen=True)
class TrafficFilter:
    """Patterns, in which `*` stands for any text; without one, all is selected."""

    topics: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    components: tuple[str, ...] = ()

    def wants_topic(self, name: str) -> bool:
        """Whether a topic is recorded."""
        return _fits(name, self.topics or ("*",)) and not _fits(name, self.excluded)

    def wants(self, datagram: Datagram) -> bool:
        """Whether a datagram is recorded; one that cannot be read is."""
        if not self.components:
            return True
        ends = ends_of(datagram)
        return not ends or any(_fits(end, self.components) for end in ends)


def _fits(name: str, patterns: tuple[str, ...]) -> bool:
    return any(fnmatchcase(name, pattern) for pattern in patterns)


@dataclass(frozen=True)
class TimeSpan:
    """A part of a recording.

    Attributes:
        start: Seconds after the first message.
        duration: Seconds from there on, None to the end.
    """

    start: float = 0.0
    duration: float | None = None

    def of(self, messages: Iterable[T], time_of: Callable[[T], int | None]) -> Iterator[T]:
        """Yields the messages within the span.

        Args:
            time_of: The time of each in nanoseconds, None where nobody told: these are in it.
        """
        begin: int | None = None
        for message in messages:
            time = time_of(message)
            if time is not None:
                begin = time if begin is None else begin
                since = (time - begin) / NANO - self.start
                if self.duration is not None and since >= self.duration:
                    return
                if since < 0:
                    continue
            yield message

    def of_length(self, length: float) -> float:
        """Returns how many seconds of it there are in a recording of so many."""
        left = max(0.0, length - self.start)
        return left if self.duration is None else min(left, self.duration)


WHOLE = TimeSpan()  # all of a recording


# Profile of files in which all channels are of ROS (MCAP, well-known profiles).
ROS_PROFILE = "ros2"

LIBRARY = "jausml "  # how the name begins of who wrote a file, before the version

COMPRESSIONS = ("zstd", "lz4", "none")  # how chunks may be compressed, the usual one first

NANO = 10**9  # nanoseconds of a second

CDR = "cdr"  # encoding of messages of ROS


class RecordingError(Exception):
    """A recording that cannot be made or replayed; the text says why."""


def need_library() -> None:
    """Raises RecordingError where MCAP files cannot be written."""
    try:
        import mcap.writer  # noqa: F401, PLC0415 - an extra: jausml[record]
    except ImportError as error:
        raise RecordingError(f"{error.name} is missing: {installing.command('record')}") from error


class McapFile:
    """An MCAP file that is being written; it has its index once it is closed."""

    def __init__(
        self, stream: BinaryIO, *, has_jaus: bool, compression: str = COMPRESSIONS[0]
    ) -> None:
        """Begins a file."""
        need_library()
        from mcap.writer import CompressionType, Writer  # noqa: PLC0415 - an extra

        self.count = 0
        self._stream = stream
        self._writer = Writer(stream, compression=CompressionType[compression.upper()])
        self._writer.start("" if has_jaus else ROS_PROFILE, f"{LIBRARY}{__version__}")
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._channels: dict[tuple[object, ...], int] = {}
        self._of_jaus: dict[tuple[str, MessageEntry], int] = {}  # a schema takes long to make

    def __enter__(self) -> McapFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Writes the end of the file; without it, tools read it slowly or not at all."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def flush(self) -> None:
        """Ends a chunk, so that all messages so far can be read whatever happens next.

        An end without a summary stands behind it, until more is written: all readers open a file
        whose recorder was killed, and there is room for it on a disk that is full.
        """
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._stream.write(END)
        self._stream.flush()
        self._stream.seek(-len(END), io.SEEK_CUR)

    def ros_channel(
        self, topic: str, type_name: str, definition: str, offer: Mapping[str, str] | None = None
    ) -> int:
        """Returns the channel of a topic.

        Args:
            offer: What rosbag2 notes of the publishers of a topic: their quality of service.
        """
        schema = self._schema(type_name, "ros2msg", definition.encode())
        return self._channel(topic, schema, CDR, offer or {})

    def jaus_channel(self, source: str, entry: MessageEntry) -> int:
        """Returns the channel of a JAUS message of one component."""
        key = (source, entry)
        if key not in self._of_jaus:
            text = json.dumps(schema_of(entry)).encode()
            schema = self._schema(f"jaus.{entry.name}.{entry.code_text}", "jsonschema", text)
            self._of_jaus[key] = self._channel(f"/jaus/{source}/{entry.name}", schema, "json", {})
        return self._of_jaus[key]

    def write(self, channel: int, time: int, data: bytes, published: int | None = None) -> None:
        """Writes a message."""
        self._writer.add_message(channel, time, data, time if published is None else published)
        self.count += 1

    def write_json(self, channel: int, time: int, value: dict[str, Any]) -> None:
        """Writes a message in JSON."""
        try:
            text = json.dumps(value, allow_nan=False)
        except ValueError:
            text = json.dumps(json.loads(json.dumps(value), parse_constant=lambda _: None))
        self.write(channel, time, text.encode())

    def copy(self, schema: Schema | None, channel: Channel, message: Message) -> None:
        """Writes a message of another file."""
        kind = 0 if schema is None else self._schema(schema.name, schema.encoding, schema.data)
        own = self._channel(channel.topic, kind, channel.message_encoding, channel.metadata)
        times = (message.log_time, message.data, message.publish_time, message.sequence)
        self._writer.add_message(own, *times)
        self.count += 1

    def _schema(self, name: str, encoding: str, definition: bytes) -> int:
        key = (name, encoding, definition)
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(*key)
        return self._schemas[key]

    def _channel(self, topic: str, schema: int, encoding: str, metadata: Mapping[str, str]) -> int:
        key = (topic, schema, encoding, tuple(metadata.items()))
        if key not in self._channels:
            channel_id = self._writer.register_channel(topic, encoding, schema, dict(metadata))
            self._channels[key] = channel_id
        return self._channels[key]


def copied(messages: Iterable[Found], stream: BinaryIO, *, ros_only: bool) -> int:
    """Writes messages into a file with an index; returns how many."""
    file = McapFile(stream, has_jaus=not ros_only)
    for message in messages:
        if not ros_only or message[1].message_encoding == CDR:
            file.copy(*message)
    file.close()
    return file.count
