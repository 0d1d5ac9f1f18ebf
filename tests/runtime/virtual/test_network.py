"""Components on the network of a virtual world, with delays and losses."""

from itertools import pairwise

import pytest

from jausml.runtime import (
    ComponentSettings,
    ControlState,
    Guard,
    JausAddress,
    JausComponent,
    TransportSettings,
)
from jausml.runtime.messages import (
    QueryIdentification,
    QueryStatus,
    QueryTime,
    ReportIdentification,
    ReportStatus,
    ReportTime,
    SetTime,
)
from jausml.runtime.virtual import Link
from tests.runtime.services.state_tables import V1_1, core_services

CORE = core_services(
    V1_1, "Transport", "Events", "AccessControl", "Management", "Time", "Liveness", "Discovery"
)
FIRST, SECOND = JausAddress(1, 1, 1), JausAddress(1, 1, 2)
THIRD = JausAddress(1, 2, 1)
EVERYBODY = JausAddress(0xFFFF, 0xFF, 0xFF)
LOSSY = Link(delay=0.03, jitter=0.02, loss=0.2, duplicate=0.05, reorder=0.05)


def component(transport, address, name="tested", services=CORE, **settings):
    settings.setdefault("register_services", False)
    made = JausComponent(
        transport, address, name=name, services=services, settings=ComponentSettings(**settings)
    )
    made.start()
    return made


def attached(world, transport, address):
    """Attaches an address alone; returns what arrives for it, as (time, payload)."""
    got = []
    transport.attach(address, lambda payload, _: got.append((world.now(), payload)))
    return got


@pytest.fixture
def pair(world):
    """Two components on lossy ways."""
    return [component(world.transport(LOSSY, LOSSY), address) for address in (FIRST, SECOND)]


class TestTimes:
    def test_a_question_takes_both_ways(self, world):
        component(world.transport(out=Link(delay=0.020), into=Link(delay=0.003)), FIRST)
        asker = component(world.transport(out=Link(delay=0.010)), SECOND)
        times = []
        asker.query(FIRST, QueryStatus(), ReportStatus, lambda *_: times.append(world.now()))
        world.run_until(lambda: times, limit=1)
        assert times == [pytest.approx(0.010 + 0.003 + 0.020, abs=1e-9)]

    def test_repetitions_are_paced_by_the_settings(self, world):
        sender = world.transport(
            Link(loss=1), settings=TransportSettings(acknowledge_timeout=0.5, acknowledge_retries=2)
        )
        results = []
        sender.send(
            FIRST,
            SECOND,
            b"\x01\x00",
            acknowledge=True,
            on_result=lambda done: results.append((world.now(), done)),
        )
        world.run_for(5)
        assert results == [(pytest.approx(1.5), False)]

    def test_a_periodic_event_comes_on_time(self, world):
        component(world.transport(Link(delay=0.05)), FIRST)
        asker = component(world.transport(), SECOND)
        times = []
        asker.subscribe(
            FIRST, QueryTime(3), ReportTime, lambda *_: times.append(world.now()), rate=25
        )
        world.run_for(10)
        assert len(times) == pytest.approx(250, abs=5)
        # The wire carries rates in steps of 0.017 Hz.
        gaps = [b - a for a, b in pairwise(times[5:])]
        assert gaps == [pytest.approx(0.04, abs=2e-5)] * len(gaps)

    def test_reports_tell_the_time_of_the_world(self, world):
        first = component(world.transport(Link(delay=0.25)), FIRST)
        asker = component(world.transport(), SECOND)
        world.run_for(3600)
        got = []
        asker.query(FIRST, QueryTime(3), ReportTime, lambda report, _: got.append(report))
        world.run_until(lambda: got, limit=1)
        (report,) = got
        assert (report.time_stamp.hour, report.time_stamp.minutes) == (1, 0)
        assert (report.date_stamp.year, report.date_stamp.month) == (26, 1)
        assert first.clock.utc().hour == 1


