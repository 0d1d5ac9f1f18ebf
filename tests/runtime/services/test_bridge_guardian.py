"""What bridges hand to their guardian as peers come and go."""

import pytest

from jausml.runtime import PeerChoice, PeerSearch
from jausml.runtime.base.address import JausAddress
from jausml.runtime.guardian import page
from jausml.runtime.guardian import ward as warding
from jausml.runtime.guardian.ward import Ward

from .bridge_support import CORE, OWN, PEER, command, minutes, safe


@pytest.fixture
def ward(world):
    """The ward of a bridge without ROS, whose peers all have a place."""
    world.datagram = lambda _own, peer, payload, _priority: (payload, ("127.0.0.1", int(peer)))
    world.next_number = lambda _own, peer: int(peer)
    made = Ward(world.loop, dict, lambda: 0, lambda: None)
    yield made
    made.close()


def test_more_peers_than_a_guardian_has_room_for_get_their_commands_and_are_told(
    world, setting, ward, monkeypatch
):
    for module in (page, warding):
        monkeypatch.setattr(module, "MAX_STOPS", 8)
    peers = [JausAddress(subsystem, 1, 1) for subsystem in range(2, 8 + 5)]
    last = world.probe(str(peers[-1]))
    connection = command(peers=peers, is_command=True, safe_value=safe)
    setting.open(connection, ward=ward)
    last.take()
    setting.say(5.0, 6.0)
    assert last.take() == [minutes(5), minutes(6)]
    world.run(1.5, step=0.5)
    status = setting.ros.statuses[-1]["guardian"]
    assert (status.level, "3 without room" in status.message) == ("error", True)


def test_the_place_of_a_peer_is_free_when_all_connections_have_lost_it(world, setting, ward):
    peer = world.started(str(PEER))
    search = PeerSearch(("urn:jaus:jss:core:AccessControl",), choice=PeerChoice.ALL)
    options = {"peers": search, "is_command": True, "safe_value": safe}
    connections = command("one", **options), command("two", **options)
    setting.open(*connections, services=CORE, ward=ward)
    world.run(20.0, step=0.1)
    assert all(connection.peers == (PEER,) for connection in connections)
    setting.say(5.0)
    world.run(1.5, step=0.1)
    probe = object()
    # One place for both, as they share one sequence of numbers.
    assert ward.slots.take(probe, (OWN, OWN), lambda: 0) == 1
    world.detach(peer.address)
    world.lost = lambda source, *_: source == peer.address
    world.run(10.0, step=0.1)
    assert all(connection.peers == () for connection in connections)
    assert ward.slots.take(probe, (PEER, PEER), lambda: 0) == 0
