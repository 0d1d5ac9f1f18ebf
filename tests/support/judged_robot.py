"""A robot in a virtual world that takes the tasks of a competition, with one fault to order.

Most faults are of what it sends or hears: it is mute of a report, or deaf of a command. The others
are named where the robot does it wrong.
"""

from collections import deque
from math import atan2, cos, hypot, sin

from jausml.live.peers.conformance.probe import ReceivedDatagram
from jausml.live.peers.entry_messages import message_class
from jausml.runtime import ComponentSettings, Guard, JausComponent, Scope, ServiceIdentity
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.packets.packet import parse_datagram

ROBOT, JUDGE = JausAddress(155, 1, 1), JausAddress(42, 1, 1)
CORE = (
    *("Transport", "Events", "AccessControl", "Management", "Liveness", "Discovery"),
    "ListManager",
)
MOBILITY = (
    *("VelocityStateSensor", "LocalPoseSensor", "LocalWaypointListDriver", "LocalWaypointDriver"),
    "PrimitiveDriver",
)
STEP = 0.05
SPEED = 1.0
REACHED = 0.15
SHORTEST = 13
ALL = 0xFFFF
DRIVER = "LocalWaypointListDriver"


class VirtualWire:
    """The network of a virtual world as the judge sees it: raw datagrams, and virtual time.

    Attributes:
        interrupted_at: When somebody presses Ctrl-C, in seconds.
    """

    def __init__(self, world):
        self.world = world
        self.interrupted_at = float("inf")
        self.transport = world.transport()
        self.transport.receive_datagram = self._take
        self.arrived = deque()
        self.group = self.transport.station.group
        self.well_known = self.group

    def _take(self, data, sender):
        self.arrived.append(ReceivedDatagram(self.world.now(), sender, data))

    def put(self, datagram, endpoint):
        if len(datagram) >= SHORTEST:  # the virtual network counts by the ids in the header
            self.transport.station.sendto(datagram, endpoint)

    def receive(self, deadline):
        if self.now() >= self.interrupted_at:
            self.interrupted_at = float("inf")
            raise KeyboardInterrupt
        try:
            self.world.run_until(lambda: self.arrived, max(0.0, deadline - self.now()))
        except TimeoutError:
            return None
        return self.arrived.popleft()

    def now(self):
        return self.world.now()

    def utc(self):
        return self.world.utc()


