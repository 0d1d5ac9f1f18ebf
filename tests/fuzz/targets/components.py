"""A component with all core services, and what it does as a client, among peers that say anything.

The first byte of an input chooses the version of its core services. Steps follow, each of a byte
that says who sends, to whom, and how much time passes; a byte with the size of a message; and the
message. A peer of the highest number is the component's own user, whose message is a choice.
"""

from collections.abc import Callable, Iterator
from functools import cache, partial

from jausml.runtime import ComponentSettings, Guard, JausComponent, ServiceIdentity, Status
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.quirks import Quirks
from jausml.runtime.services.definitions import Completion
from jausml.runtime.transports.delivery import Arrival, OnResult, Take
from jausml.runtime.transports.packets.messenger import PeerTraffic
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message

OWN = JausAddress(100, 1, 1)
PEERS = (JausAddress(100, 1, 2), JausAddress(200, 1, 1), JausAddress(200, 1, 2))
USER = len(PEERS)
PAUSES_S = (0.0, 0.0, 0.3, 40.0)
TURNS = 4
MOST_STEPS = 40
LONG_S = 100_000.0

SERVICES = tuple(
    f"urn:jaus:jss:core:{name}"
    for name in (
        "Events",
        "AccessControl",
        "Management",
        "Time",
        "Liveness",
        "Discovery",
        "ListManager",
    )
)
SETTINGS = ComponentSettings(
    default_authority=10, max_events=8, event_rate_max=2.0, max_list_elements=16
)
CODECS = {
    member.CODE: member
    for member in vars(core).values()
    if isinstance(member, type) and issubclass(member, Message) and hasattr(member, "CODE")
}
FINAL = (Status.FAILURE, Status.SHUTDOWN)
FAILURES = ("component.handler_failed", "component.report_not_encodable", "loop.callback_failed")
"""Counters of what must not happen, whatever peers say."""


class Drive(core.SetAuthority):
    """A command that takes time."""

    CODE = 0x1F00
    NAME = "Drive"


class Network:
    """A transport that ends nowhere.

    Attributes:
        now: Time in seconds.
        loop: The loop, on that time.
        receive: Who is attached.
        sent: Number of messages sent.
        arrival: The message that is being handed over.
    """

    def __init__(self) -> None:
        """Starts with nobody attached."""
        self.now = 0.0
        self.loop = Loop(clock=lambda: self.now)
        self.take: Take | None = None
        self.sent = 0
        self.arrival = Arrival()
        self.quirks = Quirks()

    @property
    def counters(self) -> Counters:
        """Where failures are counted."""
        return self.loop.counters

    def attach(self, _address: JausAddress, take: Take) -> None:
        """Delivers to a component from now on."""
        assert self.take is None
        self.take = take

    def detach(self, _address: JausAddress) -> None:
        """Delivers to nobody any more."""
        self.take = None

    def is_proved(self, _address: JausAddress) -> bool:
        """Everybody is believed here."""
        return True

    def place_of(self, address: JausAddress) -> tuple[str, str]:
        """A host for each subsystem, an endpoint for each node."""
        return str(address.subsystem), f"{address.subsystem}.{address.node}"

    def is_kept(self, _address: JausAddress) -> bool:
        """Nobody is stated."""
        return False

    def keep_place(self, _owner: JausAddress, _address: JausAddress | None) -> None:
        """There is room for everybody."""

    def when_proved(self, _listener: Callable[[JausAddress], None]) -> None:
        """Nobody needs a proof."""

    def traffic(self, _address: JausAddress) -> list[PeerTraffic]:
        """Nothing is counted: what is sent ends nowhere."""
        return []

    def answered(self, _address: JausAddress, _peer: JausAddress, _start: bytes) -> None:
        """Nothing is repeated anyway."""

    def withdraw(self, _address: JausAddress, _peer: JausAddress, _start: bytes) -> None:
        """Nothing waits."""

    def silence_of(self, _address: JausAddress) -> float:
        """Whoever is asked about has just spoken."""
        return 0.0

    def sender(
        self, source: JausAddress, destination: JausAddress, priority: Priority = Priority.STANDARD
    ) -> Callable[[bytes], None]:
        """Returns what does the same for one way."""
        return partial(self.send, source, destination, priority=priority)

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        on_result: OnResult | None = None,
        supersedes: bool = False,
    ) -> None:
        """Checks that a message is one."""
        del priority, acknowledge, on_result, supersedes
        assert source == OWN
        assert destination in PEERS or destination.is_wildcard, destination
        CODECS[int.from_bytes(payload[:2], "little")].decode(payload)
        self.sent += 1

    def deliver(self, source: JausAddress, payload: bytes) -> None:
        """Delivers a message to the component, if it runs."""
        if self.take is not None and len(payload) >= 2:
            with self.loop.lock:
                self.take(payload, source)

    def settle(self) -> int:
        """Runs what is due and returns how much that was."""
        ran = 0
        while now := self.loop.run_once(0):
            ran += now
        return ran

    def wait(self, seconds: float) -> int:
        """Lets time pass and returns how much ran."""
        ran = self.settle()
        for _ in range(TURNS if seconds else 0):
            self.now += seconds / TURNS
            ran += self.settle()
        return ran


