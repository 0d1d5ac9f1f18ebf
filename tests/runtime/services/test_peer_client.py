"""Peers that are found by their services: choice, loss, newcomers, bounds."""

import pytest

from jausml.runtime import PeerChoice, PeerSearch, Scope, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients import peer_search
from jausml.runtime.clients.discovery_client import query_services
from jausml.runtime.messages import QueryHeartbeatPulse, QueryServiceList, ReportHeartbeatPulse
from jausml.runtime.services.discovery import report_services

from .conftest import CORE_SERVICES

SENSOR = "urn:jaus:jss:mobility:VelocityStateSensor"
DRIVER = "urn:jaus:jss:mobility:PrimitiveDriver"
OWN = "100.1.9"


def provider(world, address, *urns):
    services = (*CORE_SERVICES, *(ServiceIdentity(urn, 1, 0) for urn in urns or (SENSOR,)))
    return world.started(address, services=services, register_services=True)


def kill(world, component):
    """Lets a component vanish as a process that is killed."""
    world.detach(component.address)
    world.lost = lambda source, *_: source == component.address


class Searcher:
    """A component that searches for a time, and each set of peers that it was told."""

    def __init__(self, world, search, address=OWN, *, seconds=2):
        self.component = world.component(address)
        self.told = []
        self.component.find_peers(search, lambda peers: self.told.append(tuple(map(str, peers))))
        self.component.start()
        world.run(seconds)

    @property
    def peers(self):
        return self.told[-1] if self.told else ()


def search(*urns, **where):
    return PeerSearch(urns or (SENSOR,), **where)


def test_the_nearest_is_taken_of_those_that_answer_at_the_start(world):
    for address in ("7.1.1", "100.2.1", "100.1.7", "100.1.3"):
        provider(world, address)
    searcher = Searcher(world, search())
    assert searcher.told == [("100.1.3",)]


def test_one_node_then_one_subsystem_then_the_lowest_address(world):
    for address in ("300.1.1", "200.1.1"):
        provider(world, address)
    searcher = Searcher(world, search())
    assert searcher.peers == ("200.1.1",)
    second = Searcher(world, search(), "300.7.7")
    assert second.peers == ("300.1.1",)


@pytest.mark.parametrize(
    ("where", "expected"),
    [
        ({"subsystem": 200}, ("200.1.1", "200.2.1")),
        ({"subsystem": 200, "node": 2}, ("200.2.1",)),
        ({"node": 2}, ("100.2.1", "200.2.1")),
        ({"within": Scope.SUBSYSTEM}, ("100.1.1", "100.2.1")),
        ({"within": Scope.NODE}, ("100.1.1",)),
        ({}, ("100.1.1", "100.2.1", "200.1.1", "200.2.1")),
    ],
)
def test_all_within_a_place(world, where, expected):
    for address in ("100.1.1", "100.2.1", "200.1.1", "200.2.1"):
        provider(world, address)
    searcher = Searcher(world, search(choice=PeerChoice.ALL, **where))
    assert searcher.peers == expected


def test_every_named_service_must_be_provided(world):
    provider(world, "100.1.1")
    provider(world, "100.1.2", SENSOR, DRIVER)
    searcher = Searcher(world, search(SENSOR, DRIVER, choice=PeerChoice.ALL))
    assert searcher.peers == ("100.1.2",)


def test_who_searches_does_not_find_itself(world):
    component = world.component(OWN, services=(*CORE_SERVICES, ServiceIdentity(SENSOR, 1, 0)))
    told = []
    component.find_peers(search(), told.append)
    component.start()
    world.run(30)
    assert told == []


def test_a_newcomer_is_found_when_it_speaks_not_at_the_next_look_around(world):
    searcher = Searcher(world, search(), seconds=60)
    assert searcher.told == []
    provider(world, "200.1.1")
    world.run(2 * peer_search.COLLECTING_TIME)
    assert searcher.peers == ("200.1.1",)


def test_a_silent_newcomer_is_found_within_the_slowest_search(world):
    searcher = Searcher(world, search(), seconds=60)
    world.started("200.1.1", services=(*CORE_SERVICES, ServiceIdentity(SENSOR, 1, 0)))
    world.run(peer_search.SLOWEST_SEARCH + 2)
    assert searcher.peers == ("200.1.1",)


def test_a_peer_that_is_gone_is_replaced_by_another_one(world):
    first = provider(world, "100.1.1")
    provider(world, "200.1.1")
    searcher = Searcher(world, search())
    kill(world, first)
    world.run(10)
    assert searcher.told == [("100.1.1",), (), ("200.1.1",)]


def test_one_lost_check_is_no_loss(world):
    provider(world, "100.1.1")
    searcher = Searcher(world, search())
    world.lost = lambda *what: what[2] == QueryHeartbeatPulse.CODE
    world.run(peer_search.CHECK_INTERVAL * (peer_search.MISSED_CHECKS - 1.5))
    world.lost = lambda *_: False
    world.run(10)
    assert searcher.told == [("100.1.1",)]


def test_a_nearer_one_that_comes_later_changes_nothing(world):
    provider(world, "200.1.1")
    searcher = Searcher(world, search())
    provider(world, "100.1.1")
    world.run(30)
    assert searcher.told == [("200.1.1",)]


