"""Subscriptions: creation, renewal, sharing."""

from itertools import pairwise

import pytest

from jausml.runtime import messages as core
from jausml.runtime.base.quirks import Quirk

from .event_support import PROVIDER, Inbox, kill, provider, pulses, statuses


@pytest.mark.parametrize("rate", [0.1, 1.0, 100.0, 200.0, 500.0, 1092.0])
def test_every_rate_of_the_standard_is_given(world, client, rate):
    provider(world)
    inbox = Inbox()
    pulses(client, inbox, rate=rate)
    world.run(100 / rate, step=0.1 / rate)
    assert len(inbox) == pytest.approx(101, abs=2)


def test_subscription_before_the_start(world):
    provider(world)
    late = world.component("2.1.1", services=())
    inbox = Inbox()
    statuses(late, inbox)
    silences = []
    cancelled = statuses(
        late, inbox, silence_timeout=1.0, on_silence=lambda: silences.append(world.time)
    )
    cancelled.cancel()
    world.run(5.0)
    assert inbox == []
    late.start()
    world.settle()
    assert len(inbox) == 1
    world.run(5.0)
    assert silences == []


def test_provider_that_comes_later(world, client):
    inbox = Inbox()
    subscription = statuses(client, inbox)
    world.run(30.0)
    assert not subscription.active
    assert world.count(core.CreateEvent.CODE) == pytest.approx(18, abs=2)
    provider(world)
    world.run(5.1)
    assert subscription.active
    assert len(inbox) == 1


def test_lost_confirmation_keeps_one_event(world, client):
    provider(world)
    confirmations = []

    def lost(_source, _destination, code):
        if code == core.ConfirmEventRequest.CODE:
            confirmations.append(code)
            return len(confirmations) == 1
        return False

    world.lost = lost
    inbox = Inbox()
    subscription = pulses(client, inbox, rate=5)
    world.run(3.0)
    assert subscription.active
    world.log.clear()
    world.run(2.0)
    assert world.count(core.Event.CODE) == pytest.approx(10, abs=1)
    assert world.count(core.CancelEvent.CODE) == 0


def test_events_hurry_the_confirmation(world, client):
    provider(world)
    world.lost = lambda *message: message[2] == core.ConfirmEventRequest.CODE
    subscription = pulses(client, Inbox(), rate=5)
    world.run(20.0)
    assert not subscription.active
    world.lost = lambda *_: False
    world.run(0.8)
    assert subscription.active


