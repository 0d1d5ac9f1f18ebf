"""Digital Resource Discovery (IOP): a registry, and components that register at it."""

import pytest

from jausml.runtime import ComponentSettings, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.component.program import ComponentProgram, run_component
from jausml.runtime.messages.digital_resources import (
    ConfirmDigitalResourceEndpoint,
    Endpoint,
    QueryDigitalResourceEndpoint,
    RegisterDigitalResourceEndpoint,
    RemoveDigitalResourceEndpoint,
    ReportDigitalResourceEndpoint,
    RequestIDRec,
)
from jausml.runtime.services.definitions import DIGITAL_RESOURCE_DISCOVERY, server_type

from .conftest import CORE_SERVICES

FRONT, REAR = "rtsp://10.0.0.7/front", "rtsp://10.0.0.7/rear"
SERVICES = (*CORE_SERVICES, ServiceIdentity(DIGITAL_RESOURCE_DISCOVERY, 1, 1))


def registry(world, *urls, address="100.1.1"):
    return world.started(address, services=SERVICES, digital_resources=urls, register_services=True)


def camera(world, *urls, address="100.1.5"):
    return world.started(address, digital_resources=urls)


def urls_of(client, component):
    (report,) = client.ask(QueryDigitalResourceEndpoint(), component)
    return [endpoint.server_url for endpoint in report.endpoints]


def registration(url, request=1, owner=None, number=None):
    endpoint = Endpoint(server_type(url), url, owner and JausAddress.parse(owner).packed, number)
    return RegisterDigitalResourceEndpoint(RequestIDRec(request), endpoint)


@pytest.fixture
def client(world):
    return world.probe("100.2.1")


def test_a_registry_reports_its_own_endpoints(world, client):
    vehicle = registry(world, FRONT)
    (report,) = client.ask(QueryDigitalResourceEndpoint(), vehicle)
    assert report == ReportDigitalResourceEndpoint([Endpoint(0, FRONT, 0x640101, 1)])


def test_what_is_registered_is_confirmed_reported_and_removed(world, client):
    vehicle = registry(world)
    assert client.ask(registration(FRONT, 7), vehicle) == [ConfirmDigitalResourceEndpoint(1, 7)]
    assert client.ask(registration(REAR, 8), vehicle) == [ConfirmDigitalResourceEndpoint(2, 8)]
    assert urls_of(client, vehicle) == [FRONT, REAR]
    removed = client.ask(RemoveDigitalResourceEndpoint(1, 9), vehicle)
    assert removed == [ConfirmDigitalResourceEndpoint(1, 9)]
    assert urls_of(client, vehicle) == [REAR]
    assert client.ask(RemoveDigitalResourceEndpoint(1, 9), vehicle) == []


def test_a_resource_that_moves_takes_its_own_place(world, client):
    vehicle = registry(world)
    client.tell(
        vehicle,
        registration(FRONT, owner="100.1.5", number=1),
        registration(REAR, owner="100.1.5", number=1),
        registration(FRONT),
        registration(FRONT),
    )
    assert urls_of(client, vehicle) == [REAR, FRONT]


def test_nobody_fills_a_registry_beyond_what_it_can_report(world, client):
    vehicle = registry(world, FRONT)
    answers = [client.ask(registration(f"rtsp://a/{number}"), vehicle) for number in range(256)]
    assert sum(map(len, answers)) == 254
    assert len(urls_of(client, vehicle)) == 255
    assert world.counters.snapshot()["digital_resources.full"] == 2


def test_components_register_at_the_registry_of_their_subsystem(world, client):
    registry(world, address="200.1.1")
    vehicle = registry(world)
    camera(world, FRONT, REAR)
    world.run(5)
    # Both may show one stream.
    camera(world, REAR, address="100.1.6")
    world.run(5)
    (report,) = client.ask(QueryDigitalResourceEndpoint(), vehicle)
    assert [(endpoint.server_url, endpoint.jaus_id) for endpoint in report.endpoints] == [
        (FRONT, 0x640105),
        (REAR, 0x640105),
        (REAR, 0x640106),
    ]


def test_a_registration_that_is_lost_is_repeated(world, client):
    vehicle = registry(world)
    world.lost = lambda _from, _to, code: code == RegisterDigitalResourceEndpoint.CODE
    camera(world, FRONT)
    world.run(5)
    assert urls_of(client, vehicle) == []
    world.lost = lambda *_: False
    world.run(6)
    assert urls_of(client, vehicle) == [FRONT]


def test_a_registry_that_begins_anew_is_told_again(world, client):
    vehicle = registry(world)
    camera(world, FRONT)
    world.run(5)
    vehicle.stop()
    successor = registry(world)
    world.run(6)
    assert urls_of(client, successor) == [FRONT]


@pytest.mark.parametrize(
    ("url", "kind"),
    [
        ("RTSP://a", 0),
        ("udp://239.0.0.1:5000", 1),
        ("ftp://a", 2),
        ("https://a", 6),
        ("scp://a", 7),
    ],
)
def test_the_scheme_of_a_url_says_what_it_is(url, kind):
    assert server_type(url) == kind


@pytest.mark.parametrize("url", ["front", "gopher://a", "rtsp:/a", "rtsp://" + "a" * 250])
def test_what_is_no_url_of_a_resource_is_refused(url):
    with pytest.raises(ValueError, match="rtsp"):
        ComponentSettings(digital_resources=(url,))


def test_a_wrong_url_on_the_command_line_is_refused(capsys):
    program = ComponentProgram("camera", "", JausAddress(1, 1, 1))
    with pytest.raises(SystemExit, match="2"):
        run_component(None, program, ["--jaus-digital-resources", "rtsp://a b"])
    assert "b is no URL of a digital resource" in capsys.readouterr().err


def test_messages_are_those_of_the_library():
    """The bytes are those of `jausml encode`."""
    request = RequestIDRec(7)
    front = Endpoint(0, "rtsp://a", JausAddress(100, 1, 5).packed, 2)
    report = ReportDigitalResourceEndpoint([Endpoint(5, "http://a")])
    expected = [
        (
            RegisterDigitalResourceEndpoint(request, front),
            "03e707030008727473703a2f2f61050164000200",
        ),
        (report, "02f701000508687474703a2f2f61"),
        (ConfirmDigitalResourceEndpoint(1, 7), "03f70107"),
        (RemoveDigitalResourceEndpoint(1, 7), "04e70107"),
        (QueryDigitalResourceEndpoint(), "02e7"),
    ]
    for message, data in expected:
        assert message.encode().hex() == data
        assert type(message).decode(bytes.fromhex(data)) == message
