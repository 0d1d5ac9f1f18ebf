"""Writer of MCAP files: topics of ROS as rosbag2 writes them, and JAUS messages as JSON."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias, TypeVar

from jausml import __version__, installing
from jausml.live.messages.errors import MessageError
from jausml.live.recording.mcap_records import END
from jausml.live.recording.schemas import schema_of
from jausml.live.traffic.observing import ends_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from mcap.records import Channel, Message, Schema

    from jausml.live.messages import MessageEntry
    from jausml.live.traffic.frames import Datagram


# A message with its channel, and the schema of the channel.
Found: TypeAlias = "tuple[Schema | None, Channel, Message]"

T = TypeVar("T")

ROS_PROFILE = "ros2"  # profile of files with channels of ROS only (MCAP, well-known profiles)
LIBRARY = "jausml "  # the name of the writer of a file, before the version
COMPRESSIONS = ("zstd", "lz4", "none")  # of chunks, the default first
NANO = 10**9  # nanoseconds of a second
CDR = "cdr"  # encoding of messages of ROS

# Channels of JAUS messages in a file, which numbers channels with 16 bits: forged senders must
# leave some for topics.
MOST_OF_JAUS = 60_000


@dataclass(frozen=True)
class TrafficFilter:
    """Patterns of names of topics and JAUS ids, in which `*` stands for any text.

    Without patterns, all topics and components are selected.
    """

    topics: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    components: tuple[str, ...] = ()

    def wants_topic(self, name: str) -> bool:
        """Returns whether a topic is selected."""
        return _fits(name, self.topics or ("*",)) and not _fits(name, self.excluded)

    def wants(self, datagram: Datagram) -> bool:
        """Returns whether a datagram is selected, as is one that cannot be read."""
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
        duration: Seconds from there on, None for all.
    """

    start: float = 0.0
    duration: float | None = None

    def of(self, messages: Iterable[T], time_of: Callable[[T], int | None]) -> Iterator[T]:
        """Yields the messages within the span.

        Args:
            time_of: Returns the time in nanoseconds; None selects a message.
        """
        begin: int | None = None
        for message in messages:
            time = time_of(message)
            if time is not None:
                begin = time if begin is None else begin
                since = (time - begin) / NANO - self.start
                if self.duration is not None and since >= self.duration:
                    return
                # After a clock was set back times may lie before that of the first message.
                if since < 0 < self.start:
                    continue
            yield message

    def of_length(self, length: float) -> float:
        """Returns the seconds of the span in a recording of `length` seconds."""
        left = max(0.0, length - self.start)
        return left if self.duration is None else min(left, self.duration)


WHOLE = TimeSpan()  # all of a recording


class RecordingError(Exception):
    """A recording cannot be written, read or replayed; the text says why."""


def need_library() -> None:
    """Raises `RecordingError` if the library of MCAP is missing."""
    try:
        import mcap.writer  # noqa: F401, PLC0415 - an extra: jausml[record]
    except ImportError as error:
        raise RecordingError(f"{error.name} is missing: {installing.command('record')}") from error


class McapFile:
    """An MCAP file that is being written; `close` writes its index."""

    def __init__(
        self, stream: BinaryIO, *, has_jaus: bool, compression: str = COMPRESSIONS[0]
    ) -> None:
        """Writes the head of a file.

        Args:
            has_jaus: Whether there will be JAUS messages.
            compression: One of `COMPRESSIONS`.
        """
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
        """Writes index and end; without them, tools read a file slowly or not at all."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def flush(self) -> None:
        """Ends a chunk, so that all messages so far can be read also after a crash.

        An end without a summary follows it, until more is written: so all readers can open the file
        of a killed recorder, and a full disk has room for the end.
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
            definition: The definition of the type, as `ros2msg` has it.
            offer: Metadata of rosbag2 on the publishers, such as their quality of service.
        """
        schema = self._schema(type_name, "ros2msg", definition.encode())
        return self._channel(topic, schema, CDR, offer or {})

    def jaus_channel(self, source: str, entry: MessageEntry) -> int:
        """Returns the channel of a JAUS message of a component; raises MessageError beyond all."""
        key = (source, entry)
        if key not in self._of_jaus:
            if len(self._of_jaus) >= MOST_OF_JAUS:
                raise MessageError(f"the file has messages of {MOST_OF_JAUS} kinds and senders")
            text = json.dumps(schema_of(entry)).encode()
            schema = self._schema(f"jaus.{entry.name}.{entry.code_text}", "jsonschema", text)
            self._of_jaus[key] = self._channel(f"/jaus/{source}/{entry.name}", schema, "json", {})
        return self._of_jaus[key]

    def write(self, channel: int, time: int, data: bytes, published: int | None = None) -> None:
        """Writes a message (`time`, `published`: nanoseconds since 1970)."""
        self._writer.add_message(channel, time, data, time if published is None else published)
        self.count += 1

    def write_json(self, channel: int, time: int, value: dict[str, Any]) -> None:
        """Writes a message as JSON; numbers that are not finite become null."""
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
    """Writes messages into a file with an index; returns their number."""
    file = McapFile(stream, has_jaus=not ros_only)
    for message in messages:
        if not ros_only or message[1].message_encoding == CDR:
            file.copy(*message)
    file.close()
    return file.count
