"""Messages as bytes: what the generated classes of messages are made of."""

from .codec import (
    check_count,
    check_presence,
    exactly,
    integer,
    latin1,
    one_of,
    padded,
    real,
    scaled,
    scaled_down,
    scaled_up,
    sized,
    take,
    take_text,
    unpadded,
    whole,
    whole_of,
)
from .message import DecodeError, EncodeError, Message
from .records import Number, RowLayout, Stamp, read_records, write_records
from .time_stamp import StampedMessage, TimeStamp

__all__ = [
    "DecodeError",
    "EncodeError",
    "Message",
    "Number",
    "RowLayout",
    "Stamp",
    "StampedMessage",
    "TimeStamp",
    "check_count",
    "check_presence",
    "exactly",
    "integer",
    "latin1",
    "one_of",
    "padded",
    "read_records",
    "real",
    "scaled",
    "scaled_down",
    "scaled_up",
    "sized",
    "take",
    "take_text",
    "unpadded",
    "whole",
    "whole_of",
    "write_records",
]
