"""Messages of Junior whose flags are all set: which are whole, and which may be fragments."""

from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.inbox import FlaglessMessages
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Packet, Priority

PEER = JausAddress(200, 1, 1)
OTHER = JausAddress(201, 1, 1)
CHUNK = 4079


def flagless(size: int = 7, source: JausAddress = PEER, **fields) -> Packet:
    flags = {
        "priority": Priority.SAFETY_CRITICAL,
        "broadcast": Broadcast.RESERVED,
        "acknowledge": AckNak.ACK,
        "data_flags": DataFlags.LAST,
    }
    return Packet(JausAddress(100, 1, 1), source, bytes(size), 5, **{**flags, **fields})


def test_a_short_one_is_a_message_of_low_priority():
    message = FlaglessMessages(3.0).whole(flagless(), 0.0)
    assert message == Packet(JausAddress(100, 1, 1), PEER, bytes(7), 5, Priority.LOW)


def test_the_longest_that_is_whole():
    messages = FlaglessMessages(3.0)
    assert messages.whole(flagless(CHUNK - 1), 0.0) is not None
    assert messages.whole(flagless(CHUNK), 0.0) is None


def test_other_flags_are_of_an_acknowledgement():
    messages = FlaglessMessages(3.0)
    for fields in (
        {"priority": Priority.HIGH},
        {"broadcast": Broadcast.GLOBAL},
        {"data_flags": DataFlags.SINGLE},
    ):
        assert messages.whole(flagless(**fields), 0.0) is None


def test_a_full_one_casts_doubt_on_its_source_for_a_while():
    messages = FlaglessMessages(3.0)
    messages.whole(flagless(CHUNK), 10.0)
    assert messages.whole(flagless(), 10.1) is None
    assert messages.whole(flagless(source=OTHER), 10.1) is not None
    assert messages.whole(flagless(), 12.9) is None
    assert messages.whole(flagless(), 13.0) is not None


def test_a_flood_of_sources_is_forgotten_but_for_the_latest():
    messages = FlaglessMessages(3.0)
    sources = [JausAddress(number, 1, 1) for number in range(1, 301)]
    for source in sources:
        messages.whole(flagless(CHUNK, source), 0.0)
    doubted = [
        address for address in sources if messages.whole(flagless(source=address), 1.0) is None
    ]
    assert doubted == sources[-256:]
