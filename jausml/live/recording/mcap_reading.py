"""MCAP files, read as far as they go: those that were cut off too, which have no index."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, BinaryIO

from jausml.language.model.inputs import open_input
from jausml.live.recording.errors import RecordingError
from jausml.live.recording.spans import WHOLE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mcap.records import Channel, Message, Schema
    from mcap.summary import Summary

    from jausml.live.recording.spans import Span

    Found = tuple[Schema | None, Channel, Message]
    """A message with its channel, and the schema of that."""


_NANO = 10**9


class McapRecording:
    """An MCAP file that may have been cut off: by the loss of power, a full disk, a kill.

    Attributes:
        fault: Why reading ended before the end, once all was read; empty for a whole file.
        reached: Time of the latest message so far, in nanoseconds since 1970; None for none.
    """

    def __init__(self, path: str, span: Span = WHOLE) -> None:
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
        told = summary.statistics if summary is not None else None
        if told is None:
            return None
        return self._span.of_length((told.message_end_time - told.message_start_time) / _NANO)

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
