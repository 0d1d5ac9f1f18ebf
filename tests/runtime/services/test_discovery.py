"""Discovery: identification by scope, configuration, services, registration, search."""

import pytest

from jausml.runtime import Scope, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.quirks import Quirk
from jausml.runtime.clients.discovery_client import MAX_FOUND, query_service_lists, query_services
from jausml.runtime.messages import (
    QueryIdentification,
    QueryServices,
    QuerySubsystemList,
    RegisterServices,
    ReportIdentification,
    ReportServices,
)
from jausml.runtime.services.discovery import register_services, report_services

from .state_tables import query_service_list, query_services_of

SENSOR = ServiceIdentity("urn:jaus:jss:mobility:VelocityStateSensor", 1, 0)
DISCOVERY = ServiceIdentity("urn:jaus:jss:core:Discovery", 1, 1)
SYSTEM, SUBSYSTEM, NODE, COMPONENT = 1, 2, 3, 4


@pytest.fixture
def client(world):
    return world.probe("9.1.1")


def server(world, scope=Scope.SUBSYSTEM, address="1.1.1", **named):
    return world.started(address, services=(DISCOVERY,), discovery_scope=scope, **named)


def found(report):
    """Flattens a ReportServices."""
    assert isinstance(report, ReportServices)
    return {
        (node.node_rec.node_id, component.component_rec.component_id): [
            service.uri for service in component.service_list
        ]
        for node in report.node_list
        for component in node.component_list
    }


@pytest.mark.parametrize("asked", [0, 200])
def test_identification_of_no_scope_is_silence(world, client, asked):
    tested = server(world)
    client.take()
    client.send_bytes(bytes([0x00, 0x2B, asked]), tested)
    assert client.take() == []


@pytest.mark.parametrize(
    ("kind", "asked", "expected"),
    [
        (10001, SUBSYSTEM, 10001),
        (10001, NODE, 40001),
        (10001, COMPONENT, 60001),
        (50001, COMPONENT, 50001),
        (60001, SUBSYSTEM, 30001),
        (60001, COMPONENT, 60001),
    ],
)
def test_types(world, client, kind, asked, expected):
    tested = server(world, component_type=kind)
    (answer,) = client.ask(QueryIdentification(query_type=asked), tested)
    assert answer.type_ == expected


@pytest.mark.parametrize(
    ("name", "told"), [("x" * 300, "x" * 255), ("Σ-Gerät", "?-Gerät")], ids=["long", "spelling"]
)
def test_names_that_do_not_fit_are_cut_and_spelt_otherwise(world, client, name, told):
    tested = server(world, name=name)
    (answer,) = client.ask(QueryIdentification(query_type=COMPONENT), tested)
    assert answer.identification == told


@pytest.mark.usefixtures("member")
class TestRegistration:
    @pytest.fixture
    def tested(self, world):
        return server(world)

    @pytest.fixture
    def member(self, world, tested):
        probe = world.probe("1.2.3")
        probe.ask(register_services([SENSOR]), tested)
        return probe

    @pytest.mark.parametrize(
        ("asked", "expected"),
        [
            ([(2, 3)], {(2, 3)}),
            ([(2, 255)], {(2, 3)}),
            ([(255, 1)], {(1, 1)}),
            ([(1, 255)], {(1, 1)}),
            ([(2, 9)], set()),
            ([(77, 255)], set()),
            ([(2, 3), (1, 1), (5, 5)], {(1, 1), (2, 3)}),
        ],
    )
    def test_wildcards_unknown_ids_and_several(self, tested, client, asked, expected):
        (report,) = client.ask(query_services_of(*asked), tested)
        assert set(found(report)) == expected

    def test_node_scope_takes_its_node_only(self, world, client):
        narrow = server(world, Scope.NODE, "2.1.1")
        world.probe("2.1.2").ask(register_services([SENSOR]), narrow)
        world.probe("2.2.2").ask(register_services([SENSOR]), narrow)
        (report,) = client.ask(query_services_of((255, 255)), narrow)
        assert set(found(report)) == {(1, 1), (1, 2)}

    def test_looking_for_the_server_renews_the_registration(self, world, tested, member, client):
        world.run(200.0, step=10.0)
        member.ask(QueryIdentification(query_type=SUBSYSTEM), tested)
        world.run(200.0, step=10.0)
        (report,) = client.ask(query_services_of((255, 255)), tested)
        assert set(found(report)) == {(1, 1), (2, 3)}

    @pytest.mark.parametrize("address", [(2, 255, 255), (1, 7, 255), (1, 2, 7)])
    def test_service_list_of_the_unknown(self, tested, client, address):
        (report,) = client.ask(query_service_list(*address), tested)
        assert report.subsystem_list == []

    @pytest.mark.parametrize("others", [[], ["Nothing"]])
    def test_service_list_with_filters_for_one_address(self, tested, client, others):
        query = query_service_list(65535, 255, 255, "Velocity")
        for other in others:
            query.subsystem_list += query_service_list(65535, 255, 255, other).subsystem_list
        (report,) = client.ask(query, tested)
        (node,) = report.subsystem_list[0].node_list
        assert node.node_rec.node_id == 2


def test_component_registers_with_its_subsystem(world, client):
    tested = server(world)
    member = world.component("1.5.6", services=(SENSOR,), register_services=True)
    stranger = world.component("2.5.6", services=(SENSOR,), register_services=True)
    member.start()
    stranger.start()
    world.settle()
    (report,) = client.ask(query_services_of((255, 255)), tested)
    assert set(found(report)) == {(1, 1), (5, 6)}


