"""What a stranger gets: nothing much before it has proved where it is, and nobody else's place."""

import socket

import pytest
from keeping_peer import KeepingPeer
from stranger import ROBOT, Stranger, event

from jausml.live.peers.makes.vehicle import Place
from jausml.runtime import JausComponent
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.messages import QueryStatus
from jausml.runtime.transports.address_book import AddressBook
from jausml.runtime.transports.packets.packet import AckNak, Packet
from jausml.runtime.transports.udp import datagrams
from jausml.runtime.transports.udp.sender import Prover
from jausml.runtime.virtual import VirtualWorld
from tests.runtime.services.state_tables import V1_1, core_services

from .conftest import wait_until

STRANGER, FRIEND = JausAddress(66, 1, 1), JausAddress(200, 1, 1)
HOST, OTHER = "127.0.0.9", "127.0.0.8"
SERVICES = core_services(
    V1_1, "Transport", "Events", "AccessControl", "Management", "Discovery", "Liveness"
)


def identities(count: int) -> list[JausAddress]:
    return [JausAddress(1000 + number, 1, 1) for number in range(count)]


@pytest.fixture(autouse=True)
def outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """Treats all hosts but that of the interface as if they were on the network."""
    monkeypatch.setattr(datagrams, "LOOPBACK", "nowhere")


@pytest.fixture
def stranger(robot):
    made = []

    def make(host: str = HOST, *, acknowledges: bool = False) -> Stranger:
        made.append(Stranger(robot.transport.endpoint[1], host, acknowledges=acknowledges))
        return made[-1]

    yield make
    for peer in made:
        peer.sock.close()


@pytest.fixture
def robot(station):
    here = station()
    made = JausComponent(here.transport, ROBOT, name="robot", services=SERVICES)
    made.start()
    yield made
    made.stop()


def count(robot: JausComponent, name: str) -> int:
    return robot.counters.snapshot().get(name, 0)


class TestProof:
    def test_a_mute_one_gets_three_times_what_it_sent(self, robot, stranger):
        mute = stranger()
        for number, address in enumerate(identities(20)):
            mute.send(address, event(100.0), number)
        wait_until(lambda: count(robot, "transport.unproved_held") >= 20)
        mute.take()
        assert 0 < mute.received <= 3 * mute.sent

    def test_one_that_acknowledges_gets_all_that_waited(self, robot, stranger):
        honest = stranger(acknowledges=True)
        honest.send(STRANGER, event(100.0))
        wait_until(lambda: honest.take() or len(honest.payloads) > 20)
        assert robot.transport.is_proved(STRANGER)
        assert count(robot, "transport.address_proved") == 1
        assert count(robot, "transport.unmatched_acknowledgement") == 0

    def test_an_acknowledgement_of_jaus_plus_plus_is_a_proof(self, robot, stranger):
        peer = stranger()
        peer.send(STRANGER, QueryStatus().encode())
        wait_until(lambda: peer.take() or peer.numbers)
        answer = Packet(ROBOT, STRANGER, b"", peer.numbers[0], acknowledge=AckNak.ACK).encode()
        peer.sock.sendto(answer[1:], robot.transport.endpoint)
        wait_until(lambda: robot.transport.is_proved(STRANGER))

    def test_another_endpoint_proves_itself_anew(self, robot, stranger):
        honest = stranger(acknowledges=True)
        honest.send(STRANGER, QueryStatus().encode())
        wait_until(lambda: honest.take() or robot.transport.is_proved(STRANGER))
        thief = stranger(OTHER)
        thief.send(STRANGER, QueryStatus().encode(), 2)
        wait_until(lambda: not robot.transport.is_proved(STRANGER))
        honest.send(STRANGER, QueryStatus().encode(), 3)
        wait_until(lambda: honest.take() or robot.transport.is_proved(STRANGER))

    def test_a_stated_peer_needs_none(self, station):
        settings = {STRANGER: (HOST, 4000)}
        here = station(address_book=settings).attach(ROBOT)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind((HOST, 4000))
            packet = Packet(ROBOT, STRANGER, QueryStatus().encode(), 1).encode()
            sock.sendto(packet, here.transport.endpoint)
            wait_until(lambda: here.payloads)
        assert here.transport.is_proved(STRANGER)

    def test_junior_proves_itself_by_what_it_does_anyway(self, station, free_port):
        here = station(port=free_port).attach(ROBOT)
        with KeepingPeer(STRANGER, Place(port=free_port)) as junior:
            assert junior.send(ROBOT, QueryStatus().encode(), acknowledge=True)
            wait_until(lambda: here.transport.is_proved(STRANGER))
            here.transport.send(ROBOT, STRANGER, QueryStatus().encode())
            wait_until(lambda: QueryStatus().encode() in junior.payloads)

    @pytest.fixture
    def asked(self):
        """A component without proof that was asked for it, its claim, and what went there."""
        book = AddressBook(10.0, Counters(), trusts=lambda _: False)
        assert book.learn(STRANGER, ("192.0.2.1", 1), 0.0)
        entry, went = next(iter(book.learnt.values())), []
        with VirtualWorld() as world:
            prover = Prover(book, world.loop, 3, lambda data, _: went.append(data) or True)
            prover.heard(entry, Packet(ROBOT, STRANGER, b"", 1), ROBOT)
            yield prover, entry, went

    @pytest.mark.parametrize(("size", "goes"), [(8, True), (9, False)])
    def test_room_for_one_more_question_is_left(self, asked, size, goes):
        prover, entry, went = asked
        # Of 3 * 14 bytes the question took 17, and the next one is to have as many.
        assert (entry.claim.received, list(map(len, went))) == (14, [17])
        assert prover.send(STRANGER, entry, bytes(size))
        assert (len(went) == 2, len(entry.claim.held)) == (goes, 0 if goes else 1)

    @pytest.mark.parametrize(("wrong", "counts"), [(7, True), (8, False)])
    def test_only_so_many_guesses_are_taken(self, asked, wrong, counts):
        prover, entry, _ = asked
        number, by = entry.claim.number, int(STRANGER)
        for index in range(1, 1 + wrong):
            assert not prover.acknowledged(by, (number + index) & 0xFFFF)
        assert prover.acknowledged(by, number) is counts

    def test_what_waits_is_bounded(self, asked):
        prover, entry, _ = asked
        assert [prover.send(STRANGER, entry, bytes(100)) for _ in range(5)] == [True] * 4 + [False]

    @pytest.mark.parametrize("limit", [-1, 1, 2, 1001])
    def test_a_limit_that_leaves_no_room_is_refused(self, limit):
        with pytest.raises(ValueError, match="amplification_limit"):
            TransportSettings(amplification_limit=limit)


