"""Budgets of events: who gives way, who gets how much, and what a client without proof gets."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime import ComponentSettings
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.budgets import Held, fair_rates, who_gives_way

ROBOT = JausAddress(1, 1, 1)
RATES = st.floats(0.1, 1092.0)
PLACES = st.tuples(*[st.integers(0, 3)] * 3).map(lambda place: (place[0], place[:2], place))


def create(rate=20.0, query=core.QueryStatus):
    return core.CreateEvent(1, core.CreateEvent.EventType.PERIODIC_SC, rate, query().encode())


def reports(probe):
    return sum(isinstance(message, core.Event) for message in probe.take())


def kinds(answers):
    return {type(answer) for answer in answers}


class TestShares:
    @given(st.lists(st.tuples(PLACES, RATES), min_size=1, max_size=40), st.floats(1.0, 5000.0))
    def test_they_are_what_is_asked_for_or_fill_the_budget(self, asked, capacity):
        held = [Held(n, place, wanted=rate) for n, (place, rate) in enumerate(asked)]
        shares = dict(fair_rates(held, capacity))
        assert shares.keys() == set(range(len(asked)))
        assert all(shares[claim.item] <= claim.wanted * (1 + 1e-9) for claim in held)
        total = sum(claim.wanted for claim in held)
        assert sum(shares.values()) == pytest.approx(min(total, capacity))

    @given(st.lists(st.tuples(PLACES, RATES), min_size=1, max_size=40), RATES)
    def test_a_host_that_asks_for_less_than_its_share_gets_all(self, asked, rate):
        held = [Held(n, place, wanted=wanted_rate) for n, (place, wanted_rate) in enumerate(asked)]
        honest = Held("honest", ("host", "endpoint", "id"), wanted=rate)
        hosts = {claim.place[0] for claim in held} | {"host"}
        shares = dict(fair_rates([*held, honest], rate * len(hosts)))
        assert shares["honest"] == pytest.approx(rate)


ASKER = Held(None, ("a", "a1", "a11"))


def three(*place, **claim):
    return [Held(n, place, **claim) for n in range(3)]


SLOTS = {
    "the largest host gives the newest": (
        [*three("b", "b1", "b11"), Held(9, ("c", "c1", "c11"))], ASKER, 2),
    "nobody gives when the asker has as many": (
        [Held(1, ("b", "b1", "b11")), Held(2, ASKER.place)], ASKER, None),
    "within a host the largest endpoint gives": (
        [*three("a", "a2", "x"), Held(9, ("b", "b1", "x"))], ASKER, 2),
    "what is not proved goes before what is": (
        [*three("b", "b1", "b11"), Held(9, ("c", "c1", "c11"), is_proved=False)], ASKER, 9),
    "one without proof takes nothing from those who have one": (
        three("b", "b1", "b11"), Held(None, ASKER.place, is_proved=False), None),
    "what is kept gives to nobody": (three("b", "b1", "b11", is_kept=True), ASKER, None),
    "who is kept gets in any case": (
        [*three("b", "b1", "b11", is_kept=True), Held(9, ASKER.place)],
        Held(None, ASKER.place, is_kept=True), 9),
}  # fmt: skip


@pytest.mark.parametrize(("held", "asker", "expected"), SLOTS.values(), ids=SLOTS)
def test_who_gives_a_slot(held, asker, expected):
    assert who_gives_way(held, asker) == expected


class TestService:
    def test_a_client_without_proof_gets_one_report_a_second_and_then_none(self, world):
        tested, client = world.component("1.1.1"), world.probe("3.1.1")
        tested.start()
        world.unproved.add(client.address)
        assert core.ConfirmEventRequest in kinds(client.ask(create(100.0), tested))
        world.run(4.9)
        assert 3 <= reports(client) <= 6
        world.run(1.0)
        client.take()
        world.run(10.0)
        assert reports(client) == 0
        assert world.counters.snapshot()["events.never_proved"] == 1

    def test_an_event_that_has_ended_is_judged_no_more(self, world):
        tested, client = world.component("1.1.1"), world.probe("3.1.1")
        tested.start()
        world.unproved.add(client.address)
        (confirmed,) = (
            message
            for message in client.ask(create(), tested)
            if isinstance(message, core.ConfirmEventRequest)
        )
        client.ask(core.CancelEvent(request_id=2, event_id=confirmed.event_id), tested)
        world.run(10.0)
        assert "events.never_proved" not in world.counters.snapshot()

    def test_proof_gives_it_its_rate_at_once(self, world):
        tested, client = world.component("1.1.1"), world.probe("3.1.1")
        tested.start()
        world.unproved.add(client.address)
        client.ask(create(20.0), tested)
        world.unproved.clear()
        for listener in world.proof_listeners:
            listener(client.address)
        client.take()
        world.run(10.0)
        assert 195 <= reports(client) <= 205

    def test_a_full_service_serves_a_host_that_has_nothing(self, world):
        tested = world.started("1.1.1", max_events=4)
        greedy = [world.probe(f"9.1.{n}") for n in range(1, 5)]
        for probe in greedy:
            assert core.ConfirmEventRequest in kinds(probe.ask(create(), tested))
        honest = world.probe("3.1.1")
        assert core.ConfirmEventRequest in kinds(honest.ask(create(), tested))
        assert core.ConfirmEventRequest in kinds(greedy[-1].take())
        # It has more than its share, and so gets no further one.
        assert kinds(greedy[-1].ask(create(), tested)) == {core.RejectEventRequest}
        assert world.counters.snapshot()["events.gave_way"] == 1

    def test_the_controller_gets_a_slot_in_any_case(self, world):
        tested = world.started("1.1.1", max_events=2)
        operator, other = world.probe("3.1.1"), world.probe("3.1.2")
        operator.ask(core.RequestControl(authority_code=9), tested)
        assert world.is_kept(operator.address)
        for query in (core.QueryStatus, core.QueryTimeout):
            other.ask(create(query=query), tested)
        assert core.ConfirmEventRequest in kinds(operator.ask(create(), tested))

    def test_rates_above_the_budget_are_cut_where_most_is_asked_for(self, world):
        tested = world.started("1.1.1", event_rate_budget=100.0)
        greedy = [world.probe(f"9.1.{n}") for n in range(1, 4)]
        honest = world.probe("3.1.1")
        for probe in greedy:
            probe.ask(create(50.0), tested)
        honest.ask(create(20.0), tested)
        world.run(1.0)
        for probe in (*greedy, honest):
            probe.take()
        world.run(10.0)
        assert 195 <= reports(honest) <= 205
        assert 750 <= sum(map(reports, greedy)) <= 820
        assert world.counters.snapshot()["events.rate_cut"] == 1

    def test_events_that_are_made_again_and_again_get_no_more(self, world):
        tested = world.started("1.1.1", event_rate_budget=100.0)
        greedy = [world.probe(f"9.1.{n}") for n in range(1, 21)]
        for probe in greedy:
            probe.ask(create(1000.0), tested)
        world.run(0.1, step=0.001)
        for probe in greedy:
            probe.take()
        for probe in greedy * 10:
            probe.send(create(1000.0 - world.time % 1), tested)
            world.run(0.005, step=0.001)
        # A request is answered by a report as well, and 200 were sent in a second.
        assert sum(map(reports, greedy)) <= 200 + 150

    @pytest.mark.parametrize("budget", [0.0, -1.0, 1e9])
    def test_a_budget_that_is_none_is_refused(self, budget):
        with pytest.raises(ValueError, match="event_rate_budget"):
            ComponentSettings(event_rate_budget=budget)
