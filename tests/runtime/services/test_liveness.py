"""Liveness, and what every component does with messages that are not for it."""

import pytest

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.messages import (
    QueryHeartbeatPulse,
    QueryStatus,
    ReportHeartbeatPulse,
    ReportStatus,
    RequestControl,
)


@pytest.fixture
def server(world):
    return world.started("1.1.1")


@pytest.fixture
def client(world):
    return world.probe("2.1.1")


@pytest.mark.usefixtures("server")
def test_queries_to_everyone_are_answered(client):
    assert client.ask(QueryHeartbeatPulse(), BROADCAST) == [ReportHeartbeatPulse()]


def test_bad_body_is_counted_and_ignored(world, server, client):
    client.send_bytes(RequestControl.CODE.to_bytes(2, "little"), server)
    assert client.take() == []
    assert world.counters.snapshot()["component.bad_message"] == 1


def test_listeners_get_messages_next_to_the_handler(server, client):
    heard = []
    server.on_message(RequestControl, lambda message, _sender: heard.append(message))
    server.on_message(ReportStatus, lambda message, _sender: heard.append(message))
    client.tell(server, RequestControl(authority_code=3), ReportStatus(status=1, reserved=0))
    assert heard == [RequestControl(authority_code=3), ReportStatus(status=1, reserved=0)]
    assert server.controller == client.address


def test_one_handler_for_each_message(server):
    with pytest.raises(ValueError, match="handled already"):
        server.provide(QueryStatus, ReportStatus, lambda *_: None)


def test_component_needs_an_address_of_its_own(world):
    with pytest.raises(ValueError, match="does not name one component"):
        world.component("1.255.1")


def test_component_starts_once(server):
    with pytest.raises(RuntimeError, match="runs already"):
        server.start()
    assert server.address == JausAddress(1, 1, 1)


def test_a_component_that_stops_while_it_starts_sends_no_heartbeat(world):
    component = world.component("1.1.1", heartbeat_rate=1.0)
    component.when_started(component.stop)
    component.start()
    world.run(3.0)
    assert world.count(ReportHeartbeatPulse.CODE) == 0
