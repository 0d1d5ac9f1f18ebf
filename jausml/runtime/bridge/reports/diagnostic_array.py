"""The message of `/diagnostics`, written status by status.

A bridge may have hundreds of connections. Their message must not be made in one go, while others
wait: not its objects, and not its serialized form. So it is written here as it grows, in the
encoding of ROS (CDR, little endian).
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...conversions import Time
    from .diagnostics import ConnectionStatus

TYPE = "diagnostic_msgs/msg/DiagnosticArray"
"""The type in ROS."""

_ENCODING = b"\0\1\0\0"
_LEVELS = {"ok": 0, "warning": 1, "error": 2, "stale": 3}
_LENGTH = struct.Struct("<I")
# The stamp, an empty name of a frame, and the number of statuses.
_BEGIN = struct.Struct("<iII4xI")
_PADDING = (b"", b"\0\0\0", b"\0\0", b"\0")


class DiagnosticArray:
    """A `diagnostic_msgs/msg/DiagnosticArray` that grows."""

    TYPE = TYPE

    def __init__(self, node: str) -> None:
        self._node = node
        self._count = 0
        self._data = bytearray(_BEGIN.size)

    def add(self, status: ConnectionStatus) -> None:
        """Adds a status."""
        texts = [f"{self._node}: {status.name}", status.message, status.hardware_id]
        pairs = [text for pair in status.values for text in pair]
        written = [
            *map(_written, texts),
            _LENGTH.pack(len(status.values)),
            *map(_written, pairs),
        ]
        data = self._data
        data.append(_LEVELS[status.level])
        data += _PADDING[len(data) & 3]
        for each in written:
            data += _PADDING[len(data) & 3]
            data += each
        self._count += 1

    def serialized(self, stamp: Time) -> bytes:
        """Returns the message."""
        _BEGIN.pack_into(self._data, 0, stamp.sec, stamp.nanosec, 1, self._count)
        return _ENCODING + self._data


def _written(text: str) -> bytes:
    data = text.encode() + b"\0"
    return _LENGTH.pack(len(data)) + data
