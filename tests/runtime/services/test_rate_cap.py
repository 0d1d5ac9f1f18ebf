"""How many messages a second are taken of one source."""

from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.bridge.connections import shaping
from jausml.runtime.bridge.connections.shaping import OVER_RATE, RateCap

from .bridge_support import OWN, PEER, message_connection, minutes


class Gate:
    """A cap with a clock of its own, and what it lets pass."""

    def __init__(self, hertz: float) -> None:
        self.now = 0.0
        self.passed: list[tuple[bytes, object]] = []
        self.dropped: list[tuple[str, str]] = []
        cap = RateCap(hertz, lambda: self.now, lambda *what: self.dropped.append(what))
        self._take = cap.before(lambda data, sender: self.passed.append((data, sender)))

    def send(self, count: int, sender: object = "a", every: float = 0.0) -> int:
        before = len(self.passed)
        for _ in range(count):
            self._take(b"", sender)
            self.now += every
        return len(self.passed) - before


def test_a_seconds_worth_passes_at_once_and_the_rest_at_the_rate():
    gate = Gate(10.0)
    assert gate.send(50) == 10
    assert gate.dropped == [(OVER_RATE, "a")] * 40
    gate.now = 0.5
    assert gate.send(50) == 5
    gate.now = 100.0
    assert gate.send(50) == 10


def test_a_source_that_keeps_to_the_rate_loses_nothing():
    gate = Gate(10.0)
    assert gate.send(1000, every=0.1) == 1000
    assert not gate.dropped


def test_less_than_one_a_second_is_a_rate_too():
    gate = Gate(0.5)
    assert gate.send(100, every=0.1) == 6
    gate.now = 100.0
    assert gate.send(3, every=2.0) == 3


@given(
    st.sampled_from([0.5, 1.0, 7.0, 100.0]),
    st.lists(st.tuples(st.integers(1, 300), st.floats(0, 3)), max_size=8),
)
def test_never_more_passes_than_the_rate_and_a_second(hertz, bursts):
    gate = Gate(hertz)
    for count, pause in bursts:
        gate.send(count)
        gate.now += pause
    assert len(gate.passed) <= hertz * (gate.now + 1) + 1


def test_many_names_are_worth_no_more_than_one(monkeypatch):
    monkeypatch.setattr(shaping, "_MAX_SOURCES", 3)
    gate = Gate(10.0)
    for name in "abc":
        gate.send(1, name)
    assert sum(gate.send(10, number) for number in range(50)) == 10
    assert gate.send(9, "a") == 9
    gate.now = 5.0  # all of them are silent: there is room again
    assert gate.send(10, "new") == 10
    assert gate.send(10, "newer") == 10


def test_a_flood_of_one_source_passes_at_its_cap(world, setting):
    connection = setting.open(message_connection(rate_cap=5.0))
    flood, other = world.probe("5.1.1"), world.probe(str(PEER))
    for number in range(50):
        flood.send(minutes(number), OWN)
    other.tell(OWN, minutes(59))
    assert setting.ros.numbers("times") == [0.0, 1.0, 2.0, 3.0, 4.0, 59.0]
    assert setting.drops(connection) == {OVER_RATE: 45}


def test_without_a_cap_nothing_stands_before_the_way(world, setting):
    connection = setting.open(message_connection())
    flood = world.probe("5.1.1")
    for number in range(50):
        flood.send(minutes(number), OWN)
    world.settle()
    assert len(setting.ros.numbers("times")) == 50
    assert setting.drops(connection) == {}
