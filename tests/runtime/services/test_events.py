"""Events beyond the rows of the table: rates, beats, expiry, changes of queries."""

import pytest

from jausml.runtime import JausComponent
from jausml.runtime import messages as core

from .state_tables import V1_1, core_services

PERIODIC, EVERY_CHANGE = 0, 1
STATUS = core.QueryStatus().encode()
PULSE = core.QueryHeartbeatPulse().encode()


@pytest.fixture
def server(world):
    return world.started("1.1.1", event_timeout=1, event_rate_min=1, event_rate_max=50)


@pytest.fixture
def client(world):
    return world.probe("2.1.1")


@pytest.fixture
def other(world):
    return world.probe("3.1.1")


def create(query, *, rate=None, request_id=7):
    return core.CreateEvent(
        request_id=request_id,
        event_type=EVERY_CHANGE if rate is None else PERIODIC,
        requested_periodic_rate=rate or 0.0,
        query_message=query,
    )


def update(event_id, query, *, rate=None, request_id=8):
    return core.UpdateEvent(
        request_id=request_id,
        event_type=EVERY_CHANGE if rate is None else PERIODIC,
        requested_periodic_rate=rate or 0.0,
        event_id=event_id,
        query_message=query,
    )


def created(client, server, query, *, rate=None):
    """Creates an event and returns its id."""
    confirm = client.ask(create(query, rate=rate), server)[0]
    assert isinstance(confirm, core.ConfirmEventRequest)
    return confirm.event_id


def code_of(messages):
    assert len(messages) == 1
    assert isinstance(messages[0], core.RejectEventRequest)
    return messages[0].response_code


class TestCreate:
    def test_same_query_of_the_same_client_updates(self, world, server, client):
        event_id = created(client, server, PULSE, rate=10)
        assert created(client, server, PULSE, rate=20) == event_id
        client.take()
        world.run(1.0)
        assert len(client.take()) == pytest.approx(20, abs=1)


class TestReject:
    def test_4_unknown_event_type(self, server, client):
        payload = bytearray(create(STATUS).encode())
        payload[3] = 2
        client.send_bytes(bytes(payload), server)
        assert code_of(client.take()) == 4

    def test_refused_update_leaves_the_event_as_it_was(self, world, server, client):
        event_id = created(client, server, PULSE, rate=10)
        assert code_of(client.ask(update(event_id, b"\xff\xff", rate=5), server)) == 5
        world.run(1.0)
        assert len(client.take()) == pytest.approx(10, abs=1)


class TestUpdate:
    def test_changes_the_query(self, server, client):
        event_id = created(client, server, STATUS)
        query = core.QueryAuthority().encode()
        _, event = client.ask(update(event_id, query), server)
        assert event.report_message == core.ReportAuthority(authority_code=0).encode()

    def test_renewals_of_a_periodic_event_keep_its_beat(self, world, server, client):
        event_id = created(client, server, PULSE, rate=1)
        client.take()
        for _ in range(10):
            world.run(0.5)
            client.send(update(event_id, PULSE, rate=1), server)
        events = client.take(core.Event)
        assert len(events) == pytest.approx(5, abs=1)


class TestDelivery:
    def test_no_report_now(self, world, server, client):
        server.provide(core.QueryTime, core.ReportTime, lambda *_: None)
        answer = client.ask(create(core.QueryTime(presence_vector=1).encode(), rate=10), server)
        assert [type(response) for response in answer] == [core.ConfirmEventRequest]
        world.run(1.0)
        assert client.take() == []
        assert client.ask(core.QueryTime(presence_vector=1), server) == []

    def test_provider_that_raises(self, world, server, client):
        def broken(_query, _sender):
            raise RuntimeError("user code")

        server.provide(core.QueryTime, core.ReportTime, broken)
        created(client, server, core.QueryTime(presence_vector=1).encode(), rate=10)
        world.run(1.0)
        assert world.counters.snapshot()["component.handler_failed"] >= 10
        assert client.ask(core.QueryStatus(), server) == [core.ReportStatus(status=2, reserved=0)]

    def test_provider_learns_query_and_client(self, server, client):
        asked = []
        server.provide(
            core.QueryTime, core.ReportTime, lambda query, sender: asked.append((query, sender))
        )
        query = core.QueryTime(presence_vector=2)
        client.ask(create(query.encode()), server)
        assert asked == [(query, client.address)]

    def test_missed_periods_are_not_made_up_for(self, world, server, client):
        created(client, server, PULSE, rate=50)
        client.take()
        world.time += 10.0
        assert len(client.take()) <= 2

    def test_periodic_rate_is_kept(self, world, server, client):
        created(client, server, PULSE, rate=50)
        client.take()
        world.run(10.0, step=0.003)
        assert len(client.take()) == pytest.approx(500, abs=2)

    def test_event_ids_are_unique_and_at_most_254(self, world, server):
        ids = set()
        for number in range(255):
            probe = world.probe(f"{100 + number}.1.1")
            ids.add(created(probe, server, STATUS))
        assert ids == set(range(255))
        assert code_of(world.probe("99.1.1").ask(create(STATUS), server)) == 3

    def test_events_end_with_the_component(self, world, server, client):
        created(client, server, PULSE, rate=10)
        server.stop()
        client.take()
        world.run(1.0)
        assert client.take() == []

    def test_stop_reports_the_status_shutdown(self, server, client):
        created(client, server, STATUS)
        client.take()
        server.stop()
        (event,) = client.take()
        assert event.report_message == core.ReportStatus(status=3, reserved=0).encode()


def _stamp(value):
    stamp = core.ReportTime.TimeStamp
    return stamp(milliseconds=value % 1000, seconds=value // 1000, minutes=0, hour=0, day=1)


def test_provider_that_stops_the_component_is_the_last_to_be_asked(world):
    class Unwilling(JausComponent):
        def host_time(self):
            self.stop()
            return super().host_time()

    services = core_services(V1_1, "Events", "Time")
    component = world.component("1.1.1", kind=Unwilling, services=services)
    client = world.probe("2.1.1")
    component.start()
    create = core.CreateEvent(
        request_id=1,
        event_type=PERIODIC,
        requested_periodic_rate=1.0,
        query_message=core.QueryTime(presence_vector=3).encode(),
    )
    heard = client.ask(create, component)
    assert [type(message) for message in heard] == [core.ConfirmEventRequest]
