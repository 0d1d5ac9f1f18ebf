"""Reader of MCAP files, also of damaged ones, which checks their counts and checksums.

Chunks are found by the index or in the order of the file, unpacked in bounded memory, and left out,
with a note of the place, if their checksum is wrong (MCAP format specification, version 0).
"""

from __future__ import annotations

import heapq
import io
import struct
import zlib
from array import array
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

from jausml.language.model.files import open_input
from jausml.live.recording.mcap_files import LIBRARY, NANO, WHOLE, RecordingError, TimeSpan
from jausml.live.recording.mcap_records import FOOTER, HEAD, MAGIC, Opcode, heads, records_of_chunk
from jausml.live.recording.unpacking import MOST_UNPACKED, DamageError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mcap.records import Channel, ChunkIndex, Schema, Statistics

    from jausml.live.recording.mcap_files import Found

    _Begun = list[tuple[int, int, Found, Iterator[Found]]]
    """Of chunks that are being read: time of the next message, place, the message, and the rest."""

_MESSAGE = struct.Struct("<HIQQ")  # channel, number, and the times of recording and publishing

_TIME_OFFSET = HEAD.size + 6  # where the time of a message stands in its record

# Messages that a small file may have, and those for each byte of a larger one: messages of
# different times cannot be packed so well, and each takes time to read.
_MOST_SMALL, _MOST_PER_BYTE = 1 << 18, 64

_STEP = 1 << 20
_MOST_NAMED = 3


_READ = frozenset({Opcode.HEADER, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK})
_Record = tuple[int, int, bytes]  # opcode, place in the file, and content


@dataclass(frozen=True)
class RecordedDefinition:
    """The definition of a type in a recording.

    Attributes:
        encoding: Its notation, such as `ros2msg`; empty without a definition.
    """

    encoding: str = ""
    text: str = ""


UNDEFINED = RecordedDefinition()  # nothing says what a message is but the name of its type


def definition_in(schema: Schema) -> RecordedDefinition:
    """Returns the definition in a schema."""
    return RecordedDefinition(schema.encoding, schema.data.decode("utf-8", "replace"))


class McapRecording:
    """An MCAP file, which may be damaged or cut off.

    Attributes:
        fault: The parts that cannot be read, in words, after all was read; empty for none.
        reached: Time of the latest message so far, in nanoseconds since 1970; None for none.
    """

    def __init__(self, path: str, span: TimeSpan = WHOLE) -> None:
        """Opens nothing yet."""
        self.fault = ""
        self.reached: int | None = None
        self._path = path
        self._span = span

    def messages(self) -> Iterator[Found]:
        """Yields schema, channel and message of each record, in the order of their times.

        A file without a complete index is read in its own order, that of arrival.

        Raises:
            RecordingError: It cannot be opened, is no MCAP file, or no part of it can be read.
        """
        yield from self._span.of(self._all(), lambda record: record[2].log_time)

    def length(self) -> float | None:
        """Returns the seconds from the first to the last message in the span, None if unknown."""
        with self._opened() as stream:
            statistics = _Contents(stream).statistics
        if statistics is None:
            return None
        return self._span.of_length(
            (statistics.message_end_time - statistics.message_start_time) / NANO
        )

    def _opened(self) -> BinaryIO:
        try:
            return open_input(self._path)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise RecordingError(f"{self._path}: {reason}") from error

    def _all(self) -> Iterator[Found]:
        self.fault, self.reached = "", None
        with self._opened() as stream:
            contents = _Contents(stream)
            try:
                for message in contents.messages():
                    time = message[2].log_time
                    self.reached = time if self.reached is None else max(self.reached, time)
                    yield message
            except OSError as error:
                raise RecordingError(f"{self._path}: {error.strerror or error}") from error
            finally:
                self.fault = contents.fault
        if self.fault and self.reached is None:
            raise RecordingError(f"{self._path} cannot be read: {self.fault}")