class TestSharing:
    def test_fan_out_adds_no_packets(self, world, client):
        provider(world)
        counts = []
        for subscribers in (1, 5):
            inboxes = [Inbox() for _ in range(subscribers)]
            shares = [pulses(client, inbox, rate=10) for inbox in inboxes]
            world.run(1.0)
            world.log.clear()
            world.run(5.0)
            counts.append(len(world.log))
            assert all(len(inbox) == pytest.approx(61, abs=1) for inbox in inboxes)
            for share in shares:
                share.cancel()
            world.run(1.0)
        assert counts[0] == counts[1]

    @pytest.mark.parametrize("rates", [(1, 20), (3, 20), (7, 10), (0.5, 1, 100), (5, 5)])
    def test_each_has_its_own_rate(self, world, client, rates):
        """Of one event, at the highest rate."""
        provider(world)
        times = [[] for _ in rates]
        for rate, heard in zip(rates, times, strict=True):
            pulses(client, lambda *_, heard=heard: heard.append(world.time), rate=rate)
        world.run(1.0)
        world.log.clear()
        for heard in times:
            heard.clear()
        world.run(10.0, step=0.002)
        assert world.count(core.Event.CODE) == pytest.approx(10 * max(rates), abs=2)
        for rate, heard in zip(rates, times, strict=True):
            assert len(heard) == pytest.approx(10 * rate, abs=1.5)
            gaps = [b - a for a, b in pairwise(heard)]
            assert max(gaps) <= 1 / rate + 1 / max(rates) + 0.01

    @pytest.mark.parametrize("is_first", [True, False])
    def test_every_change_beside_a_rate(self, world, client, is_first):
        """Each has what it asked for: the provider has one event for both, queries do the rest."""
        tested = provider(world)
        changes, periodic = Inbox(), Inbox()
        if is_first:
            statuses(client, changes)
        share = statuses(client, periodic, rate=10)
        world.run(1.0)
        if not is_first:
            statuses(client, changes)
        world.run(1.0)
        periodic.clear()
        world.run(2.0)
        assert len(periodic) == pytest.approx(20, abs=1)
        assert {change.status for change in changes} == {2}
        assert len(changes) == (1 if is_first else 2)  # what is known at once, and the first report
        changes.clear()
        tested.fail("broken")
        world.settle()
        assert [change.status for change in changes] == [4]
        world.run(0.2)
        assert periodic[-1].status == 4
        share.cancel()
        world.log.clear()
        world.run(5.0)
        assert world.count(core.QueryStatus.CODE) == world.count(core.ReportStatus.CODE) == 0
        assert len(changes) == 1

    def test_nothing_old_comes_at_a_rate_from_a_provider_that_is_gone(self, world, client):
        first = provider(world)
        periodic = Inbox()
        statuses(client, Inbox())
        statuses(client, periodic, rate=10)
        world.run(1.0)
        assert len(periodic) == pytest.approx(10, abs=2)
        kill(world, first)
        periodic.clear()
        world.run(3.0)
        assert periodic == []

    def test_highest_rate_wins(self, world, client):
        provider(world)
        slow, fast = Inbox(), Inbox()
        pulses(client, slow, rate=2)
        world.run(1.0)
        share = pulses(client, fast, rate=20)
        world.run(1.0)
        fast.clear()
        world.run(2.0)
        assert len(fast) == pytest.approx(40, abs=1)
        share.cancel()
        world.run(1.0)
        slow.clear()
        world.run(4.0)
        assert len(slow) == pytest.approx(8, abs=1)

    def test_later_subscriber_gets_the_last_report(self, world, client):
        provider(world)
        statuses(client, Inbox())
        world.settle()
        inbox = Inbox()
        statuses(client, inbox)
        assert inbox == []
        world.settle()
        assert len(inbox) == 1

    def test_event_is_cancelled_with_its_last_subscriber(self, world, client):
        provider(world)
        shares = [pulses(client, Inbox(), rate=10) for _ in range(2)]
        world.settle()
        shares[0].cancel()
        world.settle()
        assert world.count(core.CancelEvent.CODE) == 0
        shares[1].cancel()
        shares[1].cancel()
        world.settle()
        assert world.count(core.CancelEvent.CODE) == 1
        world.log.clear()
        world.run(5.0)
        assert world.log == []

    def test_other_queries_are_other_events(self, world, client):
        tested = provider(world)
        tested.provide(core.QueryTime, core.ReportTime, lambda *_: core.ReportTime())
        inboxes = []
        for fields in (1, 2):
            inboxes.append(Inbox())
            query = core.QueryTime(presence_vector=fields)
            client.subscribe(PROVIDER, query, core.ReportTime, inboxes[-1], rate=10)
        world.run(1.0)
        assert all(len(inbox) == pytest.approx(11, abs=1) for inbox in inboxes)

    def test_broken_subscriber_does_not_harm_the_others(self, world, client):
        provider(world)

        def broken(_report, _sender):
            raise RuntimeError("user code")

        pulses(client, broken, rate=10)
        inbox = Inbox()
        pulses(client, inbox, rate=10)
        world.run(1.0)
        assert len(inbox) == pytest.approx(11, abs=1)
        assert world.counters.snapshot()["component.handler_failed"] == len(inbox)


class TestRenewal:
    def test_at_half_of_the_timeout(self, world, client):
        provider(world, event_timeout=2)
        pulses(client, Inbox(), rate=1)
        world.run(1.0, step=0.1)
        assert world.count(core.QueryEventTimeout.CODE) == 1
        world.log.clear()
        world.run(601.0, step=0.1)
        assert world.count(core.CreateEvent.CODE) == 10

    def test_peer_without_timeout_messages(self, world, client):
        provider(world, event_timeout=1)
        world.lost = lambda *message: message[2] == core.QueryEventTimeout.CODE
        inbox = Inbox()
        pulses(client, inbox, rate=1)
        world.run(301.0, step=0.1)
        assert world.count(core.CreateEvent.CODE) == 11
        assert len(inbox) == pytest.approx(302, abs=1)

    def test_timeout_of_zero_needs_none(self, world, client):
        provider(world, event_timeout=0)
        pulses(client, Inbox(), rate=1)
        world.run(301.0, step=0.1)
        assert world.count(core.CreateEvent.CODE) == 1

    def test_every_change_is_checked_more_often(self, world, client):
        provider(world, event_timeout=0)
        inbox = Inbox()
        statuses(client, inbox)
        world.run(101.0, step=0.1)
        assert world.count(core.CreateEvent.CODE) == 11
        assert len(inbox) == 1, "the report that answers a renewal is no change"

    def test_no_peer_is_asked_by_what_it_need_not_know(self, world, client):
        # There are stacks that deadlock at the first UpdateEvent, which is optional for providers.
        provider(world, event_timeout=1)
        pulses(client, Inbox(), rate=1)
        statuses(client, Inbox())
        world.run(301.0, step=0.1)
        assert world.count(core.UpdateEvent.CODE) == 0

    def test_a_peer_that_has_just_confirmed_is_left_alone(self, world, client):
        provider(world)
        subscription = statuses(client, Inbox())
        world.settle()
        subscription._stream.verify()
        assert world.count(core.CreateEvent.CODE) == 1
        world.run(1.1)
        subscription._stream.verify()
        assert world.count(core.CreateEvent.CODE) == 2

    def test_one_lost_renewal_does_no_harm(self, world, client):
        provider(world)
        statuses(client, Inbox())
        world.run(9.0, step=0.1)
        updates = []

        def lost(_source, _destination, code):
            if code == core.CreateEvent.CODE:
                updates.append(code)
                return len(updates) == 1
            return False

        world.lost = lost
        world.run(3.0, step=0.1)
        assert len(updates) == 2

    def test_expiry_notice_creates_the_event_again(self, world, client):
        provider(world)
        subscription = statuses(client, Inbox())
        world.settle()
        world.lost = lambda *message: message[2] == core.CreateEvent.CODE
        world.run(65.0, step=0.1)
        world.lost = lambda *_: False
        world.run(15.0, step=0.1)
        assert subscription.active