class TestPlaces:
    @pytest.fixture(params=[False, True], ids=["newest", "fixed"])
    def book(self, request: pytest.FixtureRequest) -> AddressBook:
        trusts = lambda endpoint: endpoint[0].startswith("10.")  # noqa: E731
        return AddressBook(10.0, Counters(), fixed=request.param, places=16, trusts=trusts)

    def test_invented_names_push_out_each_other(self, book):
        assert book.learn(FRIEND, ("10.0.0.1", 1), 0.0)
        for number, address in enumerate(identities(100)):
            assert book.learn(address, ("192.0.2.1", 1), float(number))
        assert FRIEND in book.learnt
        late = JausAddress(7, 1, 1)
        assert book.learn(late, ("10.0.0.1", 2), 200.0)
        assert {FRIEND, late} <= set(book.learnt)
        assert len(book.learnt) == 16

    def test_so_do_those_of_forged_hosts(self, book):
        assert book.learn(FRIEND, ("10.0.0.1", 1), 0.0)
        for number, address in enumerate(identities(100)):
            assert book.learn(address, (f"192.0.2.{number}", 1), float(number))
        assert FRIEND in book.learnt
        assert len(book.learnt) == 16

    def test_proved_ones_of_one_host_leave_room_for_another(self, book):
        for number, address in enumerate(identities(100)):
            assert book.learn(address, ("10.0.0.66", 1), float(number))
        assert book.learn(FRIEND, ("10.0.0.1", 1), 100.0)
        for number, address in enumerate(identities(100)):
            assert book.learn(address, ("10.0.0.66", 1), 100.0 + number)
        assert FRIEND in book.learnt

    def test_stated_and_controlling_ones_have_places_of_their_own(self, book):
        book.configure({FRIEND: ("10.0.0.1", 1)})
        book.keep_place(ROBOT, STRANGER)
        for address in (FRIEND, STRANGER):
            assert book.learn(address, ("10.0.0.66", 1), 0.0)
        for number, address in enumerate(identities(100)):
            assert book.learn(address, ("10.0.0.66", 1), 1.0 + number)
        assert {FRIEND, STRANGER} <= set(book.learnt)
        assert len(book.learnt) == 18
        book.keep_place(ROBOT, None)
        assert book.learn(JausAddress(7, 1, 1), ("10.0.0.66", 1), 200.0)
        assert STRANGER not in book.learnt

    def test_who_has_proved_nothing_keeps_nobody_out(self):
        book = AddressBook(10.0, Counters(), fixed=True, trusts=lambda _endpoint: False)
        assert book.learn(FRIEND, ("192.0.2.1", 1), 0.0)
        assert book.learn(FRIEND, ("10.0.0.1", 1), 0.1)
        book.prove(FRIEND, book.learnt[FRIEND], 0.2)
        assert not book.learn(FRIEND, ("192.0.2.1", 1), 0.3)
