"""Subscriptions whose provider restarts, refuses, falls silent, or loses reports."""

import pytest

from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress

from .event_support import PROVIDER, Inbox, kill, provider, pulses, statuses


class TestRecovery:
    @pytest.mark.parametrize("pause", [0.0, 0.5, 20.0])
    def test_periodic_event_of_a_restarted_provider(self, world, client, pause):
        first = provider(world)
        inbox = Inbox()
        pulses(client, inbox, rate=10)
        world.run(1.0)
        kill(world, first)
        world.run(pause)
        provider(world)
        world.run(5.0)
        inbox.clear()
        world.run(1.0)
        assert len(inbox) == pytest.approx(10, abs=1)

    def test_every_change_event_of_a_restarted_provider(self, world, client):
        first = provider(world)
        inbox = Inbox()
        statuses(client, inbox)
        world.run(1.0)
        kill(world, first)
        second = provider(world)
        world.run(11.0)
        assert len(inbox) == 2
        second.fail("broken")
        world.settle()
        assert inbox[-1].status == 4

    def test_silence_of_one_event_verifies_the_others(self, world, client):
        first = provider(world)
        inbox = Inbox()
        pulses(client, Inbox(), rate=10)
        world.settle()
        statuses(client, inbox)
        world.run(0.5)
        kill(world, first)
        provider(world)
        world.run(3.0)
        assert len(inbox) == 2

    def test_one_lost_event_verifies_the_others(self, world, client):
        first = provider(world)
        statuses(client, Inbox())
        world.run(5.0)
        late = Inbox()
        client.subscribe(PROVIDER, core.QueryControl(), core.ReportControl, late)
        world.run(1.0)
        kill(world, first)
        provider(world)
        world.run(10.0)
        assert len(late) == 2

    def test_silent_provider_of_an_every_change_event_is_noticed(self, world, client):
        first = provider(world)
        subscription = statuses(client, Inbox())
        world.run(1.0)
        kill(world, first)
        world.run(15.0)
        assert not subscription.active
        assert world.counters.snapshot()["event_client.lost"] == 1

    @pytest.mark.parametrize("pause", [0.0, 0.5, 3.0])
    def test_every_change_event_of_a_controlled_provider(self, world, client, pause):
        """Who controls it notices soon that it does not know its controller any more."""
        first = provider(world)
        inbox = Inbox()
        statuses(client, inbox)
        client.control(PROVIDER, authority=127)
        world.run(5.0)
        kill(world, first)
        world.run(pause)
        inbox.clear()
        provider(world)
        world.run(2.0)
        assert inbox

    def test_every_change_event_of_a_provider_that_speaks_after_a_silence(self, world, client):
        first = provider(world)
        inbox = Inbox()
        subscription = statuses(client, inbox)
        world.run(5.0)
        kill(world, first)
        inbox.clear()
        second = provider(world)
        second.send(core.ReportHeartbeatPulse(), client.address)
        world.run(1.0)
        assert inbox
        assert subscription.active

    def test_reports_after_a_silence_need_no_renewal(self, world, client):
        tested = provider(world)
        inbox = Inbox()
        statuses(client, inbox)
        world.run(5.0)
        world.log.clear()
        tested.fail("a change")
        world.run(1.0)
        assert len(inbox) == 2
        assert world.count(core.UpdateEvent.CODE) == 0

    def test_ids_that_a_restarted_provider_gives_to_other_queries(self, world, client):
        first = provider(world)
        control, status = Inbox(), Inbox()
        client.subscribe(PROVIDER, core.QueryControl(), core.ReportControl, control)
        world.run(0.5)
        statuses(client, status, rate=10)
        world.run(1.0)
        kill(world, first)
        second = provider(world)
        world.run(5.0)
        control.clear()
        world.probe("5.1.1").ask(core.RequestControl(authority_code=1), second)
        assert [report.subsystem_id for report in control] == [5]
        status.clear()
        world.run(1.0)
        assert len(status) == pytest.approx(10, abs=1)
        assert "event_client.bad_report" not in world.counters.snapshot()

    @pytest.fixture
    def second(self, world):
        """A client that begins anew, to which an event goes that it knows nothing of."""
        provider(world)
        first = world.started("2.1.1", services=())
        pulses(first, Inbox(), rate=10)
        world.run(1.0)
        kill(world, first)
        return world.started("2.1.1", services=())

    def test_events_from_before_our_own_restart(self, world, second):
        inbox = Inbox()
        pulses(second, inbox, rate=10)
        world.log.clear()
        world.run(1.0)
        assert len(inbox) == pytest.approx(11, abs=1)
        assert world.count(core.Event.CODE) == pytest.approx(11, abs=1)

    @pytest.mark.usefixtures("second")
    def test_events_that_nobody_wants_are_cancelled(self, world):
        world.run(1.0)
        world.log.clear()
        world.run(5.0)
        assert world.log == []

    def test_provider_that_confirms_and_does_not_report(self, world, client):
        tested = provider(world)
        tested.provide(core.QueryTime, core.ReportTime, lambda *_: None)
        client.subscribe(PROVIDER, core.QueryTime(), core.ReportTime, Inbox(), rate=10)
        world.run(300.0, step=0.1)
        assert world.count(core.CreateEvent.CODE) < 25


