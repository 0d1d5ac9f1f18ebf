"""MCAP files, written: topics of ROS as rosbag2 has them, and JAUS messages as JSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, BinaryIO

from jausml import __version__
from jausml.live.recording.errors import RecordingError
from jausml.live.recording.jaus_schemas import schema_of

if TYPE_CHECKING:
    from typing_extensions import Self

    from jausml.live.messages import MessageEntry

ROS_PROFILE = "ros2"
"""Profile of files in which all channels are of ROS (MCAP, well-known profiles)."""

COMPRESSIONS = ("zstd", "lz4", "none")
"""How chunks may be compressed, the usual one first."""


def need_library() -> None:
    """Does nothing where MCAP files can be written."""
    try:
        import mcap.writer  # noqa: F401, PLC0415 - an extra: jausml[record]
    except ImportError as error:
        raise RecordingError(f"{error.name} is missing: pip install 'jausml[record]'") from error


def library_name() -> str:
    """Returns what stands in the header of a file for who wrote it."""
    return f"jausml {__version__}"


class McapFile:
    """An MCAP file that is being written; it has its index once it is closed."""

    def __init__(
        self, stream: BinaryIO, *, has_jaus: bool, compression: str = COMPRESSIONS[0]
    ) -> None:
        """Begins a file.

        Args:
            compression: One of `COMPRESSIONS`.

        Raises:
            RecordingError: The library `mcap` is missing.
        """
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
        """Writes a message.

        Args:
            published: When it was sent, the time above by default.
        """
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