class _Contents:
    """The contents of an open file."""

    def __init__(self, stream: BinaryIO) -> None:
        """Reads the summary; one with a wrong checksum is noted and ignored."""
        self.statistics: Statistics | None = None
        self._stream, self._size = stream, stream.seek(0, io.SEEK_END)
        self._chunks: list[ChunkIndex] = []
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._damages: list[str] = []
        self._more = 0
        self._unknown: Counter[int] = Counter()
        self._count = self._held = 0
        self._left = max(_MOST_SMALL, _MOST_PER_BYTE * self._size)
        self._is_over = self._has_end = self._has_summary = self._is_ours = False
        stream.seek(0)
        self._has_begin = stream.read(len(MAGIC)) == MAGIC
        try:
            for opcode, at, content in self._summary():
                self._take(opcode, at, content)
        except DamageError as error:
            self._note(error)
            self._chunks.clear()

    @property
    def is_indexed(self) -> bool:
        """Whether the summary has all chunks, and all schemas and channels of their messages."""
        statistics = self.statistics
        named = {channel for chunk in self._chunks for channel in chunk.message_index_offsets}
        if statistics is not None:
            named |= statistics.channel_message_counts.keys()
            if statistics.chunk_count != len(self._chunks):
                return False
        schemas = {channel.schema_id for channel in self._channels.values()} - {0}
        is_described = named <= self._channels.keys() and schemas <= self._schemas.keys()
        return bool(self._chunks and self._channels) and is_described

    @property
    def fault(self) -> str:
        """The damage found so far, and after all was read wrong counts, in words; else empty."""
        faults = list(self._damages)
        if self._more:
            faults.append(f"{self._more} more places are damaged")
        for number, count in sorted(self._unknown.items())[:_MOST_NAMED]:
            faults.append(f"{count} messages are of channel {number}, which nothing describes")
        counted = self.statistics.message_count if self.statistics is not None else 0
        if self._is_over and counted > self._count:
            faults.append(f"{self._count} of the {counted} messages that it counts are read")
        return "; ".join(faults)

    def messages(self) -> Iterator[Found]:
        """Yields all messages, by the index if it is complete, else in the order of the file."""
        for message in self._by_index() if self.is_indexed else self._in_order():
            self._count += 1
            yield message
        self._is_over = True

    def _by_index(self) -> Iterator[Found]:
        """Yields messages in the order of their times, with as few unpacked chunks as possible."""
        begun: _Begun = []
        chunks = {chunk.chunk_start_offset: chunk.message_start_time for chunk in self._chunks}
        for at, start in sorted(chunks.items(), key=lambda item: item[1]):
            while begun and (begun[0][0] < start or self._held > MOST_UNPACKED):
                yield _earliest(begun)
            _push(begun, at, self._guarded(self._indexed_chunk(at)))
        while begun:
            yield _earliest(begun)

    def _indexed_chunk(self, at: int) -> Iterator[Found]:
        opcode, length = self._head(at)
        if opcode != Opcode.CHUNK or length > MOST_UNPACKED:
            raise DamageError(f"no chunk that can be read stands at byte {at}")
        yield from self._chunk(at, self._stream.read(length))

    def _in_order(self) -> Iterator[Found]:
        """Yields messages in the order of the file."""
        records = self._records()
        while True:
            try:
                record = next(records, None)
            except DamageError as error:
                self._note(error)
                return  # the beginning of the next record is not known
            if record is None:
                return
            yield from self._guarded(self._messages(record))

    def _messages(self, record: _Record) -> Iterator[Found]:
        opcode, at, content = record
        if opcode == Opcode.CHUNK:
            yield from self._chunk(at, content)
        elif opcode == Opcode.MESSAGE:
            yield from self._message(content, at)
        elif opcode == Opcode.HEADER:
            self._is_ours = LIBRARY.encode() in content
        else:
            self._take(opcode, at, content)

    def _guarded(self, messages: Iterator[Found]) -> Iterator[Found]:
        """Yields messages; notes those that cannot be read."""
        try:
            yield from messages
        except DamageError as error:
            self._note(error)

    def _note(self, error: DamageError) -> None:
        if len(self._damages) < _MOST_NAMED:
            self._damages.append(str(error))
        else:
            self._more += 1

    def _head(self, at: int) -> tuple[int, int]:
        """Returns opcode and length of the record at an offset."""
        if at + HEAD.size > self._size:
            raise DamageError("it ends in the midst of a record")
        self._stream.seek(at)
        opcode, length = HEAD.unpack(self._stream.read(HEAD.size))
        if not opcode:
            raise DamageError(f"no record begins at byte {at} of {self._size}")
        if length > self._size - at - HEAD.size:
            raise DamageError(f"it ends in the midst of a record, which begins at byte {at}")
        return opcode, length

    def _records(self) -> Iterator[_Record]:
        """Yields the records of the data section, without those that are not used here."""
        at, checksum = len(MAGIC), zlib.crc32(MAGIC)
        if not self._has_begin:
            raise DamageError("it does not begin as MCAP files do")
        while True:
            opcode, length = self._head(at)
            if opcode in (Opcode.FOOTER, Opcode.DATA_END):
                content = self._stream.read(4)
                expected = int.from_bytes(content, "little") if opcode == Opcode.DATA_END else 0
                if expected not in (0, checksum):
                    raise DamageError("what stands before its end does not fit its checksum")
                if not self._has_end:
                    raise DamageError("it ends in the midst of a record")
                if self._is_ours and not self._has_summary:
                    raise DamageError("its recorder was stopped: what came last may be missing")
                return
            checksum = zlib.crc32(HEAD.pack(opcode, length), checksum)
            if opcode in _READ and length <= MOST_UNPACKED:
                content = self._stream.read(length)
                checksum = zlib.crc32(content, checksum)
                yield opcode, at, content
            else:
                if opcode in _READ:
                    self._note(DamageError(f"the record at byte {at} has {length:,} bytes"))
                for begin in range(0, length, _STEP):
                    piece = self._stream.read(min(_STEP, length - begin))
                    checksum = zlib.crc32(piece, checksum)
            at += HEAD.size + length

    def _summary(self) -> Iterator[_Record]:
        """Yields the records of the summary, none where it is missing (MCAP, Footer)."""
        end = self._size - HEAD.size - FOOTER.size - len(MAGIC)
        if not self._has_begin or end < len(MAGIC):
            return
        self._stream.seek(end)
        tail = self._stream.read()
        if not tail.endswith(MAGIC) or tail[: HEAD.size] != HEAD.pack(Opcode.FOOTER, FOOTER.size):
            return  # it was cut off
        self._has_end = True
        start, _, checksum = FOOTER.unpack_from(tail, HEAD.size)
        self._has_summary = bool(start)
        if not start:
            return
        if not 0 <= end - start <= MOST_UNPACKED:
            raise DamageError(f"its summary does not begin at byte {start}")
        self._stream.seek(start)
        data = self._stream.read(end - start)
        if checksum and zlib.crc32(data + tail[: HEAD.size + 16]) != checksum:
            raise DamageError("its summary does not fit its checksum")
        for opcode, at, length in heads(data, "its summary"):
            begin = at + HEAD.size
            yield opcode, start + at, data[begin : begin + length]

    def _chunk(self, at: int, content: bytes) -> Iterator[Found]:
        """Yields the messages of a chunk in the order of their times."""
        where = f"the chunk at byte {at}"
        data = records_of_chunk(content, where)
        self._held += len(data)
        try:
            for place in self._places(data, where):
                begin = place + HEAD.size
                (length,) = struct.unpack_from("<Q", data, place + 1)
                yield from self._message(data[begin : begin + length], at)
        finally:
            self._held -= len(data)

    def _places(self, data: bytes, where: str) -> Iterable[int]:
        """Returns the offsets of the messages of a chunk, in the order of their times."""
        places, last, is_sorted = array("Q"), 0, True

        def time_at(place: int) -> int:
            return int.from_bytes(data[place + _TIME_OFFSET : place + _TIME_OFFSET + 8], "little")

        for opcode, at, length in heads(data, where):
            if opcode == Opcode.MESSAGE:
                time = time_at(at)
                is_sorted, last = is_sorted and time >= last, time
                places.append(at)
                if len(places) > self._left:
                    excess = f"messages, which a file of {self._size:,} bytes cannot have"
                    raise DamageError(f"{where} holds more than {self._left:,} {excess}")
            else:
                begin = at + HEAD.size
                self._take(opcode, at, data[begin : begin + length])
        self._left -= len(places)
        return places if is_sorted else sorted(places, key=time_at)

    def _take(self, opcode: int, at: int, content: bytes) -> None:
        """Takes a schema, a channel or a record of the summary."""
        from mcap import records  # noqa: PLC0415 - an extra
        from mcap.data_stream import ReadDataStream  # noqa: PLC0415

        def read(kind: Any) -> Any:
            try:
                return kind.read(ReadDataStream(io.BytesIO(content)))
            except Exception as error:  # the library raises anything on such bytes
                raise DamageError(f"the record at byte {at} makes no sense") from error

        if opcode == Opcode.SCHEMA:
            schema = read(records.Schema)
            self._schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = read(records.Channel)
            self._channels[channel.id] = channel
        elif opcode == Opcode.CHUNK_INDEX:
            self._chunks.append(read(records.ChunkIndex))
        elif opcode == Opcode.STATISTICS:
            self.statistics = read(records.Statistics)

    def _message(self, content: bytes, at: int) -> Iterator[Found]:
        """Yields the message in a record; none, but counted, for an unknown channel."""
        from mcap.records import Message  # noqa: PLC0415 - an extra

        if len(content) < _MESSAGE.size:
            raise DamageError(f"a message at byte {at} has no head")
        number, sequence, time, published = _MESSAGE.unpack_from(content)
        channel = self._channels.get(number)
        schema = self._schemas.get(channel.schema_id) if channel is not None else None
        if channel is None or (channel.schema_id and schema is None):
            self._unknown[number] += 1
            return
        data = content[_MESSAGE.size :]
        yield schema, channel, Message(number, time, data, published, sequence)


def _push(begun: _Begun, at: int, rest: Iterator[Found]) -> None:
    """Adds the next message of a chunk, if there is one."""
    record = next(rest, None)
    if record is not None:
        heapq.heappush(begun, (record[2].log_time, at, record, rest))


def _earliest(begun: _Begun) -> Found:
    """Returns the earliest message of the begun chunks."""
    _, at, record, rest = heapq.heappop(begun)
    _push(begun, at, rest)
    return record
