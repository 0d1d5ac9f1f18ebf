"""MCAP files, read and written.

They are read as far as they go, those that were cut off too, which have no index. What is written
has topics of ROS as rosbag2 has them, and JAUS messages as JSON.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

from jausml import __version__, installing
from jausml.language.model.inputs import open_input
from jausml.live.recording.schemas import schema_of
from jausml.live.traffic.observing import ends_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from mcap.records import Channel, Message, Schema
    from mcap.summary import Summary
    from mcap.writer import Writer
    from typing_extensions import Self

    from jausml.live.messages import MessageEntry
    from jausml.live.traffic.frames import Datagram

    Found = tuple[Schema | None, Channel, Message]
    """A message with its channel, and the schema of that."""

T = TypeVar("T")


@dataclass(frozen=True)
class TrafficFilter:
    """Patterns, in which `*` stands for anything; nothing selects all."""

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
    return any(fnmatchcase(name, each) for each in patterns)


@dataclass(frozen=True)
class TimeSpan:
    """A part of a recording.

    Attributes:
        start: Seconds after the first message.
        duration: Seconds from there on, None to the end.
    """

    start: float = 0.0
    duration: float | None = None

    def of(self, found: Iterable[T], time_of: Callable[[T], int | None]) -> Iterator[T]:
        """Yields what is in it.

        Args:
            time_of: The time of each in nanoseconds, None where nobody told: these are in it.
        """
        begin: int | None = None
        for each in found:
            time = time_of(each)
            if time is not None:
                begin = time if begin is None else begin
                since = (time - begin) / _NANO - self.start
                if self.duration is not None and since >= self.duration:
                    return
                if since < 0:
                    continue
            yield each

    def of_length(self, length: float) -> float:
        """Returns how many seconds of it there are in a recording of so many."""
        left = max(0.0, length - self.start)
        return left if self.duration is None else min(left, self.duration)


WHOLE = TimeSpan()
"""All of a recording."""


ROS_PROFILE = "ros2"
"""Profile of files in which all channels are of ROS (MCAP, well-known profiles)."""

COMPRESSIONS = ("zstd", "lz4", "none")
"""How chunks may be compressed, the usual one first."""

_NANO = 10**9
_CDR = "cdr"


class RecordingError(Exception):
    """A recording that cannot be made or replayed; the text says why."""


class McapRecording:
    """An MCAP file that may have been cut off: by the loss of power, a full disk, a kill.

    Attributes:
        fault: Why reading ended before the end, once all was read; empty for a whole file.
        reached: Time of the latest message so far, in nanoseconds since 1970; None for none.
    """

    def __init__(self, path: str, span: TimeSpan = WHOLE) -> None:
        """Names a file."""
        self.fault = ""
        self.reached: int | None = None
        self._path = path
        self._span = span

    def messages(self) -> Iterator[Found]:
        """Yields schema, channel and message of each record, in the order of their times.

        A file without an index is read in its own order, which is that in which messages came.

        Raises:
            RecordingError: It cannot be opened, is no such file, or nothing of it can be read.
        """
        yield from self._span.of(self._all(), lambda found: found[2].log_time)

    def length(self) -> float | None:
        """Returns the seconds from the first message to the last of the part, None if unknown."""
        with self._opened() as stream:
            summary = _summary(stream)
        statistics = summary.statistics if summary is not None else None
        if statistics is None:
            return None
        return self._span.of_length(
            (statistics.message_end_time - statistics.message_start_time) / _NANO
        )

    def has_index(self) -> bool:
        """Whether messages are found by their times."""
        with self._opened() as stream:
            return _indexed(stream) is not None

    def _opened(self) -> BinaryIO:
        try:
            return open_input(self._path)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise RecordingError(f"{self._path}: {reason}") from error

    def _all(self) -> Iterator[Found]:
        with self._opened() as stream:
            found = _indexed(stream) or _in_order_of_the_file(stream)
            while True:
                each = self._next(found)
                if each is None:
                    return
                time = each[2].log_time
                self.reached = time if self.reached is None else max(self.reached, time)
                yield each

    def _next(self, found: Iterator[Found]) -> Found | None:
        """Returns the next message; None at the end, and where nothing makes sense any more."""
        from mcap.exceptions import EndOfFile  # noqa: PLC0415 - an extra

        try:
            return next(found, None)
        except (EndOfFile, struct.error):
            self._end("it ends in the midst of a record")
        except Exception as error:  # the libraries raise anything on such bytes
            self._end(str(error) or type(error).__name__)
        return None

    def _end(self, fault: str) -> None:
        if self.reached is None:
            raise RecordingError(f"{self._path} cannot be read: {fault}")
        self.fault = fault


def _summary(stream: BinaryIO) -> Summary | None:
    """Returns what stands at the end of a file, None where nothing does that can be read."""
    from mcap.reader import SeekingReader  # noqa: PLC0415 - an extra

    try:
        return SeekingReader(stream).get_summary()
    except Exception:  # the libraries raise anything on such bytes
        return None


def _indexed(stream: BinaryIO) -> Iterator[Found] | None:
    """Returns the messages by the index of a file, None where it has none that can be read."""
    from mcap.reader import SeekingReader  # noqa: PLC0415 - an extra

    summary = _summary(stream)
    if summary is None or not summary.chunk_indexes:
        return None
    stream.seek(0)
    return SeekingReader(stream).iter_messages()


def _in_order_of_the_file(stream: BinaryIO) -> Iterator[Found]:
    from mcap.reader import NonSeekingReader  # noqa: PLC0415 - an extra

    size = stream.seek(0, 2)
    stream.seek(0)
    reader = NonSeekingReader(stream, validate_crcs=True, record_size_limit=size)
    return reader.iter_messages(log_time_order=False)


def need_library() -> None:
    """Does nothing where MCAP files can be written."""
    try:
        import mcap.writer  # noqa: F401, PLC0415 - an extra: jausml[record]
    except ImportError as error:
        raise RecordingError(f"{error.name} is missing: {installing.command('record')}") from error


def library_name() -> str:
    """Returns what stands in the header of a file for who wrote it."""
    return f"jausml {__version__}"


class McapFile:
    """An MCAP file that is being written; it has its index once it is closed."""

    def __init__(
        self, stream: BinaryIO, *, has_jaus: bool, compression: str = COMPRESSIONS[0]
    ) -> None:
        """Begins a file."""
        need_library()
        from mcap.writer import CompressionType, Writer  # noqa: PLC0415 - an extra

        self.count = 0
        self._writer = Writer(stream, compression=CompressionType[compression.upper()])
        self._writer.start("" if has_jaus else ROS_PROFILE, library_name())
        self._schemas: dict[tuple[str, str], int] = {}
        self._channels: dict[tuple[str, int], int] = {}
        self._of_jaus: dict[tuple[str, MessageEntry], int] = {}  # a schema takes long to make

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the file; without that, tools read it slowly or not at all."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def flush(self) -> None:
        """Ends a chunk, so that all that was written can be read whatever happens next."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def ros_channel(self, topic: str, type_name: str, definition: str) -> int:
        """Returns the channel of a topic."""
        schema = self._schema(type_name, "ros2msg", definition)
        return self._channel(topic, schema, "cdr")

    def jaus_channel(self, source: str, entry: MessageEntry) -> int:
        """Returns the channel of a JAUS message of one component."""
        key = (source, entry)
        if key not in self._of_jaus:
            text = json.dumps(schema_of(entry))
            schema = self._schema(f"jaus.{entry.name}.{entry.code_text}", "jsonschema", text)
            self._of_jaus[key] = self._channel(f"/jaus/{source}/{entry.name}", schema, "json")
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

    def _schema(self, name: str, encoding: str, text: str) -> int:
        key = (name, text)
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(name, encoding, text.encode())
        return self._schemas[key]

    def _channel(self, topic: str, schema: int, encoding: str) -> int:
        key = (topic, schema)
        if key not in self._channels:
            self._channels[key] = self._writer.register_channel(topic, encoding, schema)
        return self._channels[key]


