"""The streams of JTCP: the same messages however they are cut, and never much in memory.

The first byte of an input is how many bytes arrive at once, the rest is the stream.
"""

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.packets.packet import EMPTY_MESSAGE_SIZE, DataFlags, Packet
from jausml.runtime.transports.tcp_connection import StreamError, StreamReader

_MOST_PENDING = 65535


def one_input(data: bytes) -> None:
    """Reads one stream as a whole and in parts.

    Raises:
        AssertionError: The parts hold something else than the whole.
    """
    step, stream = (data[0] or 1) if data else 1, data[1:]
    whole = read([stream])
    parts = read([stream[start : start + step] for start in range(0, len(stream), step)])
    assert parts == whole, f"{parts} in parts of {step}, {whole} as a whole"


def read(chunks: list[bytes]) -> tuple[list[Packet | None], str, dict[str, int]]:
    """Returns the messages of a stream, how it ends, and what was counted."""
    counters = Counters()
    reader = StreamReader(counters)
    packets: list[Packet | None] = []
    end = ""
    try:
        for chunk in chunks:
            packets.extend(reader.feed(chunk))
            assert reader.pending <= _MOST_PENDING
    except StreamError as error:
        end = error.counter
    size = sum(len(packet.payload) + EMPTY_MESSAGE_SIZE for packet in packets if packet)
    assert size <= sum(map(len, chunks))
    # Each message is there, or counted as one that cannot be read.
    assert packets.count(None) == sum(counters.snapshot().values())
    return packets, end, counters.snapshot()


def seeds() -> list[bytes]:
    """Returns streams of good messages."""
    packet = Packet(JausAddress(100, 1, 1), JausAddress(200, 1, 1), b"\x02\x40abc", 7)
    messages = [packet._replace(data_flags=flags).encode()[1:] for flags in DataFlags]
    streams = [b"\x02" + messages[0], b"\x02" + b"".join(messages), b"\x02", b"\x02" + bytes(14)]
    return [bytes([step]) + stream for stream in streams for step in (1, 3, 255)]