class Robot(JausComponent):
    """A component that commands, watches and searches while it is commanded and watched."""

    def __init__(self, network: Network, version: tuple[int, int]) -> None:
        """Describes the component.

        Args:
            network: Its transport.
            version: Of its core services.
        """
        services = [ServiceIdentity(urn, *version) for urn in SERVICES]
        super().__init__(network, OWN, name="fuzzed", services=services, settings=SETTINGS)
        self.drives: list[Completion] = []
        self.handle(Drive, self.on_drive, when=Guard.READY)
        self.handles = [
            self.subscribe(PEERS[0], core.QueryStatus(), core.ReportStatus, _ignore),
            self.subscribe(PEERS[0], core.QueryTime(), core.ReportTime, _ignore, rate=1.0),
            self.command(PEERS[1], core.Resume(), max_duration=5),
            self.query(PEERS[1], core.QueryControl(), core.ReportControl, _ignore),
            self.set_list(PEERS[1], []),
        ]
        self.session = self.control(PEERS[1], authority=100)
        self.read_list(PEERS[0], _ignore)
        self.discover(SERVICES[0], _ignore)

    def supports_element(self, element: object) -> bool:
        """Takes any element."""
        del element
        return True

    def on_drive(self, _message: Message, _sender: JausAddress) -> Completion:
        """Begins to drive."""
        self.drives.append(Completion())
        return self.drives[-1]

    def act(self, choice: bytes) -> None:
        """Does what a user may do at any time."""
        what = choice[0] % 8 if choice else 0
        if what == 0:
            self.fail("fuzzed")
        elif what == 1 and self.drives:
            self.drives[choice[-1] % len(self.drives)].succeed()
        elif what == 2:
            self.handles[choice[-1] % len(self.handles)].cancel()
        elif what == 3:
            self.control_available = not choice[-1] & 1
        elif what == 4:
            self.stop()
        elif what == 5 and not self.running:
            self.start()
        elif what == 6:
            self.session.release()
        elif what == 7:
            self.report_changed(core.ReportTime)


def _ignore(*_arguments: object) -> None:
    """Takes what the component has heard."""


@cache
def network() -> Network:
    """Returns the network that all inputs of the process go through."""
    return Network()


def one_input(data: bytes) -> None:
    """Plays one exchange, from the start of a component to its end.

    Raises:
        AssertionError: The component contradicts itself, or leaves something behind.
    """
    here = network()
    before = here.counters.snapshot()
    robot = Robot(here, (1, data[0] & 1) if data else (1, 1))
    robot.start()
    is_final = False
    for head, message in _steps(data[1:]):
        number = head & 3
        if number == USER:
            robot.act(message)
            is_final = is_final and not (message and message[0] % 8 == 5)
        else:
            here.deliver(PEERS[number], message)
        here.wait(PAUSES_S[head >> 2 & 3])
        is_final = is_final or robot.status in FINAL
        _check(robot, is_final=is_final)
    robot.stop()
    here.settle()
    sent = here.sent
    assert here.wait(LONG_S) == 0, "something runs after the end"
    assert here.sent == sent, "something is sent after the end"
    after = here.counters.snapshot()
    for name in FAILURES:
        assert after.get(name, 0) == before.get(name, 0), name


