"""Live tools with a vehicle on JAUS++."""

import signal
import subprocess

import pytest
import warm

from jausml.cli.shared import options
from jausml.live.peers.makes import rover
from jausml.live.peers.makes.rover import JausPlusPlus
from jausml.live.peers.makes.vehicle import SERVICES, Place, Vehicle
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import (
    ConfirmEventRequest,
    CreateEvent,
    QueryIdentification,
    QueryStatus,
    RejectEventRequest,
    ReleaseControl,
    RequestControl,
    Resume,
)

pytestmark = pytest.mark.ports

ADDRESS, OCU = JausAddress(152, 1, 1), JausAddress(200, 1, 1)
QUERY = QueryStatus().encode()
SET_EFFORT = b"\x05\x04\x00"


@pytest.fixture
def vehicle(free_port):
    made = Vehicle(ADDRESS, lambda _code: None, lambda *_: None, dies_of_updates=True)
    peer = JausPlusPlus(made, Place(port=free_port))
    yield made
    peer.close()


@pytest.mark.usefixtures("vehicle")
def test_its_services_are_found_and_why_they_were_hard_to_find_is_told(jausml):
    result = jausml("ocu", "services", str(ADDRESS))
    assert result.exit_code == 0
    assert [line.split()[0] for line in result.stdout.splitlines()] == list(SERVICES)
    assert f"note: {ADDRESS} knows no wildcards in QueryServices (" in result.stderr


def test_it_is_controlled_and_watched(jausml, vehicle):
    words = f"control {ADDRESS}\nresume\nwatch QueryStatus 20\nwait 1\nstatus\nquit\n"
    result = jausml("ocu", "session", input=words)
    assert result.exit_code == 0, result.output
    assert f"{ADDRESS} is in READY" in result.stdout
    assert result.stdout.count("ReportStatus") > 3
    assert f"note: {ADDRESS} acknowledges without the version of JUDP" in result.stderr
    assert not vehicle.is_dead


def test_no_message_ends_it():
    commands = []
    made = Vehicle(
        ADDRESS, lambda _code: None, lambda *taken: commands.append(taken), doubles_events=True
    )

    def answers(message):
        return [answer for _, answer in made.take(message, OCU)]

    def create(query):
        return CreateEvent(1, CreateEvent.EventType.PERIODIC_SC, 10.0, query).encode()

    cut = QueryIdentification(query_type=4).encode()[:-1]
    assert not answers(cut)
    answers(RequestControl(authority_code=255).encode())
    answers(Resume().encode())
    unsupported = [RejectEventRequest(1, 5).encode()]
    for query in (cut, SET_EFFORT, ReleaseControl().encode(), create(QUERY)):
        assert answers(create(query)) == unsupported
    assert not commands
    for number in range(255):
        assert answers(create(QUERY)) == [ConfirmEventRequest(1, number, 10.0).encode()]
    assert answers(create(QUERY)) == [RejectEventRequest(1, 3).encode()]


def test_a_peer_lives_until_it_is_ended(jausml, free_port):
    command = [*warm.command(), "peer", "junior", "--interface", "127.0.0.1"]
    process = subprocess.Popen(
        [*command, "--port", str(free_port)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL
    )
    try:
        assert b"junior rover 152.1.1 at 127.0.0.1" in process.stderr.readline()
        assert jausml("ping", "152.1.1", "--count", "1").exit_code == 0
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=20)
    finally:
        process.kill()
        process.wait()
    assert (process.returncode, rest) == (0, b"interrupted\n")


def test_a_peer_of_each_make_can_be_started():
    assert tuple(rover.MAKES) == options.MAKES


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (("juniors",), "'junior', 'jts', 'jaus++'"),
        (("jts", "--id", "1.1"), "not a JAUS address"),
        (("jts", "--interface", "192.0.2.1"), "the network cannot be used"),
        (("jts", "--interface", "nowhere"), "nowhere"),
    ],
)
def test_what_a_peer_cannot_be_is_told(arguments, error, refused):
    refused(error, "peer", *arguments)
