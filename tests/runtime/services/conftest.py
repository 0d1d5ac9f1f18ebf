"""A world with a clock of its own, in which components exchange messages without a network."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from jausml.runtime import ComponentSettings, JausComponent, ServiceIdentity
from jausml.runtime import messages as core_messages
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.quirks import Quirks
from jausml.runtime.messages import digital_resources, machine_states
from jausml.runtime.transports.delivery import MESSAGE_CODE_SIZE, Arrival, Take
from jausml.runtime.transports.packets.messenger import PeerTraffic
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import DecodeError, Message

from .bridge_support import Setting
from .state_tables import V1_1, core_services

CORE_SERVICES = core_services(
    V1_1, "Transport", "Events", "AccessControl", "Management", "Liveness", "Discovery"
)

CLASSES = {
    message_class.CODE: message_class
    for module in (core_messages, digital_resources, machine_states)
    for message_class in vars(module).values()
    if isinstance(message_class, type)
    and issubclass(message_class, Message)
    and hasattr(message_class, "CODE")
}


class World:
    """Delivers messages between components in the order of sending, on a clock that tests turn.

    Attributes:
        time: Present time in seconds.
        log: Every message sent: (source, destination, message code).
        lost: Tells whether a message is lost on its way.
        answers: What was said to be answered: who had asked, who answers, start of the payload.
        withdrawn: What was not to be sent any more: by whom, to whom, start of the payload.
    """

    def __init__(self) -> None:
        self.time = 1000.0
        self.loop = Loop(clock=lambda: self.time)
        self.log: list[tuple[JausAddress, JausAddress, int]] = []
        self.arrival = Arrival()
        self.lost: Callable[[JausAddress, JausAddress, int], bool] = lambda *_: False
        self._receivers: dict[JausAddress, Take] = {}
        self.unproved: set[JausAddress] = set()
        self.kept: dict[JausAddress, JausAddress | None] = {}
        self.proof_listeners: list[Callable[[JausAddress], None]] = []
        self.heard: dict[JausAddress, float] = {}
        self.exchanged: list[PeerTraffic] = []
        self.quirks = Quirks()
        self.answers: list[tuple[JausAddress, JausAddress, bytes]] = []
        self.withdrawn: list[tuple[JausAddress, JausAddress, bytes]] = []

    @property
    def counters(self) -> Counters:
        return self.loop.counters

    def attach(self, address: JausAddress, take: Take) -> None:
        assert address not in self._receivers
        self._receivers[address] = take

    def detach(self, address: JausAddress) -> None:
        self._receivers.pop(address, None)

    def traffic(self, address: JausAddress) -> list[PeerTraffic]:
        """What the test says."""
        return [peer for peer in self.exchanged if peer.own == address]

    def answered(self, address: JausAddress, peer: JausAddress, start: bytes) -> None:
        self.answers.append((address, peer, start))

    def withdraw(self, address: JausAddress, peer: JausAddress, start: bytes) -> None:
        self.withdrawn.append((address, peer, start))

    def is_unheard(self, address: JausAddress) -> bool:
        """Messages are lost on their way to nobody."""
        return address not in self._receivers

    def is_proved(self, address: JausAddress) -> bool:
        return address not in self.unproved

    def place_of(self, address: JausAddress) -> tuple[str, str]:
        """A host for each subsystem, an endpoint for each node."""
        return str(address.subsystem), f"{address.subsystem}.{address.node}"

    def is_kept(self, address: JausAddress) -> bool:
        return address in self.kept.values()

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:
        self.kept[owner] = address

    def when_proved(self, listener: Callable[[JausAddress], None]) -> None:
        self.proof_listeners.append(listener)

    def silence_of(self, address: JausAddress) -> float:
        return self.time - self.heard.get(address, -1e9)

    def double_of(self, _address: JausAddress) -> None:
        """Nobody else has an address here: it is attached once."""

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,  # noqa: ARG002 - all are alike
        acknowledge: bool = False,
        on_result: Callable[[bool], None] | None = None,
        supersedes: bool = False,  # noqa: ARG002 - nothing waits or is repeated
    ) -> None:
        code = int.from_bytes(payload[:2], "little")
        self.log.append((source, destination, code))
        self.heard[source] = self.time
        reached = [
            address
            for address in self._receivers
            if destination.matches(address) and address != source
        ]
        if self.lost(source, destination, code):
            reached = []
        for address in reached:
            self.loop.call_soon(lambda to=address: self._deliver(to, payload, source))
        if on_result is not None:
            success = bool(reached) or not acknowledge
            self.loop.call_soon(lambda: on_result(success))

    def sender(
        self, source: JausAddress, destination: JausAddress, priority: Priority = Priority.STANDARD
    ) -> Callable[[bytes], None]:
        return partial(self.send, source, destination, priority=priority)

    def _deliver(self, address: JausAddress, payload: bytes, source: JausAddress) -> None:
        take = self._receivers.get(address)
        if take is not None and len(payload) >= MESSAGE_CODE_SIZE:
            take(payload, source)

    def settle(self) -> None:
        """Lets everything happen that is due now."""
        while self.loop.run_once(0):
            pass

    def run(self, seconds: float, step: float = 0.01) -> None:
        """Lets time pass."""
        end = self.time + seconds
        self.settle()
        while self.time < end - 1e-9:
            self.time = min(self.time + step, end)
            self.settle()

    def component(
        self,
        address: str,
        *,
        kind: type[JausComponent] = JausComponent,
        services: tuple[ServiceIdentity, ...] = CORE_SERVICES,
        name: str = "tested",
        component_type: int = 60001,
        **settings: Any,
    ) -> Any:
        """Makes a component that does not register; it is not started."""
        settings.setdefault("register_services", False)
        return kind(
            self,
            JausAddress.parse(address),
            name=name,
            services=services,
            component_type=component_type,
            settings=ComponentSettings(**settings),
        )

    def started(self, address: str, **options: Any) -> Any:
        """Makes a component that runs."""
        component = self.component(address, **options)
        component.start()
        return component

    def probe(self, address: str, *, strict: bool = True):
        """Makes a peer that does nothing by itself; a strict one understands all that it gets."""
        return Probe(self, JausAddress.parse(address), strict=strict)

    def count(self, code: int) -> int:
        """Returns how often a message was sent."""
        return sum(1 for _, _, sent in self.log if sent == code)


class Probe:
    """A peer that sends what a test says and keeps what it receives."""

    def __init__(self, world: World, address: JausAddress, *, strict: bool) -> None:
        self.address = address
        self._strict = strict
        self._world = world
        self._received: list[Message] = []
        world.attach(address, self._receive)

    def _receive(self, payload: bytes, _source: JausAddress) -> None:
        code = int.from_bytes(payload[:2], "little")
        try:
            self._received.append(CLASSES[code].decode(payload))
        except (KeyError, DecodeError):
            assert not self._strict

    def send(self, message: Message, destination: Any) -> None:
        """Sends without waiting for an answer."""
        self.send_bytes(message.encode(), destination)

    def send_bytes(self, payload: bytes, destination: Any) -> None:
        """Sends any bytes."""
        target = getattr(destination, "address", destination)
        self._world.send(self.address, target, payload)

    def tell(self, destination: Any, *messages: Message) -> None:
        """Sends messages in a row, and lets everything happen that follows at once."""
        for message in messages:
            self.send(message, destination)
        self._world.settle()

    def ask(self, message: Message, destination: Any) -> list[Message]:
        """Sends a message and returns what comes back at once."""
        self.take()
        self.send(message, destination)
        return self.take()

    def take(self, kind: Any = Message) -> list[Any]:
        """Returns what was received of a kind, and forgets all."""
        self._world.settle()
        received, self._received = self._received, []
        return [message for message in received if isinstance(message, kind)]


@pytest.fixture
def world() -> Iterator[World]:
    made = World()
    with made.loop:
        yield made


@pytest.fixture
def setting(world: World) -> Iterator[Setting]:
    """A bridge in the world, which a test opens."""
    made = Setting(world)
    yield made
    if made.bridge is not None:
        made.bridge.close()


@pytest.fixture
def message_classes() -> dict[int, type[Message]]:
    """The core messages by their codes."""
    return CLASSES


@pytest.fixture
def client(world):
    """A component without services of its own, which asks others."""
    component = world.component("2.1.1", services=())
    component.start()
    return component