def _steps(data: bytes) -> Iterator[tuple[int, bytes]]:
    offset = 0
    for _ in range(MOST_STEPS):
        if offset + 2 > len(data):
            return
        head, size = data[offset], data[offset + 1]
        yield head, data[offset + 2 : offset + 2 + size]
        offset += 2 + size


def _check(robot: Robot, *, is_final: bool) -> None:
    """Checks that status, control and list fit together."""
    status, controller = robot.status, robot.controller
    assert status is not Status.INITIALIZE
    assert status is not Status.READY or controller is not None, "ready for nobody"
    assert controller is None or status in (Status.STANDBY, Status.READY), f"{status} controlled"
    assert controller is not None or robot.authority == SETTINGS.default_authority
    assert controller is None or controller in PEERS
    assert controller is None or robot.authority >= SETTINGS.default_authority
    assert not is_final or status in (*FINAL, Status.EMERGENCY), "revived"
    assert len(robot.elements) <= SETTINGS.max_list_elements
    uids = [element.uid for element in robot.elements]
    assert [element.previous_uid for element in robot.elements] == [0, *uids[:-1]][: len(uids)]


def seeds() -> list[bytes]:
    """Returns exchanges that make sense."""
    take = core.RequestControl(authority_code=50)
    event = core.CreateEvent(
        request_id=1,
        event_type=1,
        requested_periodic_rate=0.0,
        query_message=core.QueryStatus().encode(),
    )
    periodic = core.CreateEvent(
        request_id=2,
        event_type=0,
        requested_periodic_rate=1.0,
        query_message=core.QueryTime(presence_vector=3).encode(),
    )
    drive = core.CreateCommandEvent(
        request_id=3, maximum_allowed_duration=9, command_message=Drive(authority_code=1).encode()
    )
    element = core.SetElement.ElementRec(element_uid=1, previous_uid=0, next_uid=0)
    elements = core.SetElement(element_list=[element])
    talk: list[tuple[Message, ...]] = [
        (take, core.Resume(), drive, core.Standby(), core.ReleaseControl()),
        (take, core.Resume(), core.Shutdown(), core.SetEmergency(), core.ClearEmergency()),
        (take, core.Resume(), core.SetEmergency(), core.ClearEmergency(), core.Reset(), take),
        (event, periodic, take, core.Resume(), core.Reset(), core.QueryEvents()),
        (event, core.CancelEvent(request_id=1, event_id=0), core.QueryEventTimeout()),
        (take, elements, core.QueryElementList(), core.QueryElement(element_uid=1)),
        (take, core.SetTime(), core.QueryTime(presence_vector=3), core.SetAuthority()),
        (core.ConfirmControl(), core.ReportStatus(status=2), core.RejectControl()),
        (core.ConfirmControl(), core.ReportTimeout(timeout=3), core.ReportStatus(status=1)),
        (core.ConfirmEventRequest(request_id=0), core.Event(report_message=b"\x02\x40\2\0\0\0\0")),
        (core.ConfirmEventRequest(request_id=224), core.CommandEvent(), core.RejectEventRequest()),
        (core.ConfirmElementRequest(request_id=1), core.ReportElementList(), core.ReportElement()),
        (core.QueryIdentification(query_type=4), core.ReportIdentification(query_type=2)),
        (core.RegisterServices(), core.QueryServices(), core.QueryConfiguration(query_type=2)),
    ]
    exchanges = [
        bytes([version]) + b"".join([_step(head, message.encode()) for message in messages])
        for messages in talk
        for version in (0, 1)
        for head in (0, 1, 2, 9)
    ]
    user = b"".join([_step(USER, bytes([choice])) for choice in (3, 2, 0, 4, 5, 6, 7, 1)])
    return [*exchanges, *[exchange + user for exchange in exchanges[::8]]]


def _step(head: int, message: bytes) -> bytes:
    return bytes([head, len(message)]) + message


def report() -> str:
    """Returns what became of everything."""
    here = network()
    counts = " ".join(f"{name}={n}" for name, n in here.counters.snapshot().items())
    return f"{here.sent} messages sent; {counts}"