class TestWhoIsReached:
    def test_a_broadcast_reaches_all_others_once(self, world):
        transports = [world.transport(Link(delay=0.1)) for _ in range(3)]
        got = [
            attached(world, transport, address)
            for transport, address in zip(transports, (FIRST, SECOND, THIRD), strict=True)
        ]
        transports[0].send(FIRST, EVERYBODY, b"\x02\x2bhello")
        world.run_for(1)
        expected = [(pytest.approx(0.1), b"\x02\x2bhello")]
        assert got == [[], expected, expected]

    def test_a_component_of_the_same_process_needs_no_network(self, world):
        transport = world.transport(Link(loss=1))
        got = attached(world, transport, SECOND)
        transport.attach(FIRST, pytest.fail)
        transport.send(FIRST, SECOND, b"\x01\x00")
        world.run_for(1)
        assert got == [(0.0, b"\x01\x00")]
        assert not transport.sent

    def test_datagrams_are_counted_by_who_sends_to_whom(self, world):
        sender, receiver = world.transport(), world.transport(into=Link(loss=0.5))
        attached(world, sender, FIRST)
        got = attached(world, receiver, SECOND)
        receiver.send(SECOND, FIRST, b"\x01\x00")  # tells where it is
        world.run_for(1)
        for number in range(400):
            world.call_later(number * 0.1, lambda: sender.send(FIRST, SECOND, b"\x01\x00"))
        world.run_for(60)
        way = FIRST, SECOND
        assert sender.sent[way] >= 400
        assert receiver.received[way] + receiver.lost[way] == sender.sent[way]
        assert sender.lost[way] == 0
        assert 150 < receiver.lost[way] < 260
        assert 140 < len(got) <= receiver.received[way]

    def test_cut_and_restored(self, world):
        sender, receiver = world.transport(), world.transport()
        attached(world, sender, FIRST)
        got = attached(world, receiver, SECOND)
        receiver.send(SECOND, FIRST, b"\x01\x00")

        def tick():
            sender.send(FIRST, SECOND, b"\x01\x00")
            world.call_later(0.1, tick)

        world.call_later(0.05, tick)
        world.call_at(1.0, receiver.cut)
        world.call_at(3.0, receiver.restore)
        world.run_for(5)
        times = [when for when, _ in got]
        assert times[:10] == pytest.approx([0.05 + number / 10 for number in range(10)])
        assert not [when for when in times if 1 < when < 3]
        assert len([when for when in times if when > 3]) == 20

    def test_what_is_under_way_to_a_process_that_is_cut_is_lost(self, world):
        sender, receiver = world.transport(Link(delay=0.5)), world.transport()
        got = attached(world, receiver, SECOND)
        sender.send(FIRST, EVERYBODY, b"\x01\x00")
        world.run_for(0.25)
        receiver.cut()
        world.run_for(1)
        assert not got
        assert sum(receiver.lost.values()) == 1

    def test_a_process_that_is_gone_and_another_with_its_address(self, world):
        asker = component(world.transport(), SECOND)
        former = world.transport()
        component(former, FIRST, "former")
        names = []

        def ask():
            asker.query(
                FIRST,
                QueryIdentification(query_type=4),
                ReportIdentification,
                lambda report, _: names.append(report.identification),
                retries=0,
            )

        ask()
        world.run_for(1)
        former.close()
        ask()
        world.run_for(2)
        assert names == ["former"]
        component(world.transport(), FIRST, "later")
        for _ in range(15):
            world.run_for(1)
            ask()
        world.run_for(1)
        assert names[-1] == "later"

    def test_components_find_each_other(self, world):
        component(world.transport(LOSSY), FIRST, register_services=True)
        asker = component(world.transport(LOSSY), SECOND)
        found = []
        asker.discover(
            "urn:jaus:jss:core:Liveness", lambda provider: found.append(provider.address)
        )
        world.run_until(lambda: FIRST in found, limit=60)

    def test_what_goes_to_where_nobody_is(self, world):
        sender, receiver = world.transport(), world.transport()
        attached(world, receiver, SECOND)
        receiver.send(SECOND, EVERYBODY, b"\x01\x00")
        attached(world, sender, FIRST)
        world.run_for(1)
        receiver.close()
        sender.send(FIRST, SECOND, b"\x01\x00")
        world.run_for(1)
        assert sender.lost[FIRST, SECOND] == 1


class TestLoss:
    def test_questions(self, world, pair):
        answered, failed = [], []
        for number in range(200):
            world.call_at(
                number * 0.5,
                lambda: pair[0].query(
                    SECOND,
                    QueryStatus(),
                    ReportStatus,
                    lambda *_: answered.append(1),
                    on_failure=lambda: failed.append(1),
                ),
            )
        world.run_for(110)
        # Both ways of both processes: 0.8 ** 4 of the rounds, four of them each.
        assert len(answered) + len(failed) == 200
        assert len(answered) > 0.8 * 200

    def test_an_event_goes_on_for_minutes(self, world, pair):
        times = []
        pair[0].subscribe(
            SECOND, QueryTime(3), ReportTime, lambda *_: times.append(world.now()), rate=10
        )
        world.run_for(300)
        # 0.64 of 10 a second arrive, less what is passed over as late.
        assert 1500 < len(times) < 2100
        assert max(b - a for a, b in pairwise(times)) < 5

    def test_control_survives(self, world):
        without_time = [service for service in CORE if not service.urn.endswith("Time")]
        vehicle = component(world.transport(LOSSY), FIRST, services=without_time, control_timeout=2)
        operator = component(world.transport(LOSSY), SECOND)
        obeyed, states = [], []
        vehicle.handle(SetTime, lambda *_: obeyed.append(world.now()), when=Guard.READY)
        session = operator.control(FIRST, authority=127)
        world.run_until(lambda: session.state is ControlState.READY, limit=10)

        def drive():
            states.append(session.state is ControlState.READY)
            operator.send(SetTime(time_stamp=SetTime.TimeStamp(minutes=7)), FIRST)
            world.call_later(0.1, drive)

        drive()
        world.run_for(600)
        assert sum(states) / len(states) > 0.99
        # One of five is lost, and few more come behind a later one.
        assert 0.7 * 6000 < len(obeyed) < 0.85 * 6000
        assert vehicle.controller == SECOND
        assert "access_control.timed_out" not in world.counters.snapshot()

    @pytest.mark.parametrize("size", [10_000, 150_000])
    def test_large_messages_arrive_whole(self, world, size):
        settings = TransportSettings(acknowledge_retries=12, acknowledge_timeout=0.3)
        sender, receiver = (world.transport(LOSSY, settings=settings) for _ in range(2))
        attached(world, sender, FIRST)
        got = attached(world, receiver, SECOND)
        body = bytes(number % 251 for number in range(size))
        results = []
        sender.send(FIRST, SECOND, b"\x01\x00" + body, acknowledge=True, on_result=results.append)
        world.run_until(lambda: results, limit=120)
        assert results == [True]
        assert [payload for _, payload in got] == [b"\x01\x00" + body]
        assert sender.lost[FIRST, SECOND] > 0