def test_all_takes_those_that_come_later_and_drops_those_that_go(world):
    first = provider(world, "100.1.1")
    searcher = Searcher(world, search(choice=PeerChoice.ALL))
    provider(world, "200.1.1")
    world.run(2)
    kill(world, first)
    world.run(10)
    assert searcher.told == [("100.1.1",), ("100.1.1", "200.1.1"), ("200.1.1",)]


def test_who_has_lost_a_peer_looks_around_at_once(world):
    first = provider(world, "100.1.1")
    searcher = Searcher(world, search(choice=PeerChoice.ALL), seconds=peer_search.STEADY_SEARCH)
    kill(world, first)
    for _ in range(2 * peer_search.MISSED_CHECKS):
        if searcher.peers:
            world.run(peer_search.CHECK_INTERVAL)
    asked = world.count(QueryServiceList.CODE)
    world.run(2 * peer_search.CHECK_INTERVAL)
    assert world.count(QueryServiceList.CODE) > asked


def test_the_first_that_answers_is_taken(world):
    provider(world, "200.1.1")
    searcher = Searcher(world, search(choice=PeerChoice.FIRST), seconds=0.1)
    provider(world, "100.1.1")
    world.run(5)
    assert searcher.told == [("200.1.1",)]


def test_a_dead_component_that_a_server_still_lists_is_not_taken(world):
    registry = world.probe("200.1.1", strict=False)
    searcher = Searcher(world, search(), seconds=0)
    dead = {JausAddress.parse("200.1.7"): (ServiceIdentity(SENSOR, 1, 0),)}
    everything = query_services()
    for _ in range(5):
        registry.send(report_services(everything, dead, 200), searcher.component)
        world.run(2)
    assert searcher.told == []


def test_inventions_of_a_peer_do_not_fill_the_memory(world):
    liar = world.probe("200.1.1", strict=False)
    searcher = Searcher(world, search(), seconds=0)
    world.lost = lambda *what: what[2] == QueryHeartbeatPulse.CODE
    everything = query_services()
    for node in range(1, 6):
        many = {
            JausAddress(200, node, number): (ServiceIdentity(SENSOR, 1, 0),)
            for number in range(1, 255)
        }
        liar.send(report_services(everything, many, 200), searcher.component)
    world.settle()
    assert searcher.told == []
    assert world.counters.snapshot()["peer_client.too_many_found"] == 5 * 254 - 1024


def test_connections_with_one_search_share_the_work(world):
    provider(world, "100.1.1")
    searcher = Searcher(world, search(), seconds=0)
    also = []
    searcher.component.find_peers(search(), also.append)
    world.run(2)
    assert also == [(JausAddress(100, 1, 1),)]
    late = []
    searcher.component.find_peers(search(), late.append)
    asked = world.count(QueryServiceList.CODE)
    world.run(2)
    assert late == [(JausAddress(100, 1, 1),)]
    assert world.count(QueryServiceList.CODE) == asked


def test_a_satisfied_search_asks_nobody(world):
    provider(world, "100.1.1")
    Searcher(world, search(), seconds=5)
    asked = world.count(QueryServiceList.CODE)
    world.run(100)
    assert world.count(QueryServiceList.CODE) == asked


def test_nothing_happens_after_the_stop(world):
    provider(world, "100.1.1")
    searcher = Searcher(world, search())
    searcher.component.stop()
    sent = len(world.log)
    world.run(10)
    assert not [entry for entry in world.log[sent:] if str(entry[0]) == OWN]


def test_a_report_of_whatever_is_found(world):
    found = provider(world, "100.1.1")
    silent, reports = [], []
    searcher = world.component(OWN)
    searcher.subscribe_to_found(
        search(),
        QueryHeartbeatPulse(),
        ReportHeartbeatPulse,
        lambda _report, sender: reports.append(str(sender)),
        rate=10.0,
        silence_timeout=1.0,
        on_silence=lambda sender: silent.append(str(sender)),
    )
    searcher.start()
    world.run(3)
    assert len(reports) >= 15
    kill(world, found)
    world.run(2)
    assert silent == ["100.1.1"]
    world.run(10)
    provider(world, "100.1.5")
    world.run(3)
    assert reports[-1] == "100.1.5"


def test_a_question_to_whatever_is_found(world):
    provider(world, "100.1.1")
    answers = []
    searcher = world.component(OWN)
    searcher.query_found(
        search(),
        QueryHeartbeatPulse(),
        ReportHeartbeatPulse,
        lambda _report, sender: answers.append(str(sender)),
    )
    searcher.start()
    world.run(5)
    assert answers == ["100.1.1"]


@pytest.mark.parametrize(
    "where", [{"subsystem": 65535}, {"subsystem": -1}, {"node": 255}, {"within": Scope.COMPONENT}]
)
def test_impossible_searches_are_refused(where):
    with pytest.raises(ValueError, match="nothing can be found"):
        search(**where)


@pytest.mark.parametrize(
    ("where", "text"),
    [
        ({}, "VelocityStateSensor"),
        ({"subsystem": 100, "node": 2}, "VelocityStateSensor on node 2 in subsystem 100"),
        ({"within": Scope.NODE}, "VelocityStateSensor of the same node"),
    ],
)
def test_words_for_people(where, text):
    assert str(search(**where)) == text