class TestRefusal:
    def test_is_counted_and_tried_again_slowly(self, world, client):
        tested = provider(world)
        inbox = Inbox()
        client.subscribe(PROVIDER, core.QueryTime(), core.ReportTime, inbox)
        world.run(31.0)
        assert world.count(core.RejectEventRequest.CODE) == pytest.approx(7, abs=1)
        assert world.counters.snapshot()["event_client.refused"] >= 6
        tested.provide(core.QueryTime, core.ReportTime, lambda *_: core.ReportTime())
        world.run(5.1)
        assert len(inbox) == 1

    @pytest.mark.parametrize("rate", [0.0, -1.0, 1093.0, float("nan")])
    def test_of_impossible_rates(self, client, rate):
        with pytest.raises(ValueError, match="rate"):
            pulses(client, Inbox(), rate=rate)

    def test_of_wildcards(self, client):
        with pytest.raises(ValueError, match="does not name one component"):
            client.subscribe(
                JausAddress(1, 1, 255), core.QueryStatus(), core.ReportStatus, Inbox(), rate=1
            )


class TestSilence:
    def test_is_told_once_until_reports_come_again(self, world, client):
        first = provider(world)
        silences = []
        inbox = Inbox()
        subscription = pulses(
            client,
            inbox,
            rate=10,
            silence_timeout=0.5,
            on_silence=lambda: silences.append(world.time),
        )
        world.run(3.0)
        assert silences == []
        last = world.time
        kill(world, first)
        world.run(10.0)
        assert silences == [pytest.approx(last + 0.5, abs=0.2)]
        assert subscription.silent
        provider(world)
        world.run(5.0)
        assert not subscription.silent
        assert len(silences) == 1

    def test_begins_with_the_subscription(self, world, client):
        silences = []
        statuses(
            client, Inbox(), silence_timeout=2.0, on_silence=lambda: silences.append(world.time)
        )
        start = world.time
        world.run(10.0)
        assert silences == [pytest.approx(start + 2.0, abs=0.05)]

    def test_ends_with_the_subscription(self, world, client):
        silences = []
        subscription = statuses(
            client, Inbox(), silence_timeout=2.0, on_silence=lambda: silences.append(1)
        )
        subscription.cancel()
        world.run(10.0)
        assert silences == []


class TestSequence:
    @pytest.fixture
    def probe(self, world):
        return world.probe(str(PROVIDER))

    def send(self, probe, client, numbers):
        (create,) = probe.take()
        probe.send(
            core.ConfirmEventRequest(
                request_id=create.request_id, event_id=4, confirmed_periodic_rate=0.0
            ),
            client,
        )
        report = core.ReportStatus(status=1, reserved=0).encode()
        for number in numbers:
            probe.send(
                core.Event(event_id=4, sequence_number=number, report_message=report), client
            )
        probe.take()

    @pytest.mark.parametrize(
        ("numbers", "missing"), [([5, 6, 7], 0), ([254, 255, 0, 1], 0), ([1, 3], 1), ([250, 4], 9)]
    )
    def test_gaps_are_counted(self, world, client, probe, numbers, missing):
        inbox = Inbox()
        statuses(client, inbox)
        self.send(probe, client, numbers)
        assert len(inbox) == len(numbers)
        assert world.counters.snapshot().get("event_client.sequence_gap", 0) == missing

    def test_old_reports_are_dropped(self, world, client, probe):
        inbox = Inbox()
        statuses(client, inbox)
        self.send(probe, client, [10, 11, 9, 12])
        assert len(inbox) == 3
        assert world.counters.snapshot()["event_client.out_of_order"] == 1

    def test_other_report_is_counted(self, world, client, probe):
        inbox = Inbox()
        client.subscribe(PROVIDER, core.QueryControl(), core.ReportControl, inbox)
        self.send(probe, client, [0])
        assert inbox == []
        assert world.counters.snapshot()["event_client.bad_report"] == 1

    def test_who_answers_twice_is_not_asked_without_a_pause(self, world, client, probe):
        statuses(client, Inbox())
        for _ in range(100):
            requests = probe.take(core.CreateEvent)
            for request in (*requests, *requests):
                probe.send(core.ConfirmEventRequest(request.request_id, 4, 0.0), client)
        assert world.count(core.CreateEvent.CODE) == 1
        world.run(1.1)
        assert world.count(core.CreateEvent.CODE) == 2
