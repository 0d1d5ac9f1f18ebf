"""An MCAP file, written again: whole where it was cut off, or what is of ROS in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

from jausml.live.recording.mcap_writing import ROS_PROFILE, library_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mcap.records import Channel, Schema
    from mcap.writer import Writer

    from jausml.live.recording.mcap_reading import Found

_CDR = "cdr"


def copied(messages: Iterable[Found], stream: BinaryIO, *, ros_only: bool) -> int:
    """Writes messages into a file with an index; returns how many.

    Args:
        ros_only: Whether those are left out that are not of ROS.
    """
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