def copied(messages: Iterable[Found], stream: BinaryIO, *, ros_only: bool) -> int:
    """Writes messages into a file with an index; returns how many."""
    from mcap.writer import Writer  # noqa: PLC0415 - an extra

    writer = Writer(stream)
    writer.start(ROS_PROFILE if ros_only else "", library_name())
    channels: dict[int, int] = {}
    schemas: dict[int, int] = {}
    count = 0
    for schema, channel, message in messages:
        if ros_only and channel.message_encoding != _CDR:
            continue
        if channel.id not in channels:
            channels[channel.id] = _channel(writer, schema, channel, schemas)
        own = channels[channel.id]
        times = (message.log_time, message.data, message.publish_time, message.sequence)
        writer.add_message(own, *times)
        count += 1
    writer.finish()  # type: ignore[no-untyped-call]
    return count


def _channel(
    writer: Writer, schema: Schema | None, channel: Channel, schemas: dict[int, int]
) -> int:
    """Returns the channel of what is written for one that was read."""
    number = 0
    if schema is not None:
        if schema.id not in schemas:
            made = writer.register_schema(schema.name, schema.encoding, schema.data)
            schemas[schema.id] = made
        number = schemas[schema.id]
    return writer.register_channel(
        channel.topic, channel.message_encoding, number, channel.metadata
    )