def test_stop_cancels_events(world, client):
    provider(world)
    pulses(client, Inbox(), rate=10)
    statuses(client, Inbox())
    world.settle()
    client.stop()
    world.settle()
    assert world.count(core.CancelEvent.CODE) == 2
    world.log.clear()
    world.run(100.0, step=0.5)
    assert world.log == []


def test_second_cancel_does_no_harm_to_a_new_subscription(world, client):
    provider(world)
    old, new = Inbox(), Inbox()
    subscription = pulses(client, old, rate=10.0)
    world.run(1.0)
    subscription.cancel()
    pulses(client, new, rate=10.0)
    subscription.cancel()
    world.run(1.0)
    assert len(new) >= 9
    count = len(old)
    world.run(1.0)
    assert len(old) == count


def test_subscriber_that_another_one_cancels_hears_nothing_more(world, client):
    provider(world)
    heard = Inbox()
    pulses(client, lambda *_: second.cancel(), rate=10.0)
    second = pulses(client, heard, rate=10.0, silence_timeout=0.5)
    world.run(3.0)
    assert heard == []
    assert "event_client.silent" not in world.counters.snapshot()


def test_subscription_that_follows_a_cancelled_one_is_confirmed_at_once(world, client):
    provider(world)
    statuses(client, Inbox()).cancel()
    first = statuses(client, Inbox())
    world.settle()
    first.cancel()
    heard = Inbox()
    second = statuses(client, heard)
    world.settle()
    assert second.active
    assert len(heard) == 1
    assert world.count(core.UpdateEvent.CODE) == 0
    assert world.count(core.RejectEventRequest.CODE) == 0


class Doubling:
    """A provider that makes another event of each CreateEvent, and reports in all it has."""

    def __init__(self, world):
        self.world, self.probe, self.events = world, world.probe(str(PROVIDER)), {}
        self.made = 0

    def serve(self, client, seconds):
        """Answers, and reports ten times a second, for some time."""
        for _ in range(round(10 * seconds)):
            for message in self.probe.take():
                if isinstance(message, core.CreateEvent):
                    self.events[self.made] = 0
                    confirmation = core.ConfirmEventRequest(message.request_id, self.made, 0.0)
                    self.probe.send(confirmation, client)
                    self.made += 1
                elif isinstance(message, core.CancelEvent):
                    self.events.pop(message.event_id, None)
            for event_id, number in self.events.items():
                report = core.ReportStatus(status=1).encode()
                self.probe.send(core.Event(event_id, number, report), client)
                self.events[event_id] = number + 1 & 0xFF
            self.world.run(0.1)


def test_who_makes_another_event_of_each_request_is_not_taken_for_restarted(world):
    client = world.started("2.1.1", services=(), retry_min=0.5, check_interval=3.0)
    provider = Doubling(world)
    inbox = Inbox()
    statuses(client, inbox)
    provider.serve(client, 5.0)
    (quirk,) = world.quirks.of(PROVIDER)
    assert quirk == (Quirk.DOUBLED_EVENTS, "event 0 went on beside event 1")
    lost = world.counters.snapshot()["event_client.lost"]
    provider.serve(client, 20.0)
    assert provider.made >= 6  # it is renewed, in case that it is restarted
    assert len(provider.events) == 1  # and what is too much is cancelled
    assert world.counters.snapshot()["event_client.lost"] == lost
    assert len(inbox) > 200


def test_a_confirmation_is_as_good_as_an_acknowledgement(world, client):
    provider(world)
    subscription = statuses(client, Inbox())
    world.settle()
    assert subscription.active
    start = core.CreateEvent.CODE.to_bytes(2, "little") + b"\0"
    assert (client.address, PROVIDER, start) in world.answers
