"""Joined reports: which one a translation is given, whom it is taken from, what is dropped."""

import pytest

from jausml.runtime import PeerSearch
from jausml.runtime.bridge.connections.report_join import ReportJoin
from jausml.runtime.messages import QueryTimeout, ReportTimeout

from .bridge_support import (
    CORE,
    OTHER,
    OWN,
    PEER,
    Number,
    event,
    message_connection,
    minutes,
    values,
)
from .bridge_support import peer_component as peer


def sum_of_both(source, control=None):
    """The time-out of events, and a hundred times that of control; -1 stands for none fresh."""
    return Number(source.timeout + 100.0 * (-1 if control is None else control.timeout))


def join(**options):
    options.setdefault("query", QueryTimeout())
    options.setdefault("freshness", 0.5)
    if options["query"] is not None:
        options.setdefault("rate", 10.0)
    return ReportJoin("control", ReportTimeout, **options)


def connection(**options):
    return event(translate=sum_of_both, rate=5.0, joins=[join(**options)])


def published(setting):
    return setting.ros.numbers("timeout")


def test_main_report_drives_and_the_joined_one_is_given(world, setting):
    peer(world, event_timeout=3, control_timeout=7)
    setting.open(connection(rate=50.0, drop=True))
    world.run(2.0)
    assert set(published(setting)) == {703.0}
    assert 9 <= len(published(setting)) <= 12


@pytest.mark.parametrize("is_asked", [False, True])
def test_joined_report_of_a_component_that_is_searched_for(world, setting, is_asked):
    search = PeerSearch(("urn:jaus:jss:core:AccessControl",))
    joined = join(is_asked=is_asked, drop=True)
    made = setting.open(
        event(translate=sum_of_both, rate=5.0, peers=search, joins=[joined]), services=CORE
    )
    world.run(2.0)
    assert published(setting) == []
    found = world.started(str(PEER), event_timeout=3, control_timeout=7)
    world.run(20.0)
    assert set(published(setting)) == {703.0}
    assert dict(made.describe_peers())["search"] == f"bound to {found.address}"


def test_joined_report_that_is_asked_for_by_queries(world, setting):
    peer(world, event_timeout=3, control_timeout=7)
    setting.open(connection(is_asked=True, drop=True))
    world.run(1.0)
    assert set(published(setting)) == {703.0}
    assert 9 <= world.count(QueryTimeout.CODE) <= 12


def test_nothing_is_published_without_what_is_needed(world, setting):
    peer(world, event_timeout=3)
    made = setting.open(connection(peers=[OTHER], drop=True))
    world.run(1.0)
    assert published(setting) == []
    assert setting.drops(made) == {"stale_join_control": made.statistics.arrivals}
    assert made.statistics.arrivals >= 4
    world.run(1.1)
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("warning", "nothing fresh from control")
    assert values(status)["join control age (s)"] == "never"


def test_one_of_two_components_dies_and_comes_back(world, setting):
    peer(world, event_timeout=3)
    other = peer(world, OTHER, control_timeout=8)
    made = setting.open(connection(peers=[OTHER], drop=True))
    world.run(2.0)
    before = len(published(setting))
    assert before >= 8
    other.stop()
    world.run(3.0)
    after = len(published(setting))
    assert after - before <= 4  # as long as the last report was fresh
    assert made.stale_joins() == ["control"]
    status = setting.ros.statuses[-1]["timeout"]
    assert (status.level, status.message) == ("warning", "nothing fresh from control")
    assert float(values(status)["join control age (s)"]) > 0.5
    peer(world, OTHER, control_timeout=9)
    world.run(70.0)  # the event is created anew when it would have been renewed
    assert published(setting)[-1] == 903.0
    assert made.stale_joins() == []


def test_reports_that_are_sent_unasked_count_from_their_sender_alone(world, setting):
    made = setting.open(
        message_connection(
            lambda source, control: Number(source.time_stamp.minutes + 100.0 * control.timeout),
            peers=[PEER],
            joins=[join(query=None, peers=[OTHER], drop=True)],
        )
    )
    world.probe("5.1.1").tell(OWN, ReportTimeout(timeout=9))
    assert setting.drops(made) == {"unexpected_source": 1}
    assert made.stale_joins() == ["control"]
    world.probe(str(OTHER)).send(ReportTimeout(timeout=8), OWN)
    world.probe(str(PEER)).tell(OWN, minutes(3))
    assert setting.ros.numbers("times") == [803.0]


def test_parameters_of_a_joined_report(world, setting):
    peer(world, event_timeout=3, control_timeout=7)
    peer(world, OTHER, control_timeout=8)
    setting.ros.parameters |= {
        "timeout.control.peers": [str(PEER)],
        "timeout.control.rate": 2.0,
        "timeout.control.freshness": 0.125,
    }
    made = setting.open(connection(peers=[OTHER]))
    world.run(4.0)
    assert set(published(setting)) == {-97.0, 703.0}
    setting.ros.changed["timeout.control.freshness"](5.0)
    setting.ros.changed["timeout.control.rate"](20.0)
    count = len(published(setting))
    world.run(1.0)
    assert set(published(setting)[count:]) == {703.0}
    assert made.stale_joins() == []


def test_peers_that_a_parameter_gives_the_connection_are_those_of_its_joins(world, setting):
    peer(world, OTHER, event_timeout=4, control_timeout=8)
    setting.ros.parameters["timeout.peers"] = [str(OTHER)]
    setting.open(connection(drop=True))
    world.run(1.0)
    assert set(published(setting)) == {804.0}


def test_a_joined_report_that_cannot_be_read_is_counted(world, setting):
    peer(world, event_timeout=3)
    made = setting.open(connection(query=None, peers=[OTHER]))
    world.probe(str(OTHER)).send_bytes(ReportTimeout.CODE.to_bytes(2, "little"), OWN)
    world.run(0.4)
    assert setting.drops(made) == {"not_decodable": made.statistics.arrivals - 1}
    assert made.statistics.arrivals > 1