class Robot(JausComponent):
    """Drives at 1 m/s from waypoint to waypoint, and tells of it.

    Attributes:
        fault: What it does wrong: `mute NAME` of a message, `deaf NAME`, `without FIELD` in its
            reports, `unlisted SERVICE`, or one of those that the code names.
    """

    def __init__(self, world, catalogue, judge, fault=""):
        self.fault = fault
        self.catalogue = catalogue
        self.world = world
        self.x = self.y = self.yaw = 0.0
        self.active = 0
        self.pending = []
        self.wished = 0.0
        self.is_answered = self.is_silent = False
        greets = fault not in ("greets nobody", "greets often", "greets on")
        transport = world.transport(
            settings=TransportSettings(address_book={JUDGE: judge.transport.endpoint})
        )
        self._filter(transport)
        services = [
            ServiceIdentity(f"urn:jaus:jss:core:{service_name}", 1, 1) for service_name in CORE
        ]
        services += [
            ServiceIdentity(f"urn:jaus:jss:mobility:{service_name}", 1, 0)
            for service_name in MOBILITY
        ]
        super().__init__(
            transport,
            ROBOT,
            name="<b>robot</b>",
            services=services,
            component_type=10001,
            settings=ComponentSettings(
                control_timeout=5 if fault == "control lapses" else 0,
                discovery_scope=Scope.SUBSYSTEM,
                register_services=False,
                greeted={JUDGE: Scope.SUBSYSTEM} if greets else {},
            ),
        )
        self._provide_all()
        if fault in ("greets often", "greets on"):
            self._greet(2.0 if fault == "greets often" else 5.0)
        world.call_later(STEP, self._step)

    # ---- what goes wrong on the way ----------------------------------------------------------

    def _filter(self, transport):
        """Lets nothing through that it is mute of or deaf to, and changes what it says wrongly."""
        kind, _, name = self.fault.partition(" ")
        send, take = transport.station.sendto, transport.receive_datagram

        def code(packet):
            return int.from_bytes(packet.payload[:2], "little")

        def send_rest(datagram, endpoint):
            (packet,) = parse_datagram(datagram, Counters())
            if self.fault == "falls silent on the way":
                self.is_silent = self.is_silent or self.active > 2
            if self.is_silent:
                return len(datagram)
            if kind == "mute" and code(packet) == self._code(name):
                return len(datagram)
            changed = packet._replace(payload=self._changed(packet.payload))
            return send(changed.encode(), endpoint)

        def take_rest(datagram, endpoint):
            packets = parse_datagram(datagram, Counters())
            if any(code(packet) == core.ReportIdentification.CODE for packet in packets):
                self.is_answered = True
            if kind != "deaf" or all(code(received) != self._code(name) for received in packets):
                take(datagram, endpoint)

        transport.station.sendto, transport.receive_datagram = send_rest, take_rest

    def _code(self, name):
        known = getattr(core, name, None)
        return known.CODE if known else self._kind(name, _SERVICE.get(name)).CODE

    def _changed(self, payload):
        code = int.from_bytes(payload[:2], "little")
        kind, _, name = self.fault.partition(" ")
        if kind == "babbles":
            return self._babble(payload)
        if kind == "unlisted" and code == core.ReportServices.CODE:
            report = core.ReportServices.decode(payload)
            for node in report.node_list:
                for component in node.component_list:
                    component.service_list[:] = [
                        s for s in component.service_list if not s.uri.endswith(name)
                    ]
            return report.encode()
        change = _CHANGES.get((self.fault, code))
        if change is None:
            return payload
        message = _CLASSES[code].decode(payload)
        change(message)
        return message.encode()

    def _babble(self, payload):
        """Returns a payload with the right code that is cut, prolonged or random, or as it was."""
        chance = self.world.random
        choices = (
            payload,
            payload[: chance.randrange(len(payload) + 1)],
            payload + chance.randbytes(chance.randrange(1, 40)),
            payload[:2] + chance.randbytes(max(0, len(payload) - 2)),
        )
        return choices[chance.randrange(len(choices))]

    def _greet(self, pause):
        if self.fault == "greets on" or not self.is_answered:
            self.send(core.QueryIdentification(query_type=2), JUDGE)
        self.world.call_later(pause, lambda: self._greet(pause))

    # ---- services ----------------------------------------------------------------------------

    def _kind(self, name, service=None):
        return message_class(self.catalogue.message(name, service))

    def _provide_all(self):
        self._answer("VelocityState", "VelocityStateSensor", self._velocity, choosing=True)
        self._answer("LocalPose", "LocalPoseSensor", self._pose, choosing=True)
        self._answer("WrenchEffort", "PrimitiveDriver", dict)
        self._answer("ActiveElement", DRIVER, lambda: {"ElementUID": self._told_active()})
        self._answer("TravelSpeed", DRIVER, lambda: {"Speed": self._told_speed()})
        self._answer("LocalWaypoint", DRIVER, self._told_waypoint)
        self.handle(self._kind("SetLocalPose"), self._set_pose, when=Guard.CONTROLLED)
        self.handle(self._kind("ExecuteList", DRIVER), self._execute, when=Guard.READY)

    def _answer(self, name, service, fields, *, choosing=False):
        query = self._kind(f"Query{name}", service)
        report = self._kind(f"Report{name}", service)

        def provider(asked, _sender):
            told = fields()
            if told is None:
                return None
            wanted = asked.fields.get(f"Query{name}Rec", {}).get("PresenceVector", ALL)
            (record,) = report.ENTRY.record.members
            members = [member.name for member in record.kind.members]
            chosen = {k: v for k, v in told.items() if wanted >> members.index(k) & 1}
            return report({record.name: chosen if choosing else told})

        self.provide(query, report, provider)

    def _without(self, fields):
        kind, _, name = self.fault.partition(" ")
        return {field: fields[field] for field in fields if (kind, name) != ("without", field)}

    def _stamp(self, what):
        now = self.clock.utc()
        second = 0 if self.fault == f"{what} clock stands" else now.second
        if self.fault == f"{what} clock runs back":
            second = 59 - second
        thousandths = 0 if self.fault == f"{what} clock stands" else now.microsecond // 1000
        return {
            "Milliseconds": thousandths,
            "Seconds": second,
            "Minutes": 0,
            "Hour": now.hour,
            "Day": now.day,
        }

    def _velocity(self):
        return self._without(
            {"Velocity_X": self._speed(), "YawRate": 0.0, "TimeStamp": self._stamp("velocity")}
        )

    def _pose(self):
        x, y = self.x, self.y
        if self.fault == "jumps" and self.active == 0:
            x += 30 * (self.clock.utc().second % 2)
        fields = {"X": x, "Y": y, "Yaw": self.yaw, "TimeStamp": self._stamp("pose")}
        return self._without(fields)

    def _set_pose(self, message, _sender):
        fields = message.fields["LocalPoseRec"]
        if self.fault != "keeps its pose":
            self.x, self.y, self.yaw = fields["X"], fields["Y"], fields["Yaw"]
        if self.fault == "sets Y with the other sign":
            self.y = -self.y

    # ---- the list ----------------------------------------------------------------------------

    def supports_element(self, _element):
        return True

    def on_not_ready(self):
        self.pending, self.active = [], 0

    def _execute(self, message, _sender):
        fields = message.fields["ExecuteListRec"]
        self.wished = fields["Speed"]
        self.pending = list(self.elements)
        order = {
            "drives backwards": self.pending[::-1],
            "skips the second": [self.pending[0], *self.pending[2:]],
            "ends after two": self.pending[:2],
            "begins with the third": self.pending[2:],
        }
        self.pending = order.get(self.fault, self.pending)
        self.active = self.pending[0].uid

    def _goal(self, element):
        where = self._kind("SetLocalWaypoint", DRIVER).decode(element.data).fields
        x, y = where["LocalWaypointRec"]["X"], where["LocalWaypointRec"]["Y"]
        return (x, -y) if self.fault == "drives the mirrored list" else (x, y)

    def _speed(self):
        return SPEED if self.pending else 0.0

    def _step(self):
        self.world.call_later(STEP, self._step)
        if not self.pending or self.fault == "does not move":
            return
        x, y = self._goal(self.pending[0])
        reached = 0.9 if self.fault == "stops before it is there" else REACHED
        if hypot(x - self.x, y - self.y) < reached:
            self.pending.pop(0)
            self.active = self.pending[0].uid if self.pending else 0
            return
        self.yaw = atan2(y - self.y, x - self.x)
        self.x += STEP * SPEED * cos(self.yaw)
        self.y += STEP * SPEED * sin(self.yaw)

    def _told_active(self):
        if self.fault == "names the first element always":
            return min(self.active, 1)
        if self.fault == "counts elements from 0":
            return max(self.active - 1, 0)
        return self.active

    def _told_speed(self):
        wrong = {"tells half the speed": 0.5, "tells no speed": 0.0}.get(self.fault, 1.0)
        return self.wished * wrong if self.active else 0.0

    def _told_waypoint(self):
        element = self.elements.get(self.active) or self.elements.first
        if element is None:
            return {"X": 0.0, "Y": 0.0}
        if self.fault == "tells the first waypoint always":
            element = self.elements.first
        x, y = self._goal(element)
        return {"X": y, "Y": x} if self.fault == "tells Y for X" else {"X": x, "Y": y}


_SERVICE = dict.fromkeys(
    ("ExecuteList", "ReportActiveElement", "ReportTravelSpeed", "ReportLocalWaypoint"), DRIVER
)


def _one_more(message):
    message.element_count += 1


def _turn_round(message):
    message.element_list.reverse()


def _refuse(message):
    message.response_code = 1


def _shift(message):
    message.request_id = (message.request_id + 1) % 256


def _in_emergency(message):
    message.status = 5


def _as_subsystem(message):
    message.query_type = 2


_CHANGES = {
    ("counts one more", core.ReportElementCount.CODE): _one_more,
    ("lists in reverse", core.ReportElementList.CODE): _turn_round,
    ("gives no control", core.ConfirmControl.CODE): _refuse,
    ("confirms another request", core.ConfirmElementRequest.CODE): _shift,
    ("says emergency", core.ReportStatus.CODE): _in_emergency,
    ("identifies as a subsystem", core.ReportIdentification.CODE): _as_subsystem,
}
_CLASSES = {
    core_class.CODE: core_class
    for core_class in vars(core).values()
    if isinstance(core_class, type) and hasattr(core_class, "CODE")
}
