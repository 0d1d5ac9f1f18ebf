"""Messages in the stream of a JTCP connection (AS5669A)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.errors import JausError
from ..packets.packet import EMPTY_MESSAGE_SIZE, JUDP_VERSION, Packet, message_size, parse_message

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...base.counters import Counters

_SIZE_END = 3


class StreamError(JausError):
    """A stream in which no more messages can be found."""

    def __init__(self, counter: str, detail: str) -> None:
        super().__init__(detail)
        self.counter = counter


class StreamReader:
    """Cuts one direction of a connection into messages, however it arrives."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._data = b""
        self._is_version_known = False

    @property
    def pending(self) -> int:
        """Bytes of a message that has not arrived as a whole; less than 65536."""
        return len(self._data)

    def feed(self, data: bytes) -> Iterator[Packet | None]:
        """Yield the messages that are complete now; None for each that cannot be read.

        To be iterated to its end, or never fed again.

        Raises:
            StreamError: The version is another one, or a message is too small to be one.
        """
        data, offset = self._data + data, 0
        if data and not self._is_version_known:
            if data[0] != JUDP_VERSION:
                raise StreamError("jtcp.bad_version", data[:32].hex())
            self._is_version_known = True
            offset = 1
        end = len(data)
        while end - offset >= _SIZE_END:
            size = message_size(data, offset)
            if size < EMPTY_MESSAGE_SIZE:
                raise StreamError("jtcp.bad_size", f"a message of {size} bytes")
            if end - offset < size:
                break
            yield parse_message(data, offset, size, self._counters)
            offset += size
        self._data = data[offset:]
