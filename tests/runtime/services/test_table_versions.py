"""Core v1.0 and v1.1 with each other, row by row (AS5710 and AS5710A)."""

import pytest

from jausml.runtime import ControlState, Status
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.discovery_client import query_service_lists, query_services
from jausml.runtime.services.discovery import report_services

from ..conftest import reports_of
from .state_tables import CORE_NAMES, V1_0, V1_1, Row, Stage, after, core_services

SERVER = JausAddress(1, 1, 1)
SETTINGS = {"control_timeout": 0, "discovery_scope": 2, "event_timeout": 1}

# What a v1.0 client may send, and the answers (their classes) that both versions owe it.
EXCHANGES = [
    (core.RequestControl(authority_code=9), [core.ConfirmControl]),
    (core.QueryControl(), [core.ReportControl]),
    (core.QueryAuthority(), [core.ReportAuthority]),
    (core.QueryTimeout(), [core.ReportTimeout]),
    (core.Resume(), []),
    (core.QueryStatus(), [core.ReportStatus]),
    (core.Standby(), []),
    (core.CreateEvent(request_id=1, event_type=1, requested_periodic_rate=0.0,
        query_message=core.QueryStatus().encode()), [core.ConfirmEventRequest, core.Event]),
    (core.UpdateEvent(request_id=1, event_type=1, requested_periodic_rate=0.0, event_id=0,
        query_message=core.QueryStatus().encode()), [core.ConfirmEventRequest]),
    (core.QueryEvents(query_events_var=core.QueryEvents.AllEventsRec()), [core.ReportEvents]),
    (core.CancelEvent(request_id=1, event_id=0), [core.ConfirmEventRequest]),
    (core.QueryHeartbeatPulse(), [core.ReportHeartbeatPulse]),
    (core.QueryTime(presence_vector=3), [core.ReportTime]),
    (core.QueryIdentification(query_type=2), [core.ReportIdentification]),
    (core.QuerySubsystemList(), [core.ReportSubsystemList]),
    (query_services(), [core.ReportServices]),
    (core.SetEmergency(), [core.RejectControl]),
    (core.ClearEmergency(), []),
    (core.ReleaseControl(), [core.RejectControl]),
]  # fmt: skip

# What came with v1.1; a v1.0 component does not know it and says nothing.
ADDED = [core.QueryEventTimeout(), query_service_lists()]


def started(world, version):
    row = Row("start", when=after(0.1), version=version, settings=SETTINGS)
    stage = Stage(world, row)
    stage.do(after(1.0))
    return stage.component, stage.peers["client"]


@pytest.mark.parametrize("version", [V1_0, V1_1], ids=["v1.0", "v1.1"])
@pytest.mark.parametrize(
    "number", range(len(EXCHANGES)), ids=[f"{request.NAME}" for request, _ in EXCHANGES]
)
def test_messages_of_v1_0_are_served_by_both(world, version, number):
    component, client = started(world, version)
    for message, _ in EXCHANGES[:number]:
        client.ask(message, component)
    message, expected = EXCHANGES[number]
    assert [type(response) for response in client.ask(message, component)] == expected


@pytest.mark.parametrize("message", ADDED, ids=[added_message.NAME for added_message in ADDED])
def test_messages_that_v1_1_added(world, message):
    component, client = started(world, V1_1)
    assert len(client.ask(message, component)) == 1
    component.stop()
    old = world.started("5.1.1", services=core_services(V1_0, *CORE_NAMES), **SETTINGS)
    assert client.ask(message, old) == []


# ---- our clients at servers of v1.0 ----------------------------------------------------------


def old_robot(world, **settings):
    return world.started(
        str(SERVER), services=core_services(V1_0, *CORE_NAMES), **{"control_timeout": 4, **settings}
    )


def test_event_of_a_v1_0_provider_lives_on(world, client):
    old_robot(world)
    asked = core.QueryHeartbeatPulse(), core.ReportHeartbeatPulse
    reports = reports_of(client, SERVER, *asked, rate=1)
    world.run(600.0, step=0.25)
    assert len(reports) == pytest.approx(601, abs=2)
    assert world.count(core.CreateEvent.CODE) == 21, "once, and each half minute again"


def test_event_of_a_v1_0_provider_that_was_restarted(world, client):
    robot = old_robot(world)
    reports = reports_of(client, SERVER, core.QueryStatus(), core.ReportStatus)
    world.run(5.0, step=0.25)
    robot.stop()
    old_robot(world)
    world.run(30.0, step=0.25)
    assert reports[-1].status == Status.STANDBY


def test_control_goes_on_after_an_emergency_of_v1_0(world, client):
    robot = old_robot(world)
    stranger = world.started("3.1.1", services=())
    session = client.control(SERVER, authority=100)
    world.run(2.0, step=0.25)
    stranger.set_emergency(SERVER)
    world.run(2.0, step=0.25)
    assert robot.status is Status.EMERGENCY
    assert session.state is ControlState.REFUSED
    stranger.clear_emergency(SERVER)
    world.settle()
    assert (robot.status, robot.controller) == (Status.READY, client.address)
    world.run(8.0, step=0.25)
    assert session.state is ControlState.READY


def test_command_event_of_a_v1_0_component_is_refused(world, client):
    old_robot(world)
    refusals = []
    client.command(
        SERVER, core.Reset(), on_refused=lambda code, text: refusals.append((code, text))
    )
    world.run(4.0, step=0.25)
    assert refusals == [(None, "no answer")]


def test_discovery_of_a_v1_0_subsystem(world):
    old_robot(world, discovery_scope=2)
    searcher = world.started("7.1.1", services=())
    hits = []
    searcher.discover("urn:jaus:jss:core:Management", hits.append)
    world.run(1.0, step=0.25)
    assert [hit.address for hit in hits] == [SERVER]
    catalog = {SERVER: hits[0].services}
    assert report_services(query_services(), catalog, 1).node_list
    assert {(service.major, service.minor) for service in hits[0].services} == {V1_0}
