"""Messages that a component takes and gives encoded: nobody decodes or encodes them on the way."""

from typing import Any

import pytest

from jausml.runtime import Guard
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import CreateCommandEvent, QueryTime, ReportStatus, ReportTime, SetTime
from jausml.runtime.wire.message import DecodeError, Message

NOON = ReportTime(
    time_stamp=ReportTime.TimeStamp(hour=12), date_stamp=ReportTime.DateStamp(month=3)
)


class Taken(list[Any]):
    """What a callback got."""

    def __call__(self, message: Any, sender: JausAddress) -> None:
        self.append((message, str(sender)))


def refuse(payload: bytes, _sender: JausAddress) -> None:
    raise DecodeError("test", f"{len(payload)} bytes")


def fail(_payload: bytes, _sender: JausAddress) -> None:
    raise RuntimeError("on purpose")


@pytest.fixture
def component(world: Any) -> Any:
    return world.component("1.1.1")


class TestListening:
    def test_the_bytes_come_as_they_were_sent(self, world, component):
        payloads, messages = Taken(), Taken()
        component.on_payload(ReportTime, payloads)
        component.on_message(ReportTime, messages)
        component.start()
        world.probe("2.1.1").tell(component, NOON)
        assert payloads == [(NOON.encode(), "2.1.1")]
        assert messages == [(NOON, "2.1.1")]

    def test_what_a_callback_cannot_read_is_counted_as_ever(self, world, component):
        taken = Taken()
        for callback in (refuse, fail, taken):
            component.on_payload(ReportTime, callback)
        component.start()
        world.probe("2.1.1").tell(component, NOON)
        assert world.counters.drops() == {"component.bad_message": 1, "component.handler_failed": 1}
        assert len(taken) == 1


class TestHandling:
    @pytest.mark.parametrize("when", [Guard.READY, lambda _message: Guard.READY])
    def test_a_guard_holds(self, world, component, when):
        taken = Taken()
        component.handle_payload(SetTime, taken, when=when)
        component.start()
        world.probe("2.1.1").tell(component, SetTime())
        assert not taken
        assert world.counters.snapshot()["component.command_refused"] == 1

    def test_who_is_obeyed_in_ready_costs_no_decoding(self, world, component):
        taken, asked = Taken(), []

        def when(message: SetTime) -> Guard:
            asked.append(message)
            return Guard.ANY

        component.handle_payload(SetTime, taken, when=when)
        component.start()
        controller, other = world.component("2.1.1"), world.probe("3.1.1")
        controller.start()
        controller.control(component.address, authority=1)
        world.run(1.0)
        controller.send(SetTime(), component.address)
        world.settle()
        assert (len(taken), asked) == (1, [])
        other.send(SetTime(), component)
        world.settle()
        assert (len(taken), asked) == (2, [SetTime()])

    def test_a_message_has_one_handler(self, component):
        component.handle_payload(SetTime, Taken())
        with pytest.raises(ValueError, match="SetTime is handled already"):
            component.handle(SetTime, Taken())

    def test_a_command_event_gives_the_bytes(self, world, component):
        taken = Taken()
        component.handle_payload(SetTime, taken)
        component.start()
        probe = world.probe("2.1.1", strict=False)
        command = SetTime().encode()
        event = CreateCommandEvent(
            request_id=1, maximum_allowed_duration=1, command_message=command
        )
        probe.tell(component, event)
        assert taken == [(command, "2.1.1")]


