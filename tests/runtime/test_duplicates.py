from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.duplicates import DuplicateWindow
from jausml.runtime.transports.packets.packet import AckNak, Packet

A, B, OWN = JausAddress(1, 1, 1), JausAddress(2, 1, 1), JausAddress(9, 1, 1)


def packet(source: JausAddress, number: int, payload: bytes = b"\x02\x40") -> Packet:
    return Packet(OWN, source, payload, number)


def test_a_number_is_a_duplicate_of_its_own_source_only():
    window = DuplicateWindow()
    assert not window.is_duplicate(packet(A, 5), 0.0)
    assert not window.is_duplicate(packet(B, 5), 0.0)
    assert window.is_duplicate(packet(A, 5), 0.1)
    assert window.is_duplicate(packet(A, 5), 1.4)


def test_a_number_with_other_content_is_no_duplicate():
    """A component that restarts may begin at the same number."""
    window = DuplicateWindow()
    other = packet(A, 5, b"\x03\x40")
    elsewhere = packet(A, 5)._replace(destination=JausAddress(9, 1, 2))
    for new_packet in (packet(A, 5), other, elsewhere, packet(A, 5)):
        assert not window.is_duplicate(new_packet, 0.1)
    assert window.is_duplicate(packet(A, 5)._replace(acknowledge=AckNak.REQUESTED), 0.2)
    assert len(window) == 2  # one of each destination


def test_a_number_may_come_back_after_the_window():
    window = DuplicateWindow(seconds=3.0)
    window.is_duplicate(packet(A, 5), 0.0)
    assert not window.is_duplicate(packet(A, 5), 3.0)
    assert window.is_duplicate(packet(A, 5), 5.9)


def test_a_number_that_came_back_is_among_the_latest():
    window = DuplicateWindow(seconds=3.0, history=2)
    for number, now in ((1, 0.0), (2, 1.0), (1, 3.0), (3, 3.0), (4, 3.0)):
        assert not window.is_duplicate(packet(A, number), now)
    assert window.is_duplicate(packet(A, 3), 3.1)
    assert not window.is_duplicate(packet(A, 2), 3.1)


def test_the_latest_numbers_of_a_source_are_remembered_and_few_others():
    window = DuplicateWindow(history=4)
    for number in range(100):
        window.is_duplicate(packet(A, number), 0.0)
        assert len(window) <= window.capacity == 6
    for number in range(96, 100):
        assert window.is_duplicate(packet(A, number), 0.0)
    assert not window.is_duplicate(packet(A, 90), 0.0)


def test_the_source_silent_longest_is_forgotten_first():
    window = DuplicateWindow(sources=2)
    window.is_duplicate(packet(A, 1), 0.0)
    window.is_duplicate(packet(B, 1), 0.1)
    window.is_duplicate(packet(A, 2), 0.2)
    window.is_duplicate(packet(JausAddress(3, 1, 1), 1), 0.3)
    assert window.is_duplicate(packet(A, 1), 0.4)
    assert not window.is_duplicate(packet(B, 1), 0.4)


@given(st.lists(st.tuples(st.integers(1, 20), st.integers(0, 65535)), max_size=300))
def test_memory_is_bounded_and_repetitions_are_found(arrivals):
    window = DuplicateWindow(history=8, sources=4)
    for subsystem, number in arrivals:
        source = JausAddress(subsystem, 1, 1)
        window.is_duplicate(packet(source, number), 1.0)
        assert window.is_duplicate(packet(source, number), 1.0)
        assert len(window) <= window.capacity * 4


@given(
    st.lists(
        st.tuples(
            st.integers(0, 5),
            st.sampled_from([b"\x02\x40", bytes(2000), bytes(1999) + b"\x01", bytes(2_000_000)]),
            st.sampled_from([0.0, 0.4, 1.6]),
        ),
        max_size=30,
    )
)
def test_a_large_payload_is_remembered_as_well_as_a_small_one(arrivals):
    window, model, now = DuplicateWindow(history=3), {}, 0.0
    for number, payload, pause in arrivals:
        now += pause
        since, before = model.get(number, (-9.0, b""))
        expected = before == payload and now - since < 1.5
        assert window.is_duplicate(packet(A, number, payload), now) is expected
        if not expected:
            model.pop(number, None)
            if len(model) == window.capacity:
                for oldest in list(model)[:2]:
                    del model[oldest]
            model[number] = now, payload
