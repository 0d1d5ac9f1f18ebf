"""Discovery, row by row (AS5710 v1.1 and v1.0, Discovery; IOP: looking around)."""

from itertools import pairwise

import pytest

from jausml.runtime import Scope, ServiceIdentity
from jausml.runtime import messages as core
from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.clients.discovery_client import query_service_lists, query_services
from jausml.runtime.services.discovery import (
    register_services,
    report_service_list,
    report_services,
)

from .state_tables import (
    CORE_NAMES,
    V1_0,
    V1_1,
    Row,
    after,
    core_services,
    play,
    query_service_list,
    query_services_of,
    rows,
)

SENSOR = ServiceIdentity("urn:jaus:jss:mobility:VelocityStateSensor", 1, 0)
SYSTEM, SUBSYSTEM, NODE, COMPONENT = Scope
OWN, MEMBER = JausAddress(1, 1, 1), JausAddress(1, 5, 6)
LOOK = core.QueryIdentification(query_type=SUBSYSTEM)


def row(name, *given, when, scope=SUBSYSTEM, **expected):
    settings = {"discovery_scope": scope, "subsystem_name": "robot", **expected.pop("settings", {})}
    return Row(name, given, when, settings=settings, **expected)


def asks(query_type):
    return ("client", core.QueryIdentification(query_type=query_type))


def identified(query_type, kind, name):
    answer = core.ReportIdentification(query_type=query_type, type_=kind, identification=name)
    return {"client": [answer]}


def registers(address, *services):
    """Another component registers, and is not there any more."""

    def step(stage):
        stage.world.send(address, OWN, register_services(services).encode())

    return step


def configuration(*pairs):
    return core.ReportConfiguration(
        node_list=[
            core.ReportConfiguration.NodeSeq(
                node_rec=core.ReportConfiguration.NodeRec(node_id=node),
                component_list=[
                    core.ReportConfiguration.ComponentRec(component_id=component, instance_id=0)
                ],
            )
            for node, component in pairs
        ]
    )


def subsystems(*addresses):
    return core.ReportSubsystemList(
        subsystem_list=[
            core.ReportSubsystemList.SubsystemRec(
                subsystem_id=address.subsystem, node_id=address.node, component_id=address.component
            )
            for address in addresses
        ]
    )


def own(version=V1_1):
    return core_services(version, *CORE_NAMES)


def services(catalog, query=None):
    return report_services(query or query_services(), catalog, 1)


JOINED = registers(MEMBER, SENSOR)
OCU = ("client", core.ReportIdentification(query_type=SUBSYSTEM, type_=20001, identification="ocu"))

IDENTIFICATION = tuple(
    row(
        f"QueryIdentification {asked.name}, scope {scope.name}: "
        + ("answered" if asked is SYSTEM or scope <= asked else "silence"),
        when=asks(asked),
        then=identified(
            asked,
            {SYSTEM: 30001, SUBSYSTEM: 30001, NODE: 40001, COMPONENT: 60001}[asked],
            "robot" if asked <= SUBSYSTEM else "tested",
        )
        if asked is SYSTEM or scope <= asked
        else {},
        scope=scope,
    )
    for scope in Scope
    for asked in Scope
)

CATALOG = (
    row("QueryConfiguration subsystem: nodes and components", JOINED, when=("client",
        core.QueryConfiguration(query_type=SUBSYSTEM), configuration((1, 1), (5, 6)))),
    row("QueryConfiguration node: those of the own node", JOINED,
        when=("client", core.QueryConfiguration(query_type=NODE), configuration((1, 1)))),
    row("QueryConfiguration subsystem, scope NODE: silence",
        when=("client", core.QueryConfiguration(query_type=SUBSYSTEM)), scope=NODE),
    row("QueryConfiguration node, scope COMPONENT: silence",
        when=("client", core.QueryConfiguration(query_type=NODE)), scope=COMPONENT),
    row("QuerySubsystemList: the own one",
        when=("client", core.QuerySubsystemList(), subsystems(OWN))),
    row("QuerySubsystemList: those that identified themselves", OCU,
        when=("client", core.QuerySubsystemList(), subsystems(JausAddress(2, 1, 1), OWN))),
    row("QuerySubsystemList: not those that were not heard of lately", OCU, after(301.0),
        when=("client", core.QuerySubsystemList(), subsystems(OWN))),
    row("QuerySubsystemList, scope NODE: silence", when=("client", core.QuerySubsystemList()),
        scope=NODE),
    row("QueryServices 255/255: all", JOINED,
        when=("client", query_services(), services({OWN: own(), MEMBER: (SENSOR,)}))),
    row("QueryServices, v1.0: the same", JOINED,
        when=("client", query_services(), services({OWN: own(V1_0), MEMBER: (SENSOR,)})),
        version=V1_0),
    row("QueryServices of one component: it alone", JOINED,
        when=("client", query_services_of((5, 6)), services({MEMBER: (SENSOR,)}))),
    row("QueryServices of an unknown node: an empty list", JOINED,
        when=("client", query_services_of((9, 255)), core.ReportServices())),
    row("QueryServiceList 65535/255/255: all", JOINED, when=("client", query_service_lists(),
        report_service_list(query_service_lists(), {OWN: own(), MEMBER: (SENSOR,)}))),
    row("QueryServiceList of an unknown subsystem: an empty list",
        when=("client", query_service_list(77), core.ReportServiceList())),
    row("QueryServiceList, v1.0: unknown, ignored", when=("client", query_service_lists()),
        version=V1_0, counted="component.unknown_message"),
    row("RegisterServices again: replaces", registers(MEMBER, *own()), JOINED,
        when=("client", query_services_of((5, 6)), services({MEMBER: (SENSOR,)}))),
    row("RegisterServices of another subsystem: ignored",
        when=("client", register_services([SENSOR])), counted="discovery.registration_ignored"),
    row("RegisterServices, scope COMPONENT: ignored", when=JOINED, scope=COMPONENT,
        counted="discovery.registration_ignored"),
    row("RegisterServices, not heard of lately: forgotten", JOINED, after(301.0),
        when=("client", query_services_of((5, 6)), core.ReportServices())),
)  # fmt: skip