def test_component_registers_with_a_server_that_comes_later_or_again(world, client):
    world.started("1.5.6", services=(SENSOR,), register_services=True)
    world.run(60.0, step=1.0)
    for _ in range(2):
        tested = server(world)
        world.run(16.0, step=1.0)
        (report,) = client.ask(query_services_of((5, 6)), tested)
        assert set(found(report)) == {(5, 6)}
        tested.stop()


def test_component_registers_with_its_own_subsystem_only(world, client):
    member = world.started("1.5.6", services=(SENSOR,), register_services=True)
    report = ReportIdentification(query_type=SUBSYSTEM, type_=20001, identification="ocu")
    assert client.ask(report, member) == []
    neighbour = world.probe("1.1.1")
    (answer,) = neighbour.ask(report, member)
    assert isinstance(answer, RegisterServices)


def test_registering_costs_little(world):
    member = world.started("1.5.6", services=(SENSOR,), register_services=True)
    world.run(600.0, step=1.0)
    assert world.count(QueryIdentification.CODE) == pytest.approx(42, abs=2)
    member.stop()
    world.run(60.0, step=1.0)
    assert world.count(QueryIdentification.CODE) == pytest.approx(42, abs=2)


def test_search(world):
    tested = server(world)
    world.probe("1.2.3").ask(register_services([SENSOR]), tested)
    searcher = world.component("7.1.1")
    hits = []
    searcher.discover(SENSOR.urn, hits.append)
    searcher.start()
    world.run(40.0, step=1.0)
    assert [(hit.address, hit.services) for hit in hits] == [(JausAddress(1, 2, 3), (SENSOR,))]
    world.started("8.1.1", services=(DISCOVERY, SENSOR))
    world.run(16.0, step=1.0)
    assert [hit.address for hit in hits[1:]] == [JausAddress(8, 1, 1)]


def test_who_knows_no_wildcards_is_asked_by_name(world):
    """JAUS++ answers a query with wildcards by a report without components."""
    searcher = world.started("2.1.1", services=())
    hits = []
    searcher.discover(SENSOR.urn, hits.append)
    other = world.probe("152.1.1", strict=False)
    world.settle()
    other.tell(searcher, ReportServices(node_list=[]))
    named = other.take(QueryServices)[-1]
    (node,) = named.node_list
    assert node.node_rec.node_id == 1
    assert [asked_component.component_id for asked_component in node.component_list] == [1]
    other.tell(searcher, ReportServices(node_list=[]))
    assert not other.take(QueryServices)

    catalog = {JausAddress(152, 1, 1): (SENSOR,)}
    other.tell(searcher, report_services(named, catalog, 152))
    assert [hit.address for hit in hits] == [JausAddress(152, 1, 1)]
    (quirk,) = searcher.transport.quirks.of(JausAddress(152, 1, 1))
    assert quirk.quirk is Quirk.NO_WILDCARDS


def identify(world, tested, *addresses):
    report = ReportIdentification(query_type=SUBSYSTEM, type_=10001, identification="peer")
    for address in addresses:
        world.send(address, tested.address, report.encode())
    world.settle()


def test_as_many_subsystems_as_a_report_holds(world, client):
    tested = server(world)
    identify(world, tested, *(JausAddress(number, 1, 1) for number in range(2, 302)))
    (report,) = client.ask(QuerySubsystemList(), tested)
    listed = {subsystem.subsystem_id for subsystem in report.subsystem_list}
    assert len(listed) == 255
    assert 1 in listed


def test_flood_of_subsystems_forgets_none_that_is_alive(world, client):
    tested = server(world, registration_lifetime=10.0)
    identify(world, tested, *(JausAddress(number, 1, 1) for number in range(2, 302)))
    for _ in range(4):
        world.run(5.0, step=5.0)
        identify(world, tested, JausAddress(2, 1, 1))
    identify(world, tested, JausAddress(999, 1, 1))
    (report,) = client.ask(QuerySubsystemList(), tested)
    assert {subsystem.subsystem_id for subsystem in report.subsystem_list} == {1, 2, 999}


def test_stale_registrations_make_room(world, client):
    tested = server(world, registration_lifetime=10.0)
    payload = register_services([SENSOR]).encode()
    everyone = [JausAddress(1, node, number) for node in range(2, 8) for number in range(1, 201)]
    for address in everyone:
        world.send(address, tested.address, payload)
    world.settle()
    assert world.counters.snapshot()["discovery.too_many_registrations"] == len(everyone) - 1024
    world.run(20.0, step=5.0)
    world.send(JausAddress(1, 9, 9), tested.address, payload)
    world.settle()
    (report,) = client.ask(query_services_of((255, 255)), tested)
    assert set(found(report)) == {(1, 1), (9, 9)}


def test_list_of_more_subsystems_than_a_report_holds(world, client):
    tested = server(world, scope=Scope.SYSTEM)
    payload = register_services([SENSOR]).encode()
    for number in range(2, 302):
        world.send(JausAddress(number, 1, 1), tested.address, payload)
    world.settle()
    (report,) = client.ask(query_service_lists(), tested)
    assert len(report.subsystem_list) == 255


def test_search_is_not_filled_by_inventions(world):
    seeker = world.started("2.1.1", services=())
    told = []
    seeker.discover(SENSOR.urn, told.append)
    for subsystem in range(100, 110):
        catalog = {
            JausAddress(subsystem, node, number): (SENSOR,)
            for node in range(1, 11)
            for number in range(1, 101)
        }
        report = report_services(query_services(), catalog, subsystem)
        world.send(JausAddress(subsystem, 1, 1), seeker.address, report.encode())
    world.settle()
    assert len(told) == MAX_FOUND
    assert world.counters.snapshot()["discovery_client.too_many_found"] == 10000 - MAX_FOUND
