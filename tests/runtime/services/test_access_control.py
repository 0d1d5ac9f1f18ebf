"""AccessControl, row by row of the state table of AS5710 v1.1."""

from __future__ import annotations

import pytest

from jausml.runtime.core_messages import (
    ConfirmControl,
    QueryAuthority,
    QueryControl,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportAuthority,
    ReportControl,
    ReportTimeout,
    RequestControl,
    SetAuthority,
    SetEmergency,
)


@pytest.fixture
def server(world):
    component = world.component("1.1.1", default_authority=10, control_timeout=5)
    component.start()
    return component


@pytest.fixture
def client(world):
    return world.probe("2.1.1")


@pytest.fixture
def rival(world):
    return world.probe("3.1.1")


def request(code):
    return RequestControl(authority_code=code)


ACCEPTED = ConfirmControl(response_code=0)
NOT_AVAILABLE = ConfirmControl(response_code=1)
INSUFFICIENT = ConfirmControl(response_code=2)
RELEASED = RejectControl(response_code=0)
RELEASE_REFUSED = RejectControl(response_code=1)


class TestNotControlled:
    def test_request_while_control_is_unavailable(self, server, client):
        server.control_available = False
        assert client.ask(request(200), server) == [NOT_AVAILABLE]
        assert server.controller is None

    def test_request_below_default_authority(self, server, client):
        assert client.ask(request(9), server) == [INSUFFICIENT]
        assert server.controller is None

    def test_request_is_accepted(self, server, client):
        assert client.ask(request(10), server) == [ACCEPTED]
        assert server.controller == client.address
        assert server.authority == 10

    def test_release_while_control_is_unavailable(self, server, client):
        server.control_available = False
        assert client.ask(ReleaseControl(), server) == [RELEASE_REFUSED]

    def test_release_by_the_client_that_set_the_emergency(self, server, client, rival):
        client.send(SetEmergency(emergency_code=1), server)
        assert client.ask(ReleaseControl(), server) == [RELEASED]
        assert rival.ask(ReleaseControl(), server) == [RELEASE_REFUSED]

    def test_release_is_confirmed(self, server, client):
        assert client.ask(ReleaseControl(), server) == [RELEASED]

    def test_authority_is_the_default_one_on_entry(self, server, client):
        client.ask(request(200), server)
        client.ask(ReleaseControl(), server)
        assert server.authority == 10


class TestControlled:
    @pytest.fixture(autouse=True)
    def controlled(self, server, client):
        assert client.ask(request(100), server) == [ACCEPTED]

    def test_request_while_control_is_unavailable(self, server, client, rival):
        server.control_available = False
        assert rival.ask(request(255), server) == [NOT_AVAILABLE]
        assert client.ask(request(100), server) == [NOT_AVAILABLE]
        assert server.controller == client.address

    def test_request_of_the_controller_keeps_control_alive(self, world, server, client):
        for _ in range(3):
            world.run(4.0)
            assert client.ask(request(100), server) == [ACCEPTED]
        assert server.controller == client.address

    def test_request_of_the_controller_sets_its_authority(self, server, client):
        assert client.ask(request(50), server) == [ACCEPTED]
        assert server.authority == 50

    def test_request_of_the_controller_below_default_authority(self, server, client):
        assert client.ask(request(9), server) == [RELEASED]
        assert server.controller is None

    def test_higher_authority_preempts(self, server, client, rival):
        client.take()
        assert rival.ask(request(101), server) == [ACCEPTED]
        assert client.take() == [RELEASED]
        assert server.controller == rival.address
        assert server.authority == 101

    @pytest.mark.parametrize("code", [99, 100])
    def test_equal_or_lower_authority_does_not_preempt(self, server, client, rival, code):
        assert rival.ask(request(code), server) == [INSUFFICIENT]
        assert client.take() == []
        assert server.controller == client.address

    @pytest.mark.parametrize("code", [10, 60, 100])
    def test_controller_lowers_its_authority(self, server, client, code):
        assert client.ask(SetAuthority(authority_code=code), server) == []
        assert server.authority == code

    @pytest.mark.parametrize("code", [9, 101])
    def test_authority_out_of_bounds_is_ignored(self, server, client, code):
        assert client.ask(SetAuthority(authority_code=code), server) == []
        assert server.authority == 100

    def test_authority_of_others_is_ignored(self, server, rival):
        assert rival.ask(SetAuthority(authority_code=50), server) == []
        assert server.authority == 100

    def test_release_by_the_controller(self, server, client):
        assert client.ask(ReleaseControl(), server) == [RELEASED]
        assert server.controller is None

    def test_release_by_the_controller_while_unavailable(self, server, client):
        server.control_available = False
        assert client.ask(ReleaseControl(), server) == [RELEASE_REFUSED]
        assert server.controller == client.address

    def test_release_by_others_is_ignored(self, server, client, rival):
        assert rival.ask(ReleaseControl(), server) == []
        assert server.controller == client.address

    def test_control_times_out(self, world, server, client):
        world.run(4.9)
        assert server.controller == client.address
        world.run(0.2)
        assert server.controller is None
        assert client.take() == [RELEASED]

    def test_control_does_not_time_out_while_unavailable(self, world, server, client):
        server.control_available = False
        world.run(11.0)
        assert server.controller == client.address
        server.control_available = True
        world.run(5.1)
        assert server.controller is None

    def test_new_controller_has_the_whole_timeout(self, world, server, rival):
        world.run(4.0)
        rival.ask(request(101), server)
        world.run(4.0)
        assert server.controller == rival.address


class TestQueries:
    def test_uncontrolled(self, server, client):
        assert client.ask(QueryControl(), server) == [
            ReportControl(subsystem_id=0, node_id=0, component_id=0, authority_code=10)
        ]

    def test_controlled(self, server, client, rival):
        client.ask(request(77), server)
        assert rival.ask(QueryControl(), server) == [
            ReportControl(subsystem_id=2, node_id=1, component_id=1, authority_code=77)
        ]
        assert rival.ask(QueryAuthority(), server) == [ReportAuthority(authority_code=77)]

    def test_timeout_is_in_seconds(self, server, client):
        assert client.ask(QueryTimeout(), server) == [ReportTimeout(timeout=5)]


def test_timeout_of_zero_never_ends_control(world, client):
    server = world.component("1.1.1", control_timeout=0)
    server.start()
    client.ask(request(1), server)
    world.run(600.0, step=10.0)
    assert server.controller == client.address
    assert client.ask(QueryTimeout(), server) == [ReportTimeout(timeout=0)]


def test_stop_tells_the_controller(server, client):
    client.ask(request(100), server)
    server.stop()
    assert client.take()[-1] == RELEASED
    assert client.ask(QueryControl(), server) == []


def test_component_without_access_control_ignores_requests(world, client):
    server = world.component("1.1.1", services=())
    server.start()
    assert client.ask(request(255), server) == []
    assert world.counters.snapshot()["component.unknown_message"] == 1