class TestReports:
    @pytest.mark.parametrize("wanted", [0, 1, 2, 3, 0xFF])
    def test_bytes_are_cut_where_less_is_asked_for(self, world, component, wanted):
        component.provide(QueryTime, ReportTime, lambda _query, _sender: NOON.encode())
        component.start()
        (report,) = world.probe("2.1.1").ask(QueryTime(wanted), component)
        assert report.encode()[2] == wanted & 3

    def test_bytes_that_hold_no_more_than_is_asked_for_stay_as_they_are(self, world, component):
        part = ReportTime(date_stamp=NOON.date_stamp)
        component.provide(QueryTime, ReportTime, lambda _query, _sender: part.encode())
        component.start()
        (report,) = world.probe("2.1.1").ask(QueryTime(2), component)
        assert report == part

    def test_bytes_that_are_no_report_are_counted(self, world, component):
        component.provide(QueryTime, ReportTime, lambda _query, _sender: b"\x11\x40")
        component.start()
        assert world.probe("2.1.1").ask(QueryTime(1), component) == []
        assert world.counters.drops() == {"component.report_not_encodable": 1}

    def test_events_carry_bytes_as_they_are(self, world, component):
        part = ReportTime(date_stamp=NOON.date_stamp).encode()
        component.provide(QueryTime, ReportTime, lambda _query, _sender: part)
        component.start()
        client = world.started("2.1.1")
        taken = Taken()
        for wanted in (3, 2, 1):
            client.subscribe(component.address, QueryTime(wanted), ReportTime, taken, payloads=True)
        world.run(0.1)
        cut = ReportTime().encode()
        assert taken == [(part, "1.1.1"), (part, "1.1.1"), (cut, "1.1.1")]

    def test_bytes_of_another_message_are_counted(self, world, component):
        component.provide(QueryTime, ReportTime, lambda _query, _sender: b"\x02\x40\x00")
        component.start()
        client = world.started("2.1.1")
        taken = Taken()
        client.subscribe(component.address, QueryTime(3), ReportTime, taken, payloads=True)
        world.run(0.1)
        assert not taken
        assert set(world.counters.drops()) == {"component.report_not_encodable"}

    def test_a_report_is_encoded_once_for_all_who_ask_for_the_same(
        self, world, component, monkeypatch
    ):
        present = [ReportTime()]
        component.provide(QueryTime, ReportTime, lambda _query, _sender: present[0])
        component.start()
        taken = Taken()
        clients = [world.component(f"2.1.{number}") for number in range(1, 8)]
        for number, client in enumerate(clients):
            client.start()
            wanted = 3 if number < 5 else 1
            client.subscribe(component.address, QueryTime(wanted), ReportTime, taken)
        world.run(0.1)
        taken.clear()
        encoded = []
        encode = ReportTime.encode
        monkeypatch.setattr(
            ReportTime, "encode", lambda report: encoded.append(report) or encode(report)
        )
        present[0] = NOON
        component.report_changed(ReportTime)
        world.settle()
        assert len(taken) == len(clients)
        assert encoded == [NOON, ReportTime(time_stamp=NOON.time_stamp)]


class TestClients:
    @pytest.fixture
    def client(self, world: Any, component: Any) -> Any:
        component.provide(QueryTime, ReportTime, lambda _query, _sender: NOON)
        component.start()
        return world.started("2.1.1")

    @pytest.mark.parametrize("payloads", [False, True])
    def test_a_subscription_shares_its_event(self, world, component, client, payloads):
        first, second = Taken(), Taken()
        client.subscribe(component.address, QueryTime(3), ReportTime, first, payloads=payloads)
        world.run(0.1)
        client.subscribe(component.address, QueryTime(3), ReportTime, second, payloads=True)
        world.run(0.1)
        expected: Message | bytes = NOON.encode() if payloads else NOON
        assert first == [(expected, "1.1.1")]
        assert second == [(NOON.encode(), "1.1.1")]

    def test_bad_reports_are_counted(self, world, component, client):
        taken = Taken()
        query = QueryTime(3)
        client.subscribe(component.address, query, ReportTime, refuse, payloads=True)
        client.subscribe(component.address, query, ReportStatus, taken, payloads=True)
        world.run(0.1)
        assert not taken
        assert set(world.counters.drops()) == {"event_client.bad_report"}

    @pytest.mark.parametrize(
        "event",
        [b"\xf1\x41", b"\xf1\x41\x00\x00\x02\x00\x00\x00\x11", b"\xf1\x41\x00\x00" + bytes(8)],
    )
    def test_an_event_of_a_wrong_size_is_counted(self, world, client, event):
        world.probe("3.1.1", strict=False).send_bytes(event, client)
        world.run(0.1)
        assert world.counters.drops() == {"component.bad_message": 1}

    @pytest.mark.parametrize("report", [b"", b"\x11"])
    def test_an_event_without_a_report_is_counted(self, world, component, client, report):
        for payloads in (False, True):
            client.subscribe(
                component.address, QueryTime(3), ReportTime, Taken(), payloads=payloads
            )
        world.run(0.1)
        header = b"\xf1\x41\x00\x01" + len(report).to_bytes(4, "little")
        world.send(component.address, client.address, header + report)
        world.run(0.1)
        assert world.counters.drops() == {"event_client.bad_report": 2}

    @pytest.mark.parametrize("payloads", [False, True])
    def test_a_query_is_answered_once(self, world, component, client, payloads):
        taken = Taken()
        client.query(component.address, QueryTime(3), ReportTime, taken, payloads=payloads)
        world.run(3.0)
        assert taken == [(NOON.encode() if payloads else NOON, "1.1.1")]

    def test_an_answer_that_cannot_be_read_is_counted(self, world, component, client):
        client.query(component.address, QueryTime(3), ReportTime, refuse, payloads=True)
        world.run(0.1)
        assert world.counters.drops() == {"component.bad_message": 1}