@rows(*IDENTIFICATION, *CATALOG)
def test_row(world, row):
    play(world, row)


# ---- bring-up, as a client of Discovery ------------------------------------------------------


def member(world, **settings):
    return world.started(str(MEMBER), services=(SENSOR,), **settings)


def asked_at(world, address, query=core.QueryIdentification):
    """Returns the times at which a component asks everyone, for 10 minutes."""
    times = []
    start = world.time
    while world.time < start + 600.0:
        sent = len(world.log)
        world.run(1.0, step=1.0)
        if (address, BROADCAST, query.CODE) in world.log[sent:]:
            times.append(world.time - start)
    return times


@pytest.mark.parametrize(
    "settings", [{"register_services": True}, {"discovery_scope": SUBSYSTEM}], ids=str
)
def test_components_and_servers_look_around_after_5_seconds_and_each_15(world, settings):
    """Everyone is asked eagerly at first, and at least every 5 minutes as the IOP demands."""
    world.started("1.1.1", services=own(), **settings)
    assert (OWN, BROADCAST, core.QueryIdentification.CODE) in world.log
    times = asked_at(world, OWN)
    assert times[:3] == [5, 10, 25]
    assert {after - before for before, after in pairwise(times[2:])} == {15}


def test_operator_control_unit_looks_for_the_system_too(world):
    probe = world.probe("1.1.1")
    member(world, register_services=True, component_type=20001)
    assert probe.take() == [LOOK, core.QueryIdentification(query_type=SYSTEM)]


def test_component_that_shall_not_register_is_silent(world):
    probe = world.probe("1.1.1")
    member(world)
    world.run(600.0, step=5.0)
    assert probe.take() == []


def test_registration_with_the_server_of_the_subsystem(world):
    server = world.probe("1.1.1")
    component = member(world, register_services=True)
    assert component.discovery_server is None
    (registration,) = server.ask(
        core.ReportIdentification(query_type=SUBSYSTEM, type_=10001, identification="robot"),
        component,
    )
    assert registration == register_services([SENSOR])
    assert component.discovery_server == server.address


def test_lost_server_is_noticed_and_looked_for_eagerly(world):
    server = world.probe("1.1.1")
    component = member(world, register_services=True, discovery_timeout=60.0)
    world.run(30.0, step=1.0)
    server.ask(
        core.ReportIdentification(query_type=SUBSYSTEM, type_=10001, identification="robot"),
        component,
    )
    world.run(60.0, step=1.0)
    assert component.discovery_server == server.address
    times = [moment - 60.0 for moment in asked_at(world, MEMBER)]
    assert component.discovery_server is None
    assert world.counters.snapshot()["discovery_client.lost"] == 1
    assert 5.0 in [after - before for before, after in pairwise(times)]


def test_registration_with_another_server_after_the_loss(world):
    component = member(world, register_services=True)
    for address in ("1.1.1", "1.2.1"):
        server = world.started(address, services=own(), discovery_scope=SUBSYSTEM)
        world.run(20.0, step=1.0)
        assert component.discovery_server == server.address
        server.stop()
        world.run(100.0, step=1.0)
        assert component.discovery_server is None


def test_servers_find_each_other(world):
    first, second = (
        world.component(address, services=own(), discovery_scope=SUBSYSTEM)
        for address in ("1.1.1", "2.1.1")
    )
    first.start()
    second.start()
    world.run(16.0, step=1.0)
    probe = world.probe("9.1.1")
    for server in (first, second):
        (report,) = probe.ask(core.QuerySubsystemList(), server)
        assert {subsystem.subsystem_id for subsystem in report.subsystem_list} == {1, 2}


@pytest.mark.parametrize(
    ("query", "answer"),
    [
        pytest.param(
            core.QueryServices.CODE,
            report_services(query_services(), {MEMBER: (SENSOR,)}, 1),
            id="v1.0: ReportServices",
        ),
        pytest.param(
            core.QueryServiceList.CODE,
            report_service_list(query_service_lists(), {MEMBER: (SENSOR,)}),
            id="v1.1: ReportServiceList",
        ),
    ],
)
def test_search_understands_servers_of_both_versions(world, query, answer):
    server = world.probe("1.1.1")
    searcher = world.started("7.1.1", services=())
    hits = []
    searcher.discover(SENSOR.urn, hits.append)
    assert query in {message.CODE for message in server.take()}
    server.ask(answer, searcher)
    assert [(hit.address, hit.services) for hit in hits] == [(MEMBER, (SENSOR,))]
