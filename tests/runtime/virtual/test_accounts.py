"""What both ends say they exchanged, against what the network did."""

import pytest

from jausml.runtime import JausAddress
from jausml.runtime.messages import QueryStatus, ReportStatus, SetTime
from jausml.runtime.transports.transport import accounts_of
from jausml.runtime.virtual import Link

from .test_network import EVERYBODY, FIRST, SECOND, THIRD, component

PLAIN = Link()


def between(transport, own, peer):
    (found,) = [account for account in transport.traffic(own) if account.peer == peer]
    return found


@pytest.mark.parametrize(
    "way",
    [
        Link(loss=0.3), Link(loss=0.3, burst=5), Link(duplicate=0.3, loss=0.1),
        Link(jitter=0.06, loss=0.1), Link(reorder=0.2, loss=0.1, duplicate=0.1),
    ],
    ids=str,
)  # fmt: skip
def test_each_of_three_receivers_knows_what_it_lost(world, way):
    """Gaps of numbers that count for all would tell each what the others got."""
    sender = world.transport()
    component(sender, FIRST, services=())
    came = {}
    receivers = {receiver: world.transport() for receiver in (SECOND, THIRD, JausAddress(2, 1, 1))}
    for address, transport in receivers.items():
        arrived = came[address] = []
        transport.attach(address, lambda payload, _, arrived=arrived: arrived.append(payload))
        transport.send(address, FIRST, b"\x00\x00")  # it is known where they are

    def send(number):
        for index, address in enumerate(receivers):
            for part in range(index + 1):
                sender.send(
                    FIRST, address, SetTime.CODE.to_bytes(2, "little") + bytes([number, part])
                )
        sender.send(FIRST, EVERYBODY, QueryStatus().encode())

    world.run_for(0.1)
    send(0)
    world.run_for(0.1)
    sender.out = way
    for number in range(1, 250):
        send(number)
        world.run_for(0.01)
    sender.out = PLAIN
    world.run_for(2.0)
    send(250)
    world.run_for(0.1)
    for index, (address, transport) in enumerate(receivers.items()):
        sent = between(sender, FIRST, address).sent
        account = between(transport, address, FIRST).account
        assert sent == 251 * (index + 1)
        assert account.came == len({payload for payload in came[address] if payload[2:]})
        assert account.came + account.lost == sent
        assert account.restarts == 0


def test_both_ends_of_a_conversation_add_up(world):
    """Queries, answers, control and events, each direction with all of its kinds."""
    transports = {address: world.transport() for address in (FIRST, SECOND)}
    _, second = (component(transport, address) for address, transport in transports.items())
    answers = []
    second.subscribe(FIRST, QueryStatus(), ReportStatus, lambda *_: None, rate=20)
    second.control(FIRST, authority=200)
    world.run_for(1.0)
    for endpoint in transports.values():
        endpoint.out = Link(loss=0.2, duplicate=0.1)
    for _ in range(100):
        second.query(FIRST, QueryStatus(), ReportStatus, lambda *_: answers.append(1))
        world.run_for(0.1)
    for endpoint in transports.values():
        endpoint.out = PLAIN
    world.run_for(5.0)
    assert len(answers) > 50
    for own, peer in ((FIRST, SECOND), (SECOND, FIRST)):
        account = between(transports[own], own, peer).account
        assert account.lost > 10
        assert account.came + account.lost == between(transports[peer], peer, own).sent
        lost = transports[peer].lost[peer, own]
        # What was repeated until it came was lost now and then, and came at last.
        assert account.lost <= lost


def test_what_is_acknowledged_is_counted_where_it_was_sent(world):
    sender, receiver = world.transport(), world.transport()
    for transport, address in ((sender, FIRST), (receiver, SECOND)):
        transport.attach(address, lambda *_: None)
    receiver.send(SECOND, FIRST, b"\x00\x00")
    world.run_for(0.1)
    for _ in range(3):
        sender.send(FIRST, SECOND, b"\x02\x40", acknowledge=True)
    world.run_for(1.0)
    receiver.cut()
    sender.send(FIRST, SECOND, b"\x02\x40", acknowledge=True)
    world.run_for(10.0)
    traffic = between(sender, FIRST, SECOND)
    assert traffic.sent == 4
    assert (traffic.outcome.acknowledged, traffic.outcome.unacknowledged) == (3, 1)


def test_what_is_acknowledged_over_a_long_way_is_late_and_not_lost(world):
    """A warning of each message that arrived hid those that did not."""
    way = Link(delay=0.3, jitter=0.1)
    sender, receiver = world.transport(way), world.transport(way)
    for transport, address in ((sender, FIRST), (receiver, SECOND)):
        transport.attach(address, lambda *_: None)
    receiver.send(SECOND, FIRST, b"\x00\x00")
    world.run_for(1.0)
    results = []
    for _ in range(100):
        receiver.send(SECOND, FIRST, b"\x00\x00")
        sender.send(FIRST, SECOND, b"\x02\x40", acknowledge=True, on_result=results.append)
        world.run_for(0.05)
    receiver.cut()
    sender.send(FIRST, SECOND, b"\x02\x40", acknowledge=True)
    world.run_for(10.0)
    outcome = between(sender, FIRST, SECOND).outcome
    assert (outcome.acknowledged, outcome.late) == (0, 100 - outcome.unacknowledged + 1)
    # The last one, and those whose acknowledgements were under way when the way was cut.
    assert 1 <= outcome.unacknowledged < 20
    assert results == [False] * 100
    assert world.counters.drops()["transport.unacknowledged"] == outcome.unacknowledged


def test_an_account_names_what_was_refused_and_not_known(world):
    first = component(world.transport(), FIRST)
    transport = world.transport()
    second = component(transport, SECOND)
    transport.send(SECOND, FIRST, SetTime().encode())
    transport.send(SECOND, FIRST, b"\x01\xd7")
    transport.send(SECOND, FIRST, ReportStatus.CODE.to_bytes(2, "little"))
    world.run_for(0.5)
    (account,) = accounts_of(first)
    told = account.counts()
    assert (told["sent by it"], told["came"], told["lost on the way, at most"]) == (3, 3, 0)
    assert told["dropped: refused SetTime"] == 1
    assert told["dropped: unknown D701h"] == 1
    assert "came 3" in str(account)
    second.stop()
